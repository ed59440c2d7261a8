#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/build_facts.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/gate/defect_map.hpp"
#include "experiments/gate/law_profile.hpp"
#include "experiments/gate/static_truth.hpp"
#include "experiments/record/schema.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

struct OracleOptions {
  std::string scenario = "brick_wall";
  std::vector<std::string> set;  // key=number of the scenario
  std::vector<std::string> engines = {"all"};
  std::string against;  // of defect: engine B
  double step_s = 0.001;
  double duration_s = 0.5;
  std::size_t stride = 10;
  std::size_t count = 200;
  bool json = false;
};

int complain(const std::string& message, int code = k_exit_bad_input) {
  fmt::print(stderr, "brickbench: {}\n", message);
  return code;
}

Expected<Scene> scene_of(const OracleOptions& options, const Catalogues& catalogues) {
  const Scenario* scenario = find_scenario(catalogues, options.scenario);
  if (scenario == nullptr) {
    return fail(Fault::invalid,
                "scenario" + known_names(options.scenario, names_of(catalogues.scenarios)));
  }
  ParameterValues values;
  for (const std::string& text : options.set) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) return fail(Fault::invalid, "--set " + text + ": key=value");
    const std::string value = text.substr(equals + 1);
    const auto number = parse_number(value);
    values[text.substr(0, equals)] = number ? ParameterValue(*number) : ParameterValue(value);
  }
  return build(*scenario, values);
}

// Throws InputError.
std::vector<EngineVariant> engines_of(const std::vector<std::string>& texts,
                                      const Catalogues& catalogues) {
  std::vector<EngineVariant> engines;
  for (const std::string& text : texts) {
    const Selector selector = parse_selector(text, {.file = "--engine"}, catalogues, true);
    for (const EngineVariant& engine : select(selector, catalogues)) engines.push_back(engine);
  }
  return engines;
}

Settings settings_of(const OracleOptions& options, const EngineVariant& engine) {
  return {.step_s = options.step_s, .variant = engine.variant, .knobs = {}, .threads = 1};
}

std::size_t steps_of(const OracleOptions& options) {
  return static_cast<std::size_t>(std::llround(options.duration_s / options.step_s));
}

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

int laws(const OracleOptions& options, const Catalogues& catalogues) {
  const auto scene = scene_of(options, catalogues);
  if (!scene) return complain(scene.error().reason);
  auto records = Json::array();
  int code = k_exit_fine;
  if (!options.json) {
    fmt::print("{:<22} {:<16} {:>10} {:>10} {:>10} {:>4} {:>9} {:>8}  {}\n", "engine", "law",
               "worst", "proven", "allowance", "unit", "broken", "at_s", "bodies");
  }
  for (const EngineVariant& engine : engines_of(options.engines, catalogues)) {
    const auto recording = gate::record(*find_adapter(catalogues, engine.engine),
                                        settings_of(options, engine), *scene, steps_of(options));
    if (!recording) {
      const std::string outcome(to_outcome(recording.error().fault));
      records.push_back(
          {{"id", engine.label()}, {"outcome", outcome}, {"reason", recording.error().reason}});
      if (!options.json) {
        fmt::print("{:<22} {}: {}\n", engine.label(), outcome, recording.error().reason);
      }
      if (recording.error().fault != Fault::unsupported) code = k_exit_failed_case;
      continue;
    }
    for (const auto& v : gate::law_profile(*scene, *recording, {.stride = options.stride})) {
      records.push_back({{"id", engine.label() + ':' + v.law},
                         {"outcome", "ok"},
                         {"law", v.law},
                         {"unit", v.unit},
                         {"worst", v.worst},
                         {"proven", v.proven},
                         {"total", v.total},
                         {"allowance", v.allowance},
                         {"steps_broken", v.steps},
                         {"steps_looked_at", v.looked_at},
                         {"worst_time_s", v.worst_time_s},
                         {"body_a", v.body_a},
                         {"body_b", v.body_b}});
      if (options.json) continue;
      fmt::print("{:<22} {:<16} {:>10.3g} {:>10.3g} {:>10.3g} {:>4} {:>9} {:>8.3f}  {} {}\n",
                 engine.label(), v.law, v.worst, v.proven, v.allowance, v.unit,
                 fmt::format("{}/{}", v.steps, v.looked_at), v.worst_time_s, v.body_a, v.body_b);
    }
  }
  if (options.json) fmt::print("{}\n", records.dump(2));
  return code;
}

