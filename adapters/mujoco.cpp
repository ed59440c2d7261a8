// MuJoCo 2.2: a convex contact model with softness, stepped by mj_step.
//
// Choices (measured effects: docs/engines/mujoco.md):
//  * cg, newton: elliptic cones, 200 iterations, tolerance 1e-10, contacts as stiff as MuJoCo's own
//    safety allows (solref: time constant two steps, damping ratio 1).
//  * rk4: newton with the integrator mj_RungeKutta.
//  * default: all of these as the library has them: pyramidal cones, Newton, 100 iterations, 1e-8,
//    time constant 0.02 s.
//  * Every variant: mass and inertia as in World, no sleeping, no damping, friction exact per pair.
//  * Refused: restitution (MuJoCo has no such coefficient), several threads, more contacts than its
//    2 GiB buffer holds. A full buffer, a bad number or any other warning or error of MuJoCo fails
//    the step: nothing runs on with dropped contacts or a silently reset state.
//  * MuJoCo reports by two global C function pointers. Ours throw, through C frames that Debian
//    compiles with unwind tables (the x86-64 default); the tests provoke both. Building is not
//    thread-safe, because MuJoCo's compiler swaps the same pointers meanwhile.
#include <fmt/core.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "adapters/mujoco_model.hpp"
#include "adapters/seam/knob_table.hpp"

namespace brickbench {
namespace {

static_assert(sizeof(mjtNum) == 8, "the adapter wants MuJoCo in double precision");

using Row = KnobRow<mjModel>;

// set and read of a knob that is a member of MuJoCo's options.
template <auto member>
struct OfOption {
  static void set(mjModel& model, double value) { Held<member>::set(model.opt, value); }
  static LiveValues read(const mjModel& model) { return Held<member>::read(model.opt); }
};

// A number of each contact's "solref": of the geoms, and of the explicit pairs.
template <int number>
LiveValues solref(const mjModel& model) {
  LiveValues values;
  for (int i = 0; i < model.ngeom; ++i) values.push_back(model.geom_solref[i * mjNREF + number]);
  for (int i = 0; i < model.npair; ++i) values.push_back(model.pair_solref[i * mjNREF + number]);
  return values;
}

constexpr std::array k_knobs = {
    Row{"iterations", "1", 100, 200, 1, 1e6, true, "most iterations of the solver per step",
        &OfOption<&mjOption::iterations>::set, &OfOption<&mjOption::iterations>::read},
    Row{"tolerance", "1", 1e-8, 1e-10, 0, 1, false,
        "scaled improvement or gradient below which the solver stops",
        &OfOption<&mjOption::tolerance>::set, &OfOption<&mjOption::tolerance>::read},
    Row{"solref_timeconst_s", "s", 0.02, 0, 0, 1e3, false,
        "time constant of the contact's spring; 0: two steps; MuJoCo raises less to two steps",
        nullptr, &solref<0>, true},
    Row{"solref_dampratio", "1", 1, 1, 1e-6, 1e6, false,
        "damping of the contact's spring; 1 is critical", nullptr, &solref<1>, true},
    Row{"impratio", "1", 1, 1, 1e-6, 1e6, false,
        "stiffness of friction over that of the normal; more: less creep",
        &OfOption<&mjOption::impratio>::set, &OfOption<&mjOption::impratio>::read},
    Row{"integrator", "1", 0, 0, 0, 2, true,
        "0 semi-implicit Euler, 1 Runge-Kutta of order 4, 2 implicit in the velocity",
        &OfOption<&mjOption::integrator>::set, &OfOption<&mjOption::integrator>::read},
    Row{"noslip_iterations", "1", 0, 0, 0, 1e6, true,
        "iterations of the second solver against creep",
        &OfOption<&mjOption::noslip_iterations>::set,
        &OfOption<&mjOption::noslip_iterations>::read},
    Row{"cone", "1", 0, 1, 0, 1, true, "friction cone: 0 pyramidal, 1 elliptic",
        &OfOption<&mjOption::cone>::set, &OfOption<&mjOption::cone>::read},
    Row{"contacts_per_body", "1", 12, 12, 0, 1e6, false,
        "room for contacts: 50 plus this per moving body; memory grows with its square"},
    Row{"warm_starting", "1", 1, 1, 0, 1, true, "1: start from the last step's acceleration",
        [](mjModel& model, double value) {
          if (value == 0.0) model.opt.disableflags |= mjDSBL_WARMSTART;
        },
        [](const mjModel& model) -> LiveValues {
          return {(model.opt.disableflags & mjDSBL_WARMSTART) == 0 ? 1.0 : 0.0};
        }},
};

mjtSolver solver_of(const Settings& settings) {
  return settings.variant == "cg" ? mjSOL_CG : mjSOL_NEWTON;
}

mujoco::ContactSettings contact_settings(const Settings& settings) {
  const double asked_s = knob(settings, "solref_timeconst_s");
  return {.time_constant_s = asked_s > 0.0 ? asked_s : 2.0 * settings.step_s,
          .damping_ratio = knob(settings, "solref_dampratio"),
          .contacts_per_body = knob(settings, "contacts_per_body")};
}

Eigen::Map<const Eigen::Vector3d> vector_at(const mjtNum* values) {
  return Eigen::Map<const Eigen::Vector3d>(values);
}

constexpr std::array k_solvers = {"PGS", "CG", "Newton"};

struct Slot {
  int geom = -1;
  int body = -1;      // MuJoCo's body; -1: fixed
  int position = -1;  // first index into qpos
  int velocity = -1;  // first index into qvel
};

class MujocoSimulation final : public Simulation,
                               ContactView,
                               StateView,
                               AuditView,
                               DiagnosticView {
 public:
  MujocoSimulation(const World& world, mujoco::ModelPtr model, mujoco::DataPtr data)
      : model_(std::move(model)), data_(std::move(data)) {
    body_of_geom_.resize(static_cast<std::size_t>(model_->ngeom));
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const Body& body = world.bodies[i];
      Slot slot;
      slot.geom = mj_name2id(model_.get(), mjOBJ_GEOM, fmt::format("g{}", i).c_str());
      body_of_geom_[static_cast<std::size_t>(slot.geom)] = i;
      if (!body.fixed) {
        slot.body = model_->geom_bodyid[slot.geom];
        const int joint = model_->body_jntadr[slot.body];
        slot.position = model_->jnt_qposadr[joint];
        slot.velocity = model_->jnt_dofadr[joint];
      }
      slots_.push_back(slot);
      initial_.push_back(body.initial);
    }
    put(initial_);
  }

