#include "adapters/remote/step_record.hpp"

#include <fmt/format.h>

#include <cmath>

#include "adapters/remote/frame.hpp"

namespace brickbench::remote {
namespace {

using Eigen::Vector3d;

constexpr std::size_t k_state_bytes = 13 * sizeof(double);
constexpr std::size_t k_wrench_bytes = 6 * sizeof(double);
constexpr std::size_t k_contact_bytes = 12 * 8;
constexpr std::size_t k_record_head_bytes = 24;
constexpr std::size_t k_name_bytes = 40;
constexpr std::size_t k_unit_bytes = 16;
constexpr std::size_t k_diagnostic_bytes = sizeof(double) + k_name_bytes + k_unit_bytes;
// More contacts than bricks in a wall ever had: about ten each.
constexpr std::size_t k_contacts_per_body = 256;
constexpr std::size_t k_contacts_at_least = 1024;

void put(PayloadWriter& writer, const Vector3d& v) {
  for (const double x : v) writer.put(x);
}

Vector3d take_vector(PayloadReader& reader) {
  const double x = reader.take<double>(), y = reader.take<double>(), z = reader.take<double>();
  return {x, y, z};
}

void put(PayloadWriter& writer, const State& state) {
  put(writer, state.position_m);
  const Eigen::Quaterniond& q = state.orientation;
  for (const double x : {q.w(), q.x(), q.y(), q.z()}) writer.put(x);
  put(writer, state.velocity_mps);
  put(writer, state.angular_velocity_radps);
}

State take_state(PayloadReader& reader) {
  State state;
  state.position_m = take_vector(reader);
  const double w = reader.take<double>();
  const Vector3d xyz = take_vector(reader);
  state.orientation = {w, xyz.x(), xyz.y(), xyz.z()};
  state.velocity_mps = take_vector(reader);
  state.angular_velocity_radps = take_vector(reader);
  return state;
}

std::uint32_t bits_of(const Flags& flags) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < k_all_flags.size(); ++i) {
    if (flags.has(k_all_flags[i])) bits |= 1U << i;
  }
  return bits;
}

Expected<Flags> to_flags(std::uint32_t bits) {
  if (bits >> k_all_flags.size() != 0) {
    return fail(Fault::crashed, fmt::format("flags {:#x}: only the lowest {} bits have a meaning",
                                            bits, k_all_flags.size()));
  }
  Flags flags;
  for (std::size_t i = 0; i < k_all_flags.size(); ++i) {
    flags.raise(k_all_flags[i], (bits >> i & 1U) != 0);
  }
  return flags;
}

tl::unexpected<Failure> wrong_size(const char* what, std::size_t bytes, std::size_t wanted) {
  return fail(Fault::crashed, fmt::format("{}: {} bytes instead of {}", what, bytes, wanted));
}

Expected<void> take_record(PayloadReader& reader, std::size_t bodies, StepRecord& record) {
  record.cpu_s = reader.take<double>();
  const auto flags = to_flags(reader.take<std::uint32_t>());
  const auto tellable = to_flags(reader.take<std::uint32_t>());
  const auto diagnostics = reader.take<std::uint64_t>();
  if (!flags) return tl::unexpected(flags.error());
  if (!tellable) return tl::unexpected(tellable.error());
  record.flags = *flags;
  record.tellable = *tellable;
  if (!std::isfinite(record.cpu_s) || record.cpu_s < 0.0) {
    return fail(Fault::crashed, fmt::format("a step took {} s of CPU time", record.cpu_s));
  }
  if (diagnostics > k_most_diagnostics) {
    return fail(Fault::crashed,
                fmt::format("{} diagnostics; at most {}", diagnostics, k_most_diagnostics));
  }
  const std::size_t wanted = bodies * k_state_bytes + diagnostics * k_diagnostic_bytes;
  if (reader.left() < wanted) return wrong_size("a record", reader.left(), wanted);
  record.states.resize(bodies);
  for (State& state : record.states) state = take_state(reader);
  record.diagnostics.resize(diagnostics);
  for (Diagnostic& one : record.diagnostics) {
    one.value = reader.take<double>();
    one.name = readable(reader.take_text(k_name_bytes), k_name_bytes);
    one.unit = readable(reader.take_text(k_unit_bytes), k_unit_bytes);
  }
  return {};
}

}  // namespace