void print_defect(const Scene& scene, const gate::StepDefect& d) {
  const auto& bodies = scene.world.bodies;
  fmt::print(
      "  step {} ({:.4f} s): {:.3g} N s, most at {} against {}, contact at ({:.3f}, {:.3f}, "
      "{:.3f}) m, gap {:.2g} m\n",
      d.step, d.time_s, d.total_ns, bodies[d.worst_body].name, bodies[d.partner].name,
      d.contact_m.x(), d.contact_m.y(), d.contact_m.z(), d.gap_m);
}

int defect(const OracleOptions& options, const Catalogues& catalogues) {
  constexpr double share = 0.01;  // of the lightest body's weight times step
  const auto scene = scene_of(options, catalogues);
  if (!scene) return complain(scene.error().reason);
  const auto others = engines_of({options.against}, catalogues);
  auto records = Json::array();
  int code = k_exit_fine;
  for (const EngineVariant& a : engines_of(options.engines, catalogues)) {
    const auto recording = gate::record(*find_adapter(catalogues, a.engine),
                                        settings_of(options, a), *scene, steps_of(options));
    for (const EngineVariant& b : others) {
      const std::string id = a.label() + " continued by " + b.label();
      auto map =
          recording ? gate::defect_map(*find_adapter(catalogues, b.engine), settings_of(options, b),
                                       *scene, *recording, options.stride, share)
                    : tl::unexpected(recording.error());
      if (!map) {
        records.push_back({{"id", id},
                           {"outcome", to_outcome(map.error().fault)},
                           {"reason", map.error().reason}});
        if (!options.json) fmt::print("{}: {}\n", id, map.error().reason);
        if (map.error().fault != Fault::unsupported) code = k_exit_failed_case;
        continue;
      }
      auto steps = Json::array();
      for (const gate::StepDefect& d : map->steps) {
        steps.push_back({{"step", d.step},
                         {"time_s", d.time_s},
                         {"total_ns", d.total_ns},
                         {"worst_body", scene->world.bodies[d.worst_body].name},
                         {"partner", scene->world.bodies[d.partner].name},
                         {"gap_m", number(d.gap_m)},
                         {"per_body_ns", d.per_body_ns}});
      }
      records.push_back(
          {{"id", id},
           {"outcome", "ok"},
           {"threshold_ns", map->threshold_ns},
           {"first",
            map->first < map->steps.size() ? Json(map->steps[map->first].step) : Json(nullptr)},
           {"steps", steps}});
      if (options.json) continue;
      double sum = 0.0;
      for (const auto& d : map->steps) sum += d.total_ns;
      fmt::print("{}: mean {:.3g} N s over {} steps, threshold {:.3g} N s\n", id,
                 sum / static_cast<double>(map->steps.size()), map->steps.size(),
                 map->threshold_ns);
      if (map->first == map->steps.size()) {
        fmt::print("  never part\n");
        continue;
      }
      print_defect(*scene, map->steps[map->first]);
      const auto worst = std::ranges::max_element(map->steps, {}, &gate::StepDefect::total_ns);
      print_defect(*scene, *worst);
    }
  }
  if (options.json) fmt::print("{}\n", records.dump(2));
  return code;
}

// An assembly moved if a brick is further than this share of its smallest edge from its start.
constexpr double k_moved_share = 0.2;

Expected<bool> moved(const Adapter& adapter, const Settings& settings, const World& world,
                     std::size_t steps) {
  auto simulation = build(adapter, world, settings);
  if (!simulation) return tl::unexpected(simulation.error());
  std::vector<State> states(world.bodies.size());
  for (std::size_t step = 0; step < steps; ++step) {
    if (auto ok = (*simulation)->step(); !ok) return tl::unexpected(ok.error());
  }
  (*simulation)->read(states);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!is_finite(states[i])) return fail(Fault::diverged, "not finite");
    const auto* box = std::get_if<BoxShape>(&world.bodies[i].shape);
    if (box == nullptr) continue;
    const double limit_m = 2.0 * k_moved_share * box->half_extents_m.minCoeff();
    const Eigen::Vector3d way = states[i].position_m - world.bodies[i].initial.position_m;
    if (way.norm() > limit_m) return true;
  }
  return false;
}

