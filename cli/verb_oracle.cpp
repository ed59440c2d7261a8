#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "adapters/seam/unit.hpp"
#include "cli/complain.hpp"
#include "cli/engine_files.hpp"
#include "cli/json_number.hpp"
#include "cli/number_option.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/oracle/confusion.hpp"
#include "experiments/oracle/defect_map.hpp"
#include "experiments/oracle/law_profile.hpp"
#include "experiments/record/schema.hpp"
#include "experiments/run/plan.hpp"
#include "experiments/run/scene_choice.hpp"
#include "experiments/run/selector.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

struct OracleOptions {
  std::string scenario = "brick_wall";
  std::vector<std::string> set;  // key=number of the scenario
  std::vector<std::string> engines = {"all"};
  std::vector<std::string> engine_files;
  std::string against;  // of defect: engine B
  double step_s = 0.001;
  double duration_s = 0.5;
  std::size_t stride = 10;
  std::size_t count = 200;
  bool json = false;
  bool markdown = false;
};

enum class Form { text, json, markdown };

Form form_of(const OracleOptions& options) {
  return options.json ? Form::json : options.markdown ? Form::markdown : Form::text;
}

Expected<Scene> scene_of(const OracleOptions& options, const Catalogues& catalogues) {
  const auto choice = choose_scene(options.scenario, "--scenario " + options.scenario, catalogues);
  if (!choice) return fail(Fault::invalid, choice.error().text());
  ParameterValues values;
  for (const std::string& text : options.set) {
    const auto equals = text.find('=');
    if (equals == std::string::npos) return fail(Fault::invalid, "--set " + text + ": key=value");
    const std::string value = text.substr(equals + 1);
    const auto number = parse_number(value);
    values[text.substr(0, equals)] = number ? ParameterValue(*number) : ParameterValue(value);
  }
  return build(*choice->scenario, values);
}

Checked<std::vector<EngineVariant>> engines_of(const std::vector<std::string>& texts,
                                               const std::string& option,
                                               const Catalogues& catalogues) {
  std::vector<EngineVariant> engines;
  for (const std::string& text : texts) {
    const auto selector = parse_selector(text, {.file = option}, catalogues, true);
    if (!selector) return tl::unexpected(selector.error());
    for (const EngineVariant& engine : select(*selector, catalogues)) engines.push_back(engine);
  }
  return engines;
}

// The engines of --engine and of --against.
struct Chosen {
  std::vector<EngineVariant> engines;
  std::vector<EngineVariant> others;
};

Settings settings_of(const OracleOptions& options, const EngineVariant& engine) {
  return {.step_s = options.step_s, .variant = engine.variant, .knobs = {}, .threads = 1};
}

std::size_t steps_of(const OracleOptions& options) {
  return static_cast<std::size_t>(std::llround(options.duration_s / options.step_s));
}

Json json_of(const std::string& engine, const gate::Violation& v, bool most) {
  return {{"id", engine + ':' + v.law},
          {"outcome", "ok"},
          {"law", v.law},
          {"unit", v.unit},
          {"worst", v.worst},
          {"proven", v.proven},
          {"total", v.total},
          {"allowance", v.allowance},
          {"steps_broken", v.steps},
          {"steps_looked_at", v.looked_at},
          {"broken_most", most},
          {"worst_time_s", v.worst_time_s},
          {"body_a", v.body_a},
          {"body_b", v.body_b}};
}

void print_violation(const std::string& engine, const gate::Violation& v, bool most, Form form) {
  const std::string bodies = v.body_b.empty() ? v.body_a : v.body_a + ", " + v.body_b;
  const std::string broken = fmt::format("{}/{}", v.steps, v.looked_at);
  if (form == Form::markdown) {
    const std::string law = most ? fmt::format("**{}**", v.law) : v.law;
    fmt::print("| {} | {} | {:.3g}{} | {:.3g} | {} | {:.3f} | {} |\n", engine, law, v.worst,
               unit_suffix(v.unit), v.allowance, broken, v.worst_time_s, bodies);
  } else {
    fmt::print("{:<22} {:<16} {:>10.3g} {:>10.3g} {:>10.3g} {:>4} {:>9} {:>8.3f}  {}{}\n", engine,
               v.law, v.worst, v.proven, v.allowance, v.unit, broken, v.worst_time_s, bodies,
               most ? "  (broken most)" : "");
  }
}

