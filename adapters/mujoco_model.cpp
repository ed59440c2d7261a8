#include "adapters/mujoco_model.hpp"

#include <fmt/core.h>
#include <mujoco/mjxmacro.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "adapters/seam/shape.hpp"

namespace brickbench::mujoco {
namespace {

constexpr const char* k_file = "world.xml";
// Explicit pairs are all visited in every step: more would hide the cost of the engine itself.
constexpr std::size_t k_max_explicit_pairs = 5000;

struct FreeFiles {
  void operator()(mjVFS* files) const {
    mj_deleteVFS(files);
    delete files;
  }
};

[[noreturn]] void raise(const char* message) { throw EngineError(message); }

std::string numbers(const Eigen::Vector3d& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

std::string pose(const State& state) {
  const Eigen::Quaterniond& q = state.orientation;
  return fmt::format("pos=\"{}\" quat=\"{:.17g} {:.17g} {:.17g} {:.17g}\"",
                     numbers(state.position_m), q.w(), q.x(), q.y(), q.z());
}

std::string shape_attributes(const Shape& shape) {
  return by_shape(
      shape,
      [](const BoxShape& box) {
        return fmt::format("type=\"box\" size=\"{}\"", numbers(box.half_extents_m));
      },
      [](const SphereShape& ball) {
        return fmt::format("type=\"sphere\" size=\"{:.17g}\"", ball.radius_m);
      },
      // 0 0: without end; 1: spacing of a grid nobody draws
      [](const PlaneShape&) { return std::string("type=\"plane\" size=\"0 0 1\""); });
}

std::string friction_attributes(double friction) {
  return fmt::format("condim=\"{}\" friction=\"{:.17g} 0 0\"", friction > 0.0 ? 3 : 1, friction);
}
std::string pair_friction_attributes(double friction) {
  return fmt::format("condim=\"{}\" friction=\"{:.17g} {:.17g} 0 0 0\"", friction > 0.0 ? 3 : 1,
                     friction, friction);
}

using SurfacePair = std::pair<int, int>;

// The laws of all pairs of surfaces that can touch: at least one of the bodies moves.
std::map<SurfacePair, ContactLaw> touching_laws(const World& world) {
  std::map<int, std::pair<std::size_t, std::size_t>> count;  // surface -> moving, fixed bodies
  std::map<int, std::size_t> example;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    auto& [moving, fixed] = count[world.bodies[i].surface];
    ++(world.bodies[i].fixed ? fixed : moving);
    example[world.bodies[i].surface] = i;
  }
  std::map<SurfacePair, ContactLaw> laws;
  for (const auto& [a, in_a] : count) {
    for (const auto& [b, in_b] : count) {
      if (b < a) continue;
      const bool possible = a == b ? in_a.first >= 2 || (in_a.first == 1 && in_a.second >= 1)
                                   : in_a.first + in_b.first >= 1;
      if (possible) laws[{a, b}] = contact_law(world, example[a], example[b]);
    }
  }
  return laws;
}

Expected<void> check_laws(const std::map<SurfacePair, ContactLaw>& laws) {
  for (const auto& [surfaces, law] : laws) {
    if (law.restitution > 0.0) {
      return fail(
          Fault::unsupported,
          fmt::format("restitution {} between surfaces {} and {}: MuJoCo has no coefficient "
                      "of restitution, only 0 can be asked of it",
                      law.restitution, surfaces.first, surfaces.second));
    }
    if (law.friction > 0.0 && law.friction < mjMINMU) {
      return fail(Fault::unsupported,
                  fmt::format("friction {} between surfaces {} and {}: MuJoCo raises it to {}",
                              law.friction, surfaces.first, surfaces.second, mjMINMU));
    }
  }
  return {};
}

// Coefficients f of the surfaces with max(f_a, f_b) = law of (a, b) for all laws; nullopt if there
// are none. The least law of a surface is the largest f it may have, so it is the only candidate.
std::optional<std::map<int, double>> surface_frictions(
    const std::map<SurfacePair, ContactLaw>& laws) {
  std::map<int, double> frictions;
  for (const auto& [surfaces, law] : laws) {
    for (const int surface : {surfaces.first, surfaces.second}) {
      const auto [at, fresh] = frictions.try_emplace(surface, law.friction);
      if (!fresh) at->second = std::min(at->second, law.friction);
    }
  }
  for (const auto& [surfaces, law] : laws) {
    if (std::max(frictions[surfaces.first], frictions[surfaces.second]) != law.friction) {
      return std::nullopt;
    }
  }
  return frictions;
}

std::string body_elements(const World& world, const std::map<int, double>* frictions) {
  std::string text;
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    const Body& body = world.bodies[i];
    std::string geom = fmt::format("<geom name=\"g{}\" {} ", i, shape_attributes(body.shape));
    if (frictions == nullptr) {
      geom += "contype=\"0\" conaffinity=\"0\" ";
    } else if (const auto at = frictions->find(body.surface); at != frictions->end()) {
      geom += friction_attributes(at->second) + ' ';
    }
    if (body.fixed) {
      text += geom + pose(body.initial) + "/>\n";
    } else {
      text += fmt::format(
          "<body {}><freejoint/><inertial pos=\"0 0 0\" mass=\"{:.17g}\" diaginertia=\"{}\"/>{}/>"
          "</body>\n",
          pose(body.initial), body.mass_kg, numbers(body.inertia_kgm2), geom);
    }
  }
  return text;
}

Expected<std::string> pair_elements(const World& world, const std::string& solref) {
  std::string text = "<contact>\n";
  std::size_t pairs = 0;
  for (std::size_t a = 0; a < world.bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < world.bodies.size(); ++b) {
      if (world.bodies[a].fixed && world.bodies[b].fixed) continue;
      if (++pairs > k_max_explicit_pairs) {
        return fail(Fault::unsupported,
                    fmt::format("friction that differs from pair to pair in a world of {} bodies: "
                                "MuJoCo would need more than {} explicit pairs",
                                world.bodies.size(), k_max_explicit_pairs));
      }
      text += fmt::format("<pair geom1=\"g{}\" geom2=\"g{}\" {} {}/>\n", a, b,
                          pair_friction_attributes(contact_law(world, a, b).friction), solref);
    }
  }
  return text + "</contact>\n";
}