int statics(const OracleOptions& options, const Catalogues& catalogues) {
  constexpr std::uint64_t seed = 1;
  constexpr double tilt_rad = 0.01;
  const auto assemblies = gate::labelled_assemblies(options.count, seed, tilt_rad);
  std::map<std::string, std::map<std::string, int>> counts;
  std::size_t stands = 0;
  for (const auto& item : assemblies) stands += item.verdict.label == gate::StaticLabel::stands;
  const auto engines = engines_of(options.engines, catalogues);
  Progress progress(engines.size());
  for (const EngineVariant& engine : engines) {
    progress.begin(engine.label());
    auto& count = counts[engine.label()];
    for (const auto& item : assemblies) {
      const auto result = moved(*find_adapter(catalogues, engine.engine),
                                settings_of(options, engine), item.world, steps_of(options));
      const std::string truth =
          item.verdict.label == gate::StaticLabel::stands ? "stands" : "falls";
      const std::string seen = !result   ? std::string(to_outcome(result.error().fault))
                               : *result ? "moved"
                                         : "stood";
      ++count[truth + '/' + seen];
      if ((truth == "stands") == (seen == "stood")) continue;
      ++count[truth + '/' + seen + " (" + item.family + ')'];
    }
    progress.end(engine.label());
  }
  if (options.json) {
    auto records = Json::array();
    for (const auto& [engine, count] : counts)
      records.push_back({{"id", engine}, {"counts", count}});
    fmt::print("{}\n", records.dump(2));
    return k_exit_fine;
  }
  fmt::print("{} assemblies: {} stand (forces shown), {} fall (proven); {} s at {} s steps\n",
             assemblies.size(), stands, assemblies.size() - stands, options.duration_s,
             options.step_s);
  for (const auto& [engine, count] : counts) {
    fmt::print("{:<24}", engine);
    for (const auto& [what, n] : count) fmt::print(" {} {};", what, n);
    fmt::print("\n");
  }
  return k_exit_fine;
}

using Action = int (*)(const OracleOptions&, const Catalogues&);

int guarded(Action action, const OracleOptions& options) {
  try {
    return action(options, all_catalogues());
  } catch (const InputError& error) {
    return complain(error.text());
  }
}

CLI::App* add(CLI::App& parent, Invocation& invocation, const std::string& name,
              const std::string& meaning, Action action,
              const std::shared_ptr<OracleOptions>& options) {
  CLI::App* verb = parent.add_subcommand(name, meaning);
  verb->add_option("--engine", options->engines, "Engine selector; may be repeated; default all")
      ->expected(1)
      ->take_all();
  verb->add_option("--step", options->step_s, "Time step, s")->check(CLI::PositiveNumber);
  verb->add_option("--duration", options->duration_s, "Simulated time, s")
      ->check(CLI::PositiveNumber);
  verb->add_flag("--json", options->json, "The result as JSON on standard output");
  verb->callback([=, &invocation] { invocation.exit_code = guarded(action, *options); });
  return verb;
}

void add_scene(CLI::App* verb, const std::shared_ptr<OracleOptions>& options) {
  verb->add_option("scenario", options->scenario, "One of `list scenarios`");
  verb->add_option("--set", options->set, "key=value of the scenario; may be repeated")
      ->expected(1)
      ->take_all();
  verb->add_option("--stride", options->stride, "Judge every so many steps; default 10")
      ->check(CLI::PositiveNumber);
}

}  // namespace

void add_oracle_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* oracle =
      app.add_subcommand("oracle", "Judge engines from their states alone, or step by step");
  oracle->require_subcommand(1);
  auto of_laws = std::make_shared<OracleOptions>();
  add_scene(add(*oracle, invocation, "laws", "Which law each engine breaks, when and where", laws,
                of_laws),
            of_laws);
  auto of_defect = std::make_shared<OracleOptions>();
  CLI::App* verb =
      add(*oracle, invocation, "defect",
          "Continue the engine's states in another, one step at a time", defect, of_defect);
  add_scene(verb, of_defect);
  verb->add_option("--against", of_defect->against, "Selector of the other engines")->required();
  auto of_statics = std::make_shared<OracleOptions>();
  of_statics->step_s = 1.0 / 240.0;
  of_statics->duration_s = 2.0;
  add(*oracle, invocation, "statics",
      "Which of many labelled walls and towers stand, and which do in each engine", statics,
      of_statics)
      ->add_option("--count", of_statics->count, "Number of assemblies; default 200");
}

}  // namespace brickbench
