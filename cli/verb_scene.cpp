#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "adapters/seam/shape.hpp"
#include "cli/build_facts.hpp"
#include "cli/complain.hpp"
#include "cli/scene_json.hpp"
#include "cli/scene_settings.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/exact/sketch/sketch.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/schema.hpp"
#include "experiments/run/scene_choice.hpp"
#include "experiments/scenes/scene_text.hpp"

namespace brickbench {
namespace {

struct SceneOptions {
  std::string scene;
  std::vector<std::string> set;
  double step_s = 0.0;  // 0: none was asked for
  std::string svg;
  std::string out;
  std::string as = "toml";
  bool json = false;
};

// A scene with its parameters set.
struct BuiltScene {
  SceneChoice choice;
  ParameterValues values;  // complete
  Scene scene;
};

Expected<BuiltScene> built_scene(const SceneOptions& options) {
  static const Catalogues k_catalogues = all_catalogues();
  auto choice = choose_scene(options.scene, "scene " + options.scene, k_catalogues);
  if (!choice) return fail(Fault::invalid, choice.error().text());
  const auto given = scene_settings(options.set);
  if (!given) return tl::unexpected(given.error());
  auto values = complete(*choice->scenario, *given);
  if (!values) return tl::unexpected(values.error());
  auto scene = build(*choice->scenario, *values);
  if (!scene) return tl::unexpected(scene.error());
  return BuiltScene{std::move(*choice), std::move(*values), std::move(*scene)};
}

Table bodies_table(const Scene& scene) {
  Table table;
  table.title = "bodies";
  table.header = {"body", "shape", "size_m", "mass_kg", "position_m", "speed_mps", "role"};
  constexpr std::size_t k_most_rows = 40;
  const World& world = scene.world;
  for (std::size_t i = 0; i < std::min(world.bodies.size(), k_most_rows); ++i) {
    const Body& body = world.bodies[i];
    const auto text = [](const Eigen::Vector3d& v) {
      return fmt::format("{:.4g} {:.4g} {:.4g}", v.x(), v.y(), v.z());
    };
    const bool plane = is_half_space(body.shape);
    table.rows.push_back({{body.name},
                          {std::string(shape_word(body.shape))},
                          {plane ? "" : text(2.0 * half_extents_m(body.shape))},
                          {body.fixed ? "" : fmt::format("{:.4g}", body.mass_kg)},
                          {text(body.initial.position_m)},
                          {fmt::format("{:.4g}", body.initial.velocity_mps.norm())},
                          {std::string(role_word(scene, i))}});
  }
  if (world.bodies.size() > k_most_rows) {
    table.title = fmt::format("the first {} of {} bodies", k_most_rows, world.bodies.size());
  }
  return table;
}

void print_touches(const World& world, const std::vector<Touch>& touches) {
  std::size_t overlaps = 0;
  for (const Touch& touch : touches) {
    if (!touch.overlap) continue;
    ++overlaps;
    if (overlaps > 10) continue;
    fmt::print("overlap: {} and {}, {:.4g} m\n", world.bodies[touch.body_a].name,
               world.bodies[touch.body_b].name, touch.depth_m);
  }
  fmt::print("at the start {} pairs touch and {} overlap\n", touches.size() - overlaps, overlaps);
}

void print_scene(const BuiltScene& built) {
  const Scenario& scenario = *built.choice.scenario;
  const World& world = built.scene.world;
  fmt::print("{}: {}\n", scenario.name, scenario.meaning);
  if (!scenario.file.empty()) fmt::print("file {}, hash {}\n", scenario.file, scenario.hash);
  fmt::print("{}\n", to_terminal(bodies_table(built.scene), standard_output_style()));
  const Eigen::Vector3d& g = world.gravity_mps2;
  fmt::print("gravity ({}, {}, {}) m/s2; duration {} s\n", g.x(), g.y(), g.z(),
             scenario.duration_s);
  fmt::print("law of all pairs: friction {}, restitution {}\n", world.law.friction,
             world.law.restitution);
  for (const PairLaw& pair : world.exceptions) {
    fmt::print("law of surfaces {} and {}: friction {}, restitution {}\n", pair.surface_a,
               pair.surface_b, pair.law.friction, pair.law.restitution);
  }
  print_touches(world, touches_at_start(world));
  fmt::print("blows {}, forces {}; mass that moves {:.6g} kg\n", built.scene.blows.size(),
             built.scene.pushes.size(), moving_mass_kg(world));
}

int show(const SceneOptions& options) {
  const auto built = built_scene(options);
  if (!built) return complain(built.error());
  if (!options.svg.empty()) {
    const Scenario& scenario = *built->choice.scenario;
    const std::string svg = exact::sketch_svg(scenario.name, scenario.duration_s, built->scene);
    if (auto ok = write_new_file(options.svg, svg); !ok) return complain(ok.error());
  }
  if (options.json)
    fmt::print("{}\n", scene_json(*built->choice.scenario, built->values, built->scene).dump(2));
  else
    print_scene(*built);
  return k_exit_fine;
}

int check_scene(const SceneOptions& options) {
  const auto built = built_scene(options);
  if (!built) return complain(built.error());
  const std::optional<double> step_s =
      options.step_s > 0.0 ? std::optional(options.step_s) : std::nullopt;
  const std::vector<Doubt> found = doubts(built->scene, step_s);
  const double longest_s = longest_step_s(built->scene);
  const int code = found.empty() ? k_exit_fine : k_exit_failed_case;
  if (options.json) {
    fmt::print("{}\n", doubts_json(built->choice.scenario->name, found, longest_s, code).dump(2));
    return code;
  }
  constexpr std::size_t k_most_of_a_kind = 10;
  std::map<std::string, std::size_t> told;
  for (const Doubt& doubt : found) {
    if (++told[doubt.kind] <= k_most_of_a_kind) fmt::print("{}: {}\n", doubt.kind, doubt.text);
  }
  for (const auto& [kind, count] : told) {
    if (count > k_most_of_a_kind) fmt::print("{}: {} in all\n", kind, count);
  }
  if (std::isfinite(longest_s)) {
    fmt::print("steps up to {:.4g} s let no body move by more than half its thickness\n",
               longest_s);
  }
  fmt::print("{}\n", found.empty() ? std::string("nothing is suspicious")
                                   : fmt::format("{} suspicion{}", found.size(),
                                                 found.size() == 1 ? "" : "s"));
  return code;
}

// The parameters as the comment of an exported file has them.
std::string values_comment(const BuiltScene& built) {
  std::string text = built.choice.scenario->name;
  for (const auto& [name, value] : built.values) {
    const auto* number = std::get_if<double>(&value);
    text += fmt::format(" {}={}", name,
                        number != nullptr ? shortest(*number) : std::get<std::string>(value));
  }
  return text;
}

int export_scene(const SceneOptions& options) {
  const auto built = built_scene(options);
  if (!built) return complain(built.error());
  const Scenario& scenario = *built->choice.scenario;
  const auto text = scene_text(built->scene, {.title = scenario.meaning,
                                              .comment = values_comment(*built),
                                              .duration_s = scenario.duration_s});
  if (!text) return complain(text.error());
  if (!options.out.empty()) {
    if (auto ok = write_new_file(options.out, *text); !ok) return complain(ok.error());
  }
  if (options.json) {
    const nlohmann::ordered_json json = {
        {"id", scenario.name}, {"as", options.as}, {"file", options.out}, {"text", *text}};
    fmt::print("{}\n", json.dump(2));
  } else if (options.out.empty()) {
    fmt::print("{}", *text);
  } else {
    fmt::print("{}\n", options.out);
  }
  return k_exit_fine;
}

std::shared_ptr<SceneOptions> add_scene_options(CLI::App& verb) {
  auto options = std::make_shared<SceneOptions>();
  verb.add_option("scene", options->scene,
                  "Scene file (it ends in .toml), or one of `list scenarios`")
      ->required();
  verb.add_option("--set", options->set, "key=value of a parameter; may be repeated")
      ->expected(1)
      ->take_all();
  verb.add_flag("--json", options->json, "The same as JSON on standard output");
  return options;
}

}  // namespace

void add_scene_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* scene = app.add_subcommand("scene", "Look at a scene, question it, write it out");
  scene->require_subcommand(1);

  CLI::App* shown = scene->add_subcommand("show", "Bodies, masses, laws, contacts of the start");
  auto show_options = add_scene_options(*shown);
  shown->add_option("--svg", show_options->svg, "New file for a drawing of the start");
  shown->callback([show_options, &invocation] { invocation.exit_code = show(*show_options); });

  CLI::App* checked = scene->add_subcommand(
      "check",
      "What is suspicious, with numbers: overlaps, inertias, ratios, steps; 1 if anything");
  auto check_options = add_scene_options(*checked);
  checked->add_option("--step", check_options->step_s, "Step (s) of the run that is meant")
      ->check(CLI::PositiveNumber);
  checked->callback(
      [check_options, &invocation] { invocation.exit_code = check_scene(*check_options); });

  CLI::App* exported = scene->add_subcommand("export", "The scene as a file, parameters set");
  auto export_options = add_scene_options(*exported);
  exported->add_option("--as", export_options->as, "toml: a scene file of this program")
      ->check(CLI::IsMember({"toml"}));
  exported->add_option("--out", export_options->out, "New file; default standard output");
  exported->callback(
      [export_options, &invocation] { invocation.exit_code = export_scene(*export_options); });
}

}  // namespace brickbench