Expected<std::string> mjcf(const World& world, const ContactSettings& contact) {
  const auto laws = touching_laws(world);
  if (auto ok = check_laws(laws); !ok) return tl::unexpected(ok.error());
  const auto frictions = surface_frictions(laws);
  const std::string solref =
      fmt::format("solref=\"{:.17g} {:.17g}\"", contact.time_constant_s, contact.damping_ratio);
  // The compiler steps the model once: without contacts, and with room for passes over the tree.
  // allocate() sets the real sizes.
  const std::size_t compiler_stack = 1000000 + 2000 * world.bodies.size();
  std::string text = fmt::format(
      "<mujoco><compiler angle=\"radian\" inertiafromgeom=\"false\"/>"
      "<option><flag contact=\"disable\"/></option>"
      "<size nconmax=\"1\" njmax=\"1\" nstack=\"{}\"/>"
      "<default><geom {}/></default>\n<worldbody>\n",
      compiler_stack, solref);
  text += body_elements(world, frictions ? &*frictions : nullptr) + "</worldbody>\n";
  if (!frictions) {
    auto pairs = pair_elements(world, solref);
    if (!pairs) return pairs;
    text += *pairs;
  }
  return text + "</mujoco>\n";
}

// Bytes of mjData's buffer for the sizes in the model, as mj_makeData adds them up (each array may
// be padded to 64 bytes).
std::int64_t buffer_bytes(const mjModel& model) {
  constexpr std::int64_t k_padding = 64;
  std::int64_t total = 0;
  const mjModel* m = &model;
  MJDATA_POINTERS_PREAMBLE(m)
#define MJ_M(n) n
#define X(type, name, rows, columns) \
  total += std::int64_t{sizeof(type)} * std::int64_t{m->rows} * std::int64_t{columns} + k_padding;
  MJDATA_POINTERS
#undef X
#undef MJ_M
  return total;
}

}  // namespace