  void apply(std::span<const Wrench> wrenches) override {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (slots_[i].body < 0) continue;
      Eigen::Map<Eigen::Matrix<double, 6, 1>>(data_->xfrc_applied + 6 * slots_[i].body)
          << wrenches[i].force_n,
          wrenches[i].torque_nm;
    }
  }

  Expected<void> step() override {
    try {
      mj_step(model_.get(), data_.get());
    } catch (const mujoco::EngineError& error) {
      return fail(has_bad_numbers() ? Fault::diverged : Fault::crashed,
                  fmt::format("MuJoCo at {} s: {}", data_->time, error.what()));
    }
    std::fill_n(data_->xfrc_applied, 6 * model_->nbody, 0.0);
    note_diagnostics();
    return {};
  }

  void read(std::span<State> states) const override {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      states[i] = initial_[i];
      if (slots_[i].body < 0) continue;
      const mjtNum* q = data_->qpos + slots_[i].position;
      const mjtNum* v = data_->qvel + slots_[i].velocity;
      states[i].position_m = vector_at(q);
      states[i].orientation = Eigen::Quaterniond(q[3], q[4], q[5], q[6]);
      states[i].velocity_mps = vector_at(v);
      // MuJoCo keeps the angular velocity of a free joint in the body frame.
      states[i].angular_velocity_radps = states[i].orientation * vector_at(v + 3);
    }
  }

  // The forces of a Runge-Kutta step are those of four stages, of which only the last is kept.
  const ContactView* contact_view() const override {
    return model_->opt.integrator == mjINT_RK4 ? nullptr : this;
  }
  StateView* state_view() override { return this; }
  const AuditView* audit_view() const override { return this; }
  const DiagnosticView* diagnostic_view() const override { return this; }

  void contacts(std::vector<Contact>& contacts) const override {
    contacts.clear();
    for (int c = 0; c < data_->ncon; ++c) {
      const mjContact& point = data_->contact[c];
      std::array<mjtNum, 6> force{};  // normal and two tangents, on geom2, in the contact's frame
      if (point.efc_address >= 0) mj_contactForce(model_.get(), data_.get(), c, force.data());
      const Eigen::Map<const Eigen::Matrix3d> axes(point.frame);  // columns: normal, two tangents
      contacts.push_back({.body_a = body_of_geom_[static_cast<std::size_t>(point.geom1)],
                          .body_b = body_of_geom_[static_cast<std::size_t>(point.geom2)],
                          .position_m = vector_at(point.pos),
                          .normal = axes.col(0),
                          .gap_m = point.dist,
                          .impulse_ns = model_->opt.timestep * (axes * vector_at(force.data()))});
    }
  }

  Expected<void> set_state(std::span<const State> states) override {
    mj_resetData(model_.get(), data_.get());  // time, warm start, contacts, warnings
    put(states);
    flags_ = {};
    return {};
  }

  Audit audit() const override {
    Audit audit;
    audit.gravity_mps2 = vector_at(model_->opt.gravity);
    for (const Slot& slot : slots_) audit.bodies.push_back(audit_body(slot));
    audit.settings = read_knobs(k_knobs, *model_);
    audit.settings.push_back(
        {"solver", "", k_solvers[static_cast<std::size_t>(model_->opt.solver)]});
    audit.settings.push_back(number_fact("step_s", "s", model_->opt.timestep));
    audit.settings.push_back(number_fact("nconmax", "1", model_->nconmax));
    audit.settings.push_back(number_fact("njmax", "1", model_->njmax));
    audit.settings.push_back(number_fact("buffer", "byte", data_->nbuffer));
    return audit;
  }

  ContactLaw pair_law(std::size_t a, std::size_t b) const override {
    return {mujoco::pair_friction(*model_, slots_[a].geom, slots_[b].geom), 0.0};
  }

  std::span<const Diagnostic> diagnostics() const override { return diagnostics_; }
  Flags flags() const override { return flags_; }
  // Dropped contacts and rows would have failed the step. With a second solver the iterations are
  // the sum of both.
  Flags tellable() const override {
    Flags flags(Flag::contacts_dropped);
    flags.raise(Flag::unsolved, model_->opt.noslip_iterations == 0);
    return flags;
  }

 private:
  bool has_bad_numbers() const {
    const auto bad = [](mjtNum x) { return mju_isBad(x) != 0; };
    return std::any_of(data_->qpos, data_->qpos + model_->nq, bad) ||
           std::any_of(data_->qvel, data_->qvel + model_->nv, bad) ||
           std::any_of(data_->qacc, data_->qacc + model_->nv, bad);
  }

  void put(std::span<const State> states) {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
      if (slots_[i].body < 0) continue;
      mjtNum* q = data_->qpos + slots_[i].position;
      mjtNum* v = data_->qvel + slots_[i].velocity;
      const State& s = states[i];
      const Eigen::Quaterniond& turn = s.orientation;
      Eigen::Map<Eigen::Vector3d>{q} = s.position_m;
      Eigen::Map<Eigen::Vector4d>(q + 3) << turn.w(), turn.x(), turn.y(), turn.z();
      Eigen::Map<Eigen::Vector3d>{v} = s.velocity_mps;
      Eigen::Map<Eigen::Vector3d>(v + 3) = turn.conjugate() * s.angular_velocity_radps;
    }
  }

  BodyAudit audit_body(const Slot& slot) const {
    BodyAudit body;
    body.fixed = slot.body < 0;
    const auto size = vector_at(model_->geom_size + 3 * slot.geom);
    switch (model_->geom_type[slot.geom]) {
      case mjGEOM_BOX:
        body.shape = BoxShape{size};
        break;
      case mjGEOM_SPHERE:
        body.shape = SphereShape{size.x()};
        break;
      case mjGEOM_PLANE:
        body.shape = PlaneShape{};
        break;
      default:
        throw std::logic_error("a geom of MuJoCo that this adapter never makes");
    }
    if (!body.fixed) {
      body.mass_kg = model_->body_mass[slot.body];
      body.inertia_kgm2 = vector_at(model_->body_inertia + 3 * slot.body);
      body.linear_damping_hz = model_->dof_damping[slot.velocity] / body.mass_kg;
      body.angular_damping_hz =
          model_->dof_damping[slot.velocity + 3] / body.inertia_kgm2.maxCoeff();
    }
    return body;
  }

  void note_diagnostics() {
    const int last = std::min(data_->solver_iter, mjNSOLVER) - 1;
    const mjSolverStat stat = last < 0 ? mjSolverStat{} : data_->solver[last];
    diagnostics_ = {Diagnostic{"solver_iterations", "1", static_cast<double>(data_->solver_iter)},
                    Diagnostic{"solver_gradient", "1", stat.gradient},
                    Diagnostic{"solver_improvement", "1", stat.improvement},
                    Diagnostic{"constraint_rows", "1", static_cast<double>(data_->nefc)},
                    Diagnostic{"contact_points", "1", static_cast<double>(data_->ncon)}};
    const mjOption& option = model_->opt;
    flags_ = {};
    flags_.raise(Flag::unsolved,
                 option.noslip_iterations == 0 && data_->solver_iter >= option.iterations &&
                     stat.gradient >= option.tolerance && stat.improvement >= option.tolerance);
  }

  mujoco::ModelPtr model_;
  mujoco::DataPtr data_;
  std::vector<Slot> slots_;  // (bodies)
  std::vector<std::size_t> body_of_geom_;
  std::vector<State> initial_;
  std::array<Diagnostic, 5> diagnostics_ = {
      Diagnostic{"solver_iterations", "1", 0.0}, Diagnostic{"solver_gradient", "1", 0.0},
      Diagnostic{"solver_improvement", "1", 0.0}, Diagnostic{"constraint_rows", "1", 0.0},
      Diagnostic{"contact_points", "1", 0.0}};
  Flags flags_;
};

