#include "adapters/remote/serve.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <system_error>

#include "adapters/remote/codec.hpp"
#include "adapters/remote/frame.hpp"
#include "adapters/remote/step_record.hpp"
#include "adapters/remote/world_json.hpp"
#include "adapters/seam/shape.hpp"

namespace brickbench::remote {
namespace {

constexpr std::uint64_t k_most_request_bytes = std::uint64_t{1} << 30U;
constexpr std::uint64_t k_most_steps = 1'000'000;

double process_cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

tl::unexpected<Failure> system_failure(const char* what) {
  return fail(Fault::crashed, fmt::format("{}: {}", what, std::generic_category().message(errno)));
}

// Whether all bytes came; false: the input ended before the first.
Expected<bool> read_all(int in, std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(in, bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return system_failure("cannot read requests");
    if (got == 0 && done == 0) return false;
    if (got == 0) return fail(Fault::crashed, "the requests ended in the middle of one");
    done += static_cast<std::size_t>(got);
  }
  return true;
}

Expected<void> write_all(int out, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::write(out, bytes.data(), bytes.size());
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return system_failure("cannot write answers");
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return {};
}

struct Answer {
  Tag tag = Tag::done;
  std::string payload;
};

Hello hello_of(const Adapter& adapter) {
  Hello hello{adapter.name, adapter.version, {}, adapter.variants, adapter.knobs};
  // Which shapes a linked engine refuses it says when it is asked to build them.
  for (const Shape& shape : all_shapes()) hello.shapes.emplace_back(shape_word(shape));
  return hello;
}

// One simulation, as the requests leave it.
class Session {
 public:
  explicit Session(const Adapter& adapter) : adapter_(adapter) {}

  // The failures are the engine's, and are answered with a frame `failed`.
  Expected<Answer> answer(Tag request, std::string_view payload) {
    if (request == Tag::hello) return greet(payload);
    if (request == Tag::build) return build_world(payload);
    if (simulation_ == nullptr) return fail(Fault::invalid, "nothing is built yet");
    switch (request) {
      case Tag::step:
        return step(payload);
      case Tag::read:
        return Answer{Tag::states, to_bytes(std::array{record()})};
      case Tag::set_state:
        return set_state(payload);
      case Tag::contacts:
        return contacts();
      case Tag::audit:
        return audit();
      case Tag::pair_law:
        return pair_law(payload);
      default:
        return fail(Fault::invalid, fmt::format("'{}' is no request", to_word(request)));
    }
  }

 private:
  Expected<Answer> greet(std::string_view payload) const {
    if (auto same = read_greeting(payload); !same) return tl::unexpected(same.error());
    return Answer{Tag::hello, to_json(hello_of(adapter_))};
  }

  Expected<Answer> build_world(std::string_view payload) {
    if (simulation_ != nullptr) return fail(Fault::invalid, "a world is built already");
    auto order = to_build_order(payload, k_most_request_bytes);
    if (!order) return fail(Fault::invalid, order.error().reason);
    forget_own_values(order->settings);
    const double begun_s = process_cpu_s();
    auto built = build(adapter_, order->world, order->settings);
    if (!built) return tl::unexpected(built.error());
    simulation_ = std::move(*built);
    wrenches_.resize(order->world.bodies.size());
    states_.resize(order->world.bodies.size());
    return Answer{Tag::built,
                  to_json(Built{.contacts = simulation_->contact_view() != nullptr,
                                .set_state = simulation_->state_view() != nullptr,
                                .audit = simulation_->audit_view() != nullptr,
                                .diagnostics = simulation_->diagnostic_view() != nullptr,
                                .cpu_s = process_cpu_s() - begun_s})};
  }

  // What the variant has anyway need not be turned, and may be infinite, which no one may ask for.
  void forget_own_values(Settings& settings) const {
    const auto variant = std::ranges::find(adapter_.variants, settings.variant, &Variant::name);
    if (variant == adapter_.variants.end()) return;
    for (const auto& [name, value] : variant->knobs) {
      const auto turned = settings.knobs.find(name);
      if (turned != settings.knobs.end() && turned->second == value) settings.knobs.erase(turned);
    }
  }

