// Simulation: one world running in one engine, as seen from outside.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "adapters/seam/failure.hpp"
#include "adapters/seam/flag.hpp"
#include "adapters/seam/world.hpp"

namespace brickbench {

// One contact point of the last step.
struct Contact {
  std::size_t body_a = 0;  // indices into World::bodies
  std::size_t body_b = 0;
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     // unit, world frame, from a towards b
  double gap_m = 0.0;                                    // negative: penetration
  Eigen::Vector3d impulse_ns = Eigen::Vector3d::Zero();  // on b during the last step, world frame
};

// What the engine says about its last step, for example the residual that its solver reached.
struct Diagnostic {
  std::string name;  // snake_case with SI suffix
  std::string unit;
  double value = 0.0;
};

// One setting of the live engine, as text, for people and for the provenance of a run.
struct AuditFact {
  std::string name;
  std::string unit;
  std::string value;
};

// What the live engine object holds for one body: compared with World::bodies before any score.
struct BodyAudit {
  bool fixed = false;
  double mass_kg = 0.0;                                    // 0 for fixed bodies
  Eigen::Vector3d inertia_kgm2 = Eigen::Vector3d::Zero();  // principal, body axes; 0 if fixed
  Shape shape = PlaneShape{};
  double linear_damping_hz = 0.0;
  double angular_damping_hz = 0.0;
  bool can_sleep = false;
};

struct Audit {
  Eigen::Vector3d gravity_mps2 = Eigen::Vector3d::Zero();
  std::vector<BodyAudit> bodies;    // (bodies), order of World::bodies
  std::vector<AuditFact> settings;  // solver, iterations, margins, softness ...
};

// Optional view: the contacts that the engine used in the last step.
class ContactView {
 public:
  virtual ~ContactView() = default;
  // Appends nothing and clears nothing but `contacts`: afterwards it holds the last step's
  // contacts.
  virtual void contacts(std::vector<Contact>& contacts) const = 0;
};

// Optional view: replaces the state of all bodies.
class StateView {
 public:
  virtual ~StateView() = default;
  // (bodies). Forgets warm starts and contact history: the future depends on these states alone.
  // Fixed bodies keep their pose, whatever the entry says.
  virtual Expected<void> set_state(std::span<const State> states) = 0;
};

// Optional view: facts read back from the engine's own objects, never from the World they came
// from.
class AuditView {
 public:
  virtual ~AuditView() = default;
  virtual Audit audit() const = 0;
  // The law that the engine would use for contacts between bodies a and b.
  virtual ContactLaw pair_law(std::size_t a, std::size_t b) const = 0;
};

// Optional view: what the engine says about its last step.
class DiagnosticView {
 public:
  virtual ~DiagnosticView() = default;
  virtual std::span<const Diagnostic> diagnostics() const = 0;
  // The flags that the engine's own words raise for its last step.
  virtual Flags flags() const { return {}; }
  // The flags that it could raise: that it does not raise another means nothing.
  virtual Flags tellable() const { return {}; }
};

// Optional view: what the engine says it took, where it runs in a process of its own and the time
// of the caller is not its own.
class CostView {
 public:
  virtual ~CostView() = default;
  // CPU time (s) of all the engine's threads, without the transport: of building, of the last step.
  virtual double build_cpu_s() const = 0;
  virtual double step_cpu_s() const = 0;
};

class Simulation {
 public:
  Simulation() = default;
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  virtual ~Simulation() = default;

  // (bodies), order of World::bodies: held during the next step, then forgotten.
  virtual void apply(std::span<const Wrench> wrenches) = 0;
  // Advances by exactly Settings::step_s, or says why it could not; after a failure only
  // destruction is allowed.
  virtual Expected<void> step() = 0;
  // (bodies), order of World::bodies: the state after the last step.
  virtual void read(std::span<State> states) const = 0;

  // nullptr where the engine does not offer the view.
  virtual const ContactView* contact_view() const { return nullptr; }
  virtual StateView* state_view() { return nullptr; }
  virtual const AuditView* audit_view() const { return nullptr; }
  virtual const DiagnosticView* diagnostic_view() const { return nullptr; }
  virtual const CostView* cost_view() const { return nullptr; }
};

}  // namespace brickbench
