#include "adapters/remote/remote_adapter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "adapters/remote/link.hpp"

namespace brickbench::remote {
namespace {

constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();

bool is_plain_zero(const Eigen::Vector3d& v) {
  return std::ranges::all_of(v, [](double x) { return std::bit_cast<std::uint64_t>(x) == 0; });
}

bool acts(const Wrench& wrench) {
  return !is_plain_zero(wrench.force_n) || !is_plain_zero(wrench.torque_nm);
}

// A view cannot fail. What goes wrong in one fails the next step, and until then the flags say that
// contacts are missing.
class RemoteSimulation final : public Simulation,
                               ContactView,
                               StateView,
                               AuditView,
                               DiagnosticView,
                               CostView {
 public:
  RemoteSimulation(Link link, const Built& built) : link_(std::move(link)), built_(built) {}

  Expected<void> start() {
    auto first = link_.read();
    if (!first) return tl::unexpected(first.error());
    last_ = {std::move(*first)};
    return {};
  }

  void apply(std::span<const Wrench> wrenches) override {
    wrenches_.clear();
    if (std::ranges::any_of(wrenches, acts)) wrenches_.assign(wrenches.begin(), wrenches.end());
  }

  Expected<void> step() override {
    if (failure_) return tl::unexpected(*failure_);
    auto done = link_.step(1, wrenches_, last_);
    wrenches_.clear();
    return done;
  }

  void read(std::span<State> states) const override {
    std::ranges::copy(last_.front().states, states.begin());
  }

  const ContactView* contact_view() const override { return built_.contacts ? this : nullptr; }
  StateView* state_view() override { return built_.set_state ? this : nullptr; }
  const AuditView* audit_view() const override { return built_.audit ? this : nullptr; }
  const DiagnosticView* diagnostic_view() const override {
    return built_.diagnostics || failure_ ? this : nullptr;
  }
  const CostView* cost_view() const override { return this; }

 private:
  void contacts(std::vector<Contact>& contacts) const override {
    contacts.clear();
    if (failure_) return;
    if (auto done = link_.contacts(contacts); !done) failure_ = done.error();
  }

  Expected<void> set_state(std::span<const State> states) override {
    if (failure_) return tl::unexpected(*failure_);
    wrenches_.clear();
    if (auto set = link_.set_state(states); !set) return set;
    return start();
  }

  Audit audit() const override {
    if (failure_) return {};
    auto facts = link_.audit();
    if (facts) return std::move(*facts);
    failure_ = facts.error();
    return {};
  }

  ContactLaw pair_law(std::size_t a, std::size_t b) const override {
    if (failure_) return {k_nan, k_nan};
    const auto law = link_.pair_law(a, b);
    if (law) return *law;
    failure_ = law.error();
    return {k_nan, k_nan};
  }

  std::span<const Diagnostic> diagnostics() const override { return last_.front().diagnostics; }
  Flags flags() const override {
    Flags flags = last_.front().flags;
    flags.raise(Flag::contacts_dropped, failure_.has_value());
    return flags;
  }
  Flags tellable() const override { return last_.front().tellable; }

  double build_cpu_s() const override { return built_.cpu_s; }
  double step_cpu_s() const override { return last_.front().cpu_s; }

  mutable Link link_;
  Built built_;
  std::vector<Wrench> wrenches_;  // for the next step; empty: none
  std::vector<StepRecord> last_;  // one
  mutable std::optional<Failure> failure_;
};

Expected<std::unique_ptr<Simulation>> build_remote(const Command& command,
                                                   const std::string& version, const World& world,
                                                   const Settings& settings) {
  auto link = Link::open(command);
  if (!link) return tl::unexpected(link.error());
  if (link->hello().version != version) {
    return fail(Fault::crashed, fmt::format("the program was version '{}' when it was listed, and "
                                            "now is '{}'",
                                            version, link->hello().version));
  }
  const auto built = link->build(world, settings);
  if (!built) return tl::unexpected(built.error());
  auto simulation = std::make_unique<RemoteSimulation>(std::move(*link), *built);
  if (auto started = simulation->start(); !started) return tl::unexpected(started.error());
  return simulation;
}

}  // namespace

Expected<Adapter> remote_adapter(const std::string& name, const Command& command) {
  auto link = Link::open(command);
  if (!link) return tl::unexpected(link.error());
  const Hello& hello = link->hello();
  Adapter adapter;
  adapter.name = name;
  adapter.version = hello.version;
  adapter.variants = hello.variants;
  adapter.knobs = hello.knobs;
  adapter.build = [command, version = hello.version](const World& world, const Settings& settings) {
    return build_remote(command, version, world, settings);
  };
  return adapter;
}

Expected<std::string> first_line_of(const Command& command) {
  const auto process = EngineProcess::start(command);
  if (!process) return tl::unexpected(process.error());
  return (*process)->first_line();
}

}  // namespace brickbench::remote