  StepRecord record() const {
    StepRecord record;
    record.states.resize(states_.size());
    simulation_->read(record.states);
    if (const DiagnosticView* view = simulation_->diagnostic_view()) {
      record.flags = view->flags();
      record.tellable = view->tellable();
      const auto told = view->diagnostics();
      record.diagnostics.assign(told.begin(), told.end());
    }
    return record;
  }

  Expected<Answer> step(std::string_view payload) {
    PayloadReader reader(payload);
    const auto count = reader.take<std::uint64_t>();
    if (count < 1 || count > k_most_steps) {
      return fail(Fault::invalid, fmt::format("{} steps: from 1 to {}", count, k_most_steps));
    }
    std::ranges::fill(wrenches_, Wrench{});
    if (reader.left() > 0) {
      if (auto ok = to_wrenches(payload.substr(sizeof(count)), wrenches_); !ok) {
        return fail(Fault::invalid, ok.error().reason);
      }
    }
    std::vector<StepRecord> records;
    for (std::uint64_t k = 0; k < count; ++k) {
      const double begun_s = process_cpu_s();
      simulation_->apply(wrenches_);
      if (auto done = simulation_->step(); !done) return tl::unexpected(done.error());
      const double cpu_s = process_cpu_s() - begun_s;
      records.push_back(record());
      records.back().cpu_s = cpu_s;
      std::ranges::fill(wrenches_, Wrench{});
    }
    return Answer{Tag::states, to_bytes(records)};
  }

  Expected<Answer> set_state(std::string_view payload) {
    if (auto ok = to_states(payload, states_); !ok) return fail(Fault::invalid, ok.error().reason);
    if (auto set = simulation_->state_view()->set_state(states_); !set) {
      return tl::unexpected(set.error());
    }
    return Answer{Tag::done, {}};
  }

  Expected<Answer> contacts() const {
    const ContactView* view = simulation_->contact_view();
    if (view == nullptr) return fail(Fault::invalid, "no contact view");
    std::vector<Contact> all;
    view->contacts(all);
    return Answer{Tag::contacts, to_bytes(all)};
  }

  Expected<Answer> audit() const {
    const AuditView* view = simulation_->audit_view();
    if (view == nullptr) return fail(Fault::invalid, "no audit view");
    return Answer{Tag::audit, to_json(view->audit())};
  }

  Expected<Answer> pair_law(std::string_view payload) const {
    const AuditView* view = simulation_->audit_view();
    PayloadReader reader(payload);
    const auto a = reader.take<std::uint64_t>(), b = reader.take<std::uint64_t>();
    if (view == nullptr || !reader.whole() || a >= states_.size() || b >= states_.size()) {
      return fail(Fault::invalid, "pairlaw: two bodies of an engine with an audit view");
    }
    const ContactLaw law = view->pair_law(a, b);
    PayloadWriter writer;
    writer.put(law.friction);
    writer.put(law.restitution);
    return Answer{Tag::pair_law, writer.bytes()};
  }

  const Adapter& adapter_;
  std::unique_ptr<Simulation> simulation_;
  std::vector<Wrench> wrenches_;  // (bodies)
  std::vector<State> states_;     // (bodies)
};

}  // namespace

Expected<void> serve(const Adapter& adapter, int in, int out) {
  Session session(adapter);
  while (true) {
    std::string head(k_header_bytes, '\0');
    const auto more = read_all(in, head);
    if (!more) return tl::unexpected(more.error());
    if (!*more) return {};
    const auto header = to_header(head);
    if (!header || header->bytes > k_most_request_bytes) {
      return fail(Fault::crashed,
                  fmt::format("'{}' begins no request", readable(head, k_header_bytes)));
    }
    std::string payload(header->bytes, '\0');
    if (auto whole = read_all(in, payload); !whole || (!*whole && header->bytes > 0)) {
      return fail(Fault::crashed, "the requests ended in the middle of one");
    }
    auto answer = session.answer(header->tag, payload);
    if (!answer) answer = Answer{Tag::failed, to_json(answer.error())};
    if (auto sent = write_all(out, to_frame(answer->tag, answer->payload)); !sent) return sent;
  }
}

}  // namespace brickbench::remote