std::uint64_t most_record_bytes(std::size_t records, std::size_t bodies) {
  return records *
         (k_record_head_bytes + bodies * k_state_bytes + k_most_diagnostics * k_diagnostic_bytes);
}

std::uint64_t most_contact_bytes(std::size_t bodies) {
  return (k_contacts_at_least + bodies * k_contacts_per_body) * k_contact_bytes;
}

std::string to_bytes(std::span<const StepRecord> records) {
  PayloadWriter writer;
  if (!records.empty()) writer.reserve(most_record_bytes(records.size(), records[0].states.size()));
  for (const StepRecord& record : records) {
    writer.put(record.cpu_s);
    writer.put(bits_of(record.flags));
    writer.put(bits_of(record.tellable));
    writer.put(std::uint64_t{record.diagnostics.size()});
    for (const State& state : record.states) put(writer, state);
    for (const Diagnostic& one : record.diagnostics) {
      writer.put(one.value);
      writer.put_text(one.name, k_name_bytes);
      writer.put_text(one.unit, k_unit_bytes);
    }
  }
  return writer.bytes();
}

Expected<void> to_records(std::string_view payload, std::size_t count, std::size_t bodies,
                          std::vector<StepRecord>& records) {
  PayloadReader reader(payload);
  records.resize(count);
  for (StepRecord& record : records) {
    if (auto taken = take_record(reader, bodies, record); !taken) return taken;
  }
  if (!reader.whole()) {
    return fail(Fault::crashed,
                fmt::format("{} bytes are left after the last record of 'states'", reader.left()));
  }
  return {};
}

std::string to_bytes(std::span<const Contact> contacts) {
  PayloadWriter writer;
  writer.reserve(contacts.size() * k_contact_bytes);
  for (const Contact& contact : contacts) {
    writer.put(std::uint64_t{contact.body_a});
    writer.put(std::uint64_t{contact.body_b});
    put(writer, contact.position_m);
    put(writer, contact.normal);
    writer.put(contact.gap_m);
    put(writer, contact.impulse_ns);
  }
  return writer.bytes();
}

Expected<void> to_contacts(std::string_view payload, std::size_t bodies,
                           std::vector<Contact>& contacts) {
  contacts.clear();
  if (payload.size() % k_contact_bytes != 0) {
    return fail(Fault::crashed, fmt::format("contacts: {} bytes, which is no multiple of {}",
                                            payload.size(), k_contact_bytes));
  }
  PayloadReader reader(payload);
  contacts.resize(payload.size() / k_contact_bytes);
  for (Contact& contact : contacts) {
    contact.body_a = reader.take<std::uint64_t>();
    contact.body_b = reader.take<std::uint64_t>();
    contact.position_m = take_vector(reader);
    contact.normal = take_vector(reader);
    contact.gap_m = reader.take<double>();
    contact.impulse_ns = take_vector(reader);
    if (contact.body_a < bodies && contact.body_b < bodies) continue;
    const auto failure =
        fail(Fault::crashed, fmt::format("a contact of bodies {} and {}; there are {}",
                                         contact.body_a, contact.body_b, bodies));
    contacts.clear();
    return failure;
  }
  return {};
}

std::string to_bytes(std::span<const State> states) {
  PayloadWriter writer;
  writer.reserve(states.size() * k_state_bytes);
  for (const State& state : states) put(writer, state);
  return writer.bytes();
}

Expected<void> to_states(std::string_view payload, std::span<State> states) {
  if (payload.size() != states.size() * k_state_bytes) {
    return wrong_size("states", payload.size(), states.size() * k_state_bytes);
  }
  PayloadReader reader(payload);
  for (State& state : states) state = take_state(reader);
  return {};
}

std::string to_bytes(std::span<const Wrench> wrenches) {
  PayloadWriter writer;
  writer.reserve(wrenches.size() * k_wrench_bytes);
  for (const Wrench& wrench : wrenches) {
    put(writer, wrench.force_n);
    put(writer, wrench.torque_nm);
  }
  return writer.bytes();
}

Expected<void> to_wrenches(std::string_view payload, std::span<Wrench> wrenches) {
  if (payload.size() != wrenches.size() * k_wrench_bytes) {
    return wrong_size("wrenches", payload.size(), wrenches.size() * k_wrench_bytes);
  }
  PayloadReader reader(payload);
  for (Wrench& wrench : wrenches) {
    wrench.force_n = take_vector(reader);
    wrench.torque_nm = take_vector(reader);
  }
  return {};
}

}  // namespace brickbench::remote