void throw_errors_and_warnings() {
  mju_user_error = raise;
  mju_user_warning = raise;
}

Expected<ModelPtr> compile(const World& world, const ContactSettings& contact) {
  const auto text = mjcf(world, contact);
  if (!text) return tl::unexpected(text.error());
  const auto size = static_cast<int>(text->size() + 1);
  const std::unique_ptr<mjVFS, FreeFiles> files(new mjVFS);  // megabytes: never on the stack
  mj_defaultVFS(files.get());
  if (mj_makeEmptyFileVFS(files.get(), k_file, size) != 0) {
    return fail(Fault::out_of_memory, fmt::format("MuJoCo could not hold {} bytes of MJCF", size));
  }
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), k_file)], text->c_str(),
              text->size() + 1);
  std::array<char, 1000> error{};
  ModelPtr model(mj_loadXML(k_file, files.get(), error.data(), static_cast<int>(error.size())));
  mj_freeLastXML();
  if (!model || error[0] != '\0') {
    return fail(Fault::unsupported, fmt::format("MuJoCo's compiler: {}", error.data()));
  }
  model->opt.disableflags &= ~mjDSBL_CONTACT;
  return model;
}

double contact_room(const ContactSettings& contact, double moving_bodies) {
  return std::ceil(50.0 + contact.contacts_per_body * moving_bodies);
}

Expected<DataPtr> allocate(mjModel& model, const ContactSettings& contact) {
  const double moving = model.nv / 6.0;
  const double contacts = contact_room(contact, moving);
  const double rows = contacts * (model.opt.cone == mjCONE_ELLIPTIC ? 3.0 : 4.0);
  constexpr double k_int_max = std::numeric_limits<int>::max();
  // Newton's dense Hessian and its factor; the Jacobian of PGS and noslip; vectors of the solvers.
  const double stack = 1e6 + 3.0 * model.nv * model.nv + 2.0 * model.nv * rows + 100.0 * rows;
  if (rows < k_int_max / 2) {
    model.nconmax = static_cast<int>(contacts);
    model.njmax = static_cast<int>(rows);
    model.nstack = static_cast<int>(std::min(stack, k_int_max));
  }
  if (rows >= k_int_max / 2 || buffer_bytes(model) > std::numeric_limits<int>::max()) {
    return fail(
        Fault::unsupported,
        fmt::format("{} moving bodies need room for {} contacts ({} constraint rows, {} MB), "
                    "MuJoCo {} holds at most 2147 MB",
                    moving, contacts, rows,
                    rows >= k_int_max / 2 ? -1 : buffer_bytes(model) / 1000000,
                    mj_versionString()));
  }
  DataPtr data(mj_makeData(&model));
  if (!data) {
    return fail(Fault::out_of_memory, fmt::format("MuJoCo could not allocate {} MB for {} contacts",
                                                  buffer_bytes(model) / 1000000, contacts));
  }
  return data;
}

double pair_friction(const mjModel& model, int geom_a, int geom_b) {
  for (int p = 0; p < model.npair; ++p) {
    if (std::minmax(model.pair_geom1[p], model.pair_geom2[p]) == std::minmax(geom_a, geom_b)) {
      return model.pair_dim[p] == 1 ? 0.0 : model.pair_friction[5 * p];
    }
  }
  if (std::max(model.geom_condim[geom_a], model.geom_condim[geom_b]) == 1) return 0.0;
  return std::max(model.geom_friction[3 * geom_a], model.geom_friction[3 * geom_b]);
}

}  // namespace brickbench::mujoco
