#include "adapters/remote/link.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "adapters/seam/shape.hpp"

namespace brickbench::remote {
namespace {

constexpr std::uint64_t k_audit_bytes_per_body = 2000;
// Of one answer, however many steps it holds.
constexpr std::uint64_t k_most_answer_bytes = std::uint64_t{1} << 30U;

}  // namespace

Expected<Link> Link::open(const Command& command) {
  auto process = EngineProcess::start(command);
  if (!process) return tl::unexpected(process.error());
  Link link;
  link.process_ = std::move(*process);
  const auto said = link.ask(Tag::hello, greeting(), Tag::hello, k_most_json_bytes);
  if (!said) return tl::unexpected(said.error());
  auto hello = to_hello(*said);
  if (!hello) return tl::unexpected(hello.error());
  link.hello_ = std::move(*hello);
  return link;
}

Expected<std::string> Link::ask(Tag tag, std::string_view payload, Tag answer,
                                std::uint64_t most_bytes) {
  return process_->ask({tag, payload, answer, std::min(most_bytes, k_most_answer_bytes)});
}

Expected<Built> Link::build(const World& world, const Settings& settings) {
  for (const Body& body : world.bodies) {
    const std::string_view word = shape_word(body.shape);
    if (std::ranges::find(hello_.shapes, word) != hello_.shapes.end()) continue;
    return fail(Fault::unsupported,
                fmt::format("body '{}': the engine says that it has no {}", body.name, word));
  }
  bodies_ = world.bodies.size();
  const auto said =
      ask(Tag::build, to_json(BuildOrder{world, settings}), Tag::built, k_most_json_bytes);
  if (!said) return tl::unexpected(said.error());
  return to_built(*said);
}

Expected<void> Link::ask_records(Tag tag, std::string_view payload, std::uint64_t count,
                                 std::vector<StepRecord>& records) {
  const auto said = ask(tag, payload, Tag::states, most_record_bytes(count, bodies_));
  if (!said) return tl::unexpected(said.error());
  return to_records(*said, count, bodies_, records);
}

Expected<void> Link::step(std::uint64_t count, std::span<const Wrench> wrenches,
                          std::vector<StepRecord>& records) {
  PayloadWriter writer;
  writer.put(count);
  return ask_records(Tag::step, writer.bytes() + to_bytes(wrenches), count, records);
}

Expected<StepRecord> Link::read() {
  std::vector<StepRecord> records;
  if (auto done = ask_records(Tag::read, {}, 1, records); !done) {
    return tl::unexpected(done.error());
  }
  return std::move(records.front());
}

Expected<void> Link::set_state(std::span<const State> states) {
  const auto said = ask(Tag::set_state, to_bytes(states), Tag::done, 0);
  if (!said) return tl::unexpected(said.error());
  return {};
}

Expected<void> Link::contacts(std::vector<Contact>& contacts) {
  contacts.clear();
  const auto said = ask(Tag::contacts, {}, Tag::contacts, most_contact_bytes(bodies_));
  if (!said) return tl::unexpected(said.error());
  return to_contacts(*said, bodies_, contacts);
}

Expected<Audit> Link::audit() {
  const std::uint64_t most = k_most_json_bytes + bodies_ * k_audit_bytes_per_body;
  const auto said = ask(Tag::audit, {}, Tag::audit, most);
  if (!said) return tl::unexpected(said.error());
  return to_audit(*said, most);
}

Expected<ContactLaw> Link::pair_law(std::size_t a, std::size_t b) {
  PayloadWriter writer;
  writer.put(std::uint64_t{a});
  writer.put(std::uint64_t{b});
  const auto said = ask(Tag::pair_law, writer.bytes(), Tag::pair_law, 2 * sizeof(double));
  if (!said) return tl::unexpected(said.error());
  PayloadReader reader(*said);
  const ContactLaw law = {reader.take<double>(), reader.take<double>()};
  if (!reader.whole()) return fail(Fault::crashed, "pairlaw: two numbers are wanted");
  return law;
}

}  // namespace brickbench::remote