Expected<std::unique_ptr<Simulation>> build_mujoco(const World& world, const Settings& settings) {
  mujoco::throw_errors_and_warnings();
  const mujoco::ContactSettings contact = contact_settings(settings);
  auto model = mujoco::compile(world, contact);
  if (!model) return tl::unexpected(model.error());
  mjOption& option = (*model)->opt;
  option.timestep = settings.step_s;
  Eigen::Map<Eigen::Vector3d>(option.gravity) = world.gravity_mps2;
  option.solver = solver_of(settings);
  set_knobs(k_knobs, settings, **model);
  auto data = mujoco::allocate(**model, contact);
  if (!data) return tl::unexpected(data.error());
  return std::make_unique<MujocoSimulation>(world, std::move(*model), std::move(*data));
}

std::vector<AuditFact> asked_of_mujoco(const World& world, const Settings& settings) {
  const mujoco::ContactSettings contact = contact_settings(settings);
  Settings used = settings;
  used.knobs["solref_timeconst_s"] = contact.time_constant_s;
  std::vector<AuditFact> facts = asked_knobs(k_knobs, world, used);
  const auto moving = std::ranges::count(world.bodies, false, &Body::fixed);
  facts.push_back(
      number_fact("nconmax", "1", mujoco::contact_room(contact, static_cast<double>(moving))));
  facts.push_back({"solver", "", k_solvers[static_cast<std::size_t>(solver_of(settings))]});
  return facts;
}