void print_laws_head(const OracleOptions& options, Form form) {
  if (form == Form::text) {
    fmt::print("{:<22} {:<16} {:>10} {:>10} {:>10} {:>4} {:>9} {:>8}  {}\n", "engine", "law",
               "worst", "proven", "allowance", "unit", "broken", "at_s", "bodies");
  } else if (form == Form::markdown) {
    std::string set;
    for (const std::string& text : options.set) set += ", " + text;
    fmt::print("{}{}; {:.4g} s at {:.4g} s steps, contact impulses judged at every {}th step\n\n",
               options.scenario, set, options.duration_s, options.step_s, options.stride);
    fmt::print(
        "| engine | law | worst | allowed | steps broken | at, s | bodies |\n"
        "|---|---|---:|---:|---:|---:|---|\n");
  }
}

int laws(const OracleOptions& options, const Catalogues& catalogues, const Chosen& chosen) {
  const auto scene = scene_of(options, catalogues);
  if (!scene) return complain(scene.error());
  const Form form = form_of(options);
  auto records = Json::array();
  int code = k_exit_fine;
  print_laws_head(options, form);
  Progress progress(chosen.engines.size());
  for (const EngineVariant& engine : chosen.engines) {
    progress.begin(engine.label());
    const Adapter& adapter = *find_adapter(catalogues, engine.engine);
    const Settings settings = settings_of(options, engine);
    const auto recording = gate::record(adapter, settings, *scene, steps_of(options));
    if (!recording) {
      const std::string outcome(to_outcome(recording.error().fault));
      const std::string& reason = recording.error().reason;
      records.push_back({{"id", engine.label()}, {"outcome", outcome}, {"reason", reason}});
      if (form != Form::json) {
        fmt::print(fmt::runtime(form == Form::markdown ? "| {} | {}: {} | | | | | |\n"
                                                       : "{:<22} {}: {}\n"),
                   engine.label(), outcome, reason);
      }
      if (recording.error().fault != Fault::unsupported) code = k_exit_failed_case;
      progress.end(engine.label());
      continue;
    }
    const auto profile =
        gate::law_profile(*scene, *recording, gate::law_plan(adapter, settings, options.stride));
    const gate::Violation* most = gate::broken_most(profile);
    for (const gate::Violation& v : profile) {
      records.push_back(json_of(engine.label(), v, &v == most));
      if (form != Form::json) print_violation(engine.label(), v, &v == most, form);
    }
    progress.end(engine.label());
  }
  if (form == Form::json) fmt::print("{}\n", records.dump(2));
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

int defect(const OracleOptions& options, const Catalogues& catalogues, const Chosen& chosen) {
  constexpr double share = 0.01;  // of the lightest body's weight times step
  const auto scene = scene_of(options, catalogues);
  if (!scene) return complain(scene.error());
  auto records = Json::array();
  int code = k_exit_fine;
  for (const EngineVariant& a : chosen.engines) {
    const auto recording = gate::record(*find_adapter(catalogues, a.engine),
                                        settings_of(options, a), *scene, steps_of(options));
    for (const EngineVariant& b : chosen.others) {
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
                         {"gap_m", json_number(d.gap_m)},
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

Json json_of(const gate::Confusion& c) {
  return {{"stands_stood", c.stands_stood},
          {"stands_moved", c.stands_moved},
          {"falls_stood", c.falls_stood},
          {"falls_moved", c.falls_moved},
          {"wrong", c.wrong},
          {"failed", c.failed},
          {"reason", c.reason}};
}

std::string listed(const std::map<std::string, int>& counts) {
  std::string text;
  for (const auto& [what, n] : counts)
    text += fmt::format("{}{} {}", text.empty() ? "" : "; ", n, what);
  return text;
}

void print_confusion(const std::string& engine, const gate::Confusion& c, Form form) {
  std::string notes = listed(c.wrong);
  if (!c.failed.empty()) {
    notes += fmt::format("{}{}: {}", notes.empty() ? "" : "; ", listed(c.failed), c.reason);
  }
  fmt::print(fmt::runtime(form == Form::markdown ? "| {} | {} | {} | {} | {} | {} |\n"
                                                 : "{:<20} {:>13} {:>13} {:>12} {:>12}  {}\n"),
             engine, c.stands_stood, c.stands_moved, c.falls_stood, c.falls_moved, notes);
}

int statics(const OracleOptions& options, const Catalogues& catalogues, const Chosen& chosen) {
  constexpr std::uint64_t seed = 1;
  const std::vector<EngineVariant>& engines = chosen.engines;
  const auto assemblies = gate::labelled_assemblies(options.count, seed);
  if (assemblies.size() < options.count) {
    return complain(fmt::format("only {} assemblies have a strict label", assemblies.size()),
                    k_exit_bad_input);
  }
  const auto stands = std::ranges::count_if(assemblies, [](const gate::LabelledAssembly& item) {
    return item.verdict.label == gate::StaticLabel::stands;
  });
  const auto falls = static_cast<std::ptrdiff_t>(assemblies.size()) - stands;
  const Form form = form_of(options);
  if (form != Form::json) {
    fmt::print(
        "{} assemblies: {} stand (forces shown), {} fall (proven); {:.4g} s at {:.4g} s steps\n",
        assemblies.size(), stands, falls, options.duration_s, options.step_s);
  }
  if (form == Form::markdown) {
    fmt::print(
        "\n| engine | stands, stood | stands, moved | falls, stood | falls, moved | wrong in |\n"
        "|---|---:|---:|---:|---:|---|\n");
  } else if (form == Form::text) {
    fmt::print("{:<20} {:>13} {:>13} {:>12} {:>12}\n", "engine", "stands, stood", "stands, moved",
               "falls, stood", "falls, moved");
  }
  Progress progress(engines.size());
  auto records = Json::array();
  int code = k_exit_fine;
  for (const EngineVariant& engine : engines) {
    progress.begin(engine.label());
    const gate::Confusion c =
        gate::confusion(*find_adapter(catalogues, engine.engine), settings_of(options, engine),
                        assemblies, steps_of(options));
    progress.end(engine.label());
    const bool only_refused =
        c.failed.empty() || (c.failed.size() == 1 && c.failed.contains("refused"));
    if (!only_refused) code = k_exit_failed_case;
    if (form == Form::json) {
      Json record = {{"id", engine.label()}, {"stands", stands}, {"falls", falls}};
      record.update(json_of(c));
      records.push_back(record);
    } else {
      print_confusion(engine.label(), c, form);
    }
  }
  if (form == Form::json) fmt::print("{}\n", records.dump(2));
  return code;
}

using Action = int (*)(const OracleOptions&, const Catalogues&, const Chosen&);

int act(Action action, const OracleOptions& options) {
  if (const double steps = options.duration_s / options.step_s; !(steps <= k_most_steps)) {
    return complain(fmt::format("--duration {} in steps of {} s is {:.3g} steps; at most {:.0e}",
                                options.duration_s, options.step_s, steps, k_most_steps),
                    k_exit_bad_input);
  }
  const auto known = running_catalogues(options.engine_files);
  if (!known) return complain(known.error().text(), k_exit_bad_input);
  const Catalogues& catalogues = *known;
  const auto engines = engines_of(options.engines, "--engine", catalogues);
  if (!engines) return complain(engines.error().text(), k_exit_bad_input);
  const std::vector<std::string> against =
      options.against.empty() ? std::vector<std::string>{} : std::vector{options.against};
  const auto others = engines_of(against, "--against", catalogues);
  if (!others) return complain(others.error().text(), k_exit_bad_input);
  return action(options, catalogues, {*engines, *others});
}

CLI::App* add(CLI::App& parent, Invocation& invocation, const std::string& name,
              const std::string& meaning, Action action,
              const std::shared_ptr<OracleOptions>& options) {
  CLI::App* verb = parent.add_subcommand(name, meaning);
  verb->add_option("--engine", options->engines, "Engine selector; may be repeated; default all")
      ->expected(1)
      ->take_all();
  add_engine_files(*verb, options->engine_files);
  add_number(*verb, "--step", options->step_s, "Time step, s: 0.004 or 1/240", Sign::positive);
  add_number(*verb, "--duration", options->duration_s, "Simulated time, s", Sign::positive);
  CLI::Option* json =
      verb->add_flag("--json", options->json, "The result as JSON on standard output");
  if (action != defect) {
    verb->add_flag("--markdown", options->markdown, "The result as Markdown")->excludes(json);
  }
  verb->callback([=, &invocation] { invocation.exit_code = act(action, *options); });
  return verb;
}

void add_scene(CLI::App* verb, const std::shared_ptr<OracleOptions>& options) {
  verb->add_option("scenario", options->scenario, "One of `list scenarios`, or a scene file");
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
      ->add_option("--count", of_statics->count, "Number of assemblies; default 200")
      ->check(CLI::PositiveNumber);
}

}  // namespace brickbench