// Todorov, Erez, Tassa, "MuJoCo: a physics engine for model-based control" (2012) and the chapter
// "Computation" of MuJoCo's documentation.
std::optional<Scheme> mujoco_scheme(const Settings& settings) {
  const int integrator = static_cast<int>(knob(settings, "integrator"));
  const mujoco::ContactSettings contact = contact_settings(settings);
  Scheme scheme;
  scheme.source = "MuJoCo documentation 2.2, Computation: integrators, solver parameters";
  scheme.gyroscopic =
      integrator == mjINT_IMPLICIT ? GyroscopicRule::newton_body : GyroscopicRule::explicit_body;
  if (integrator == mjINT_RK4) {
    scheme.position = PositionRule::runge_kutta_4;
    scheme.gyroscopic = GyroscopicRule::runge_kutta_4;
    scheme.order = 2.0;  // of the attitude: mj_RungeKutta averages spins of different body frames
  }
  scheme.attitude = AttitudeRule::exponential;
  scheme.contact = CompliantContact{.time_constant_s = contact.time_constant_s,
                                    .damping_ratio = contact.damping_ratio,
                                    .least_impedance = mjMINIMP,
                                    .most_impedance = mjMAXIMP,
                                    // mjc_BoxBox, face contacts: the distance is halved with
                                    // the point that it belongs to, before it is stored
                                    .box_gap_share = 0.5};
  // The map counts friction and normal as equally stiff, and knows no second solver.
  if (knob(settings, "impratio") != 1.0 || knob(settings, "noslip_iterations") > 0.0) {
    scheme.contact = {};
  }
  scheme.friction = knob(settings, "cone") > 0.0 ? FrictionSet::circle : FrictionSet::inscribed;
  return scheme;
}

}  // namespace

Adapter mujoco_adapter() {
  KnobValues runge_kutta = tuned_values(k_knobs);
  runge_kutta["integrator"] = mjINT_RK4;
  return {.name = "mujoco",
          .version = mj_versionString(),
          .variants = {{"cg", "conjugate gradients, elliptic cones, stiffest contacts; tuned",
                        "f64", tuned_values(k_knobs)},
                       {"newton", "Newton's method, elliptic cones, stiffest contacts; tuned",
                        "f64", tuned_values(k_knobs)},
                       {"rk4", "as newton, with Runge-Kutta of order 4", "f64", runge_kutta},
                       {"default", "Newton's method, pyramidal cones; the library's own settings",
                        "f64", library_values(k_knobs)}},
          .knobs = to_knobs(k_knobs),
          .build = build_mujoco,
          .scheme = mujoco_scheme,
          .asked = asked_of_mujoco};
}

}  // namespace brickbench
