#include "reports/src/html_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "reports/src/ensemble_report.hpp"
#include "reports/src/figures.hpp"
#include "reports/src/html_sections.hpp"
#include "reports/src/markdown_report.hpp"
#include "reports/src/markup.hpp"
#include "reports/src/page_answer.hpp"
#include "reports/src/validation.hpp"

namespace brickbench {
namespace {

struct SourceFigures {
  std::vector<Figure> time;
  std::vector<Figure> step;
  std::vector<Figure> cost;
};

// Ids are unique over the whole page.
void number_ids(std::vector<Figure>& figures, const std::string& prefix) {
  for (Figure& figure : figures) figure.id = prefix + figure.id;
}

// What a reader looks at first; the other curves of a scene wait behind a line.
constexpr std::array<std::string_view, 6> k_first_curves = {
    "kinetic_energy_j", "total_energy_j", "penetration_m",
    "displaced_count",  "contacts_now",   "linear_momentum_y_ns"};

// Figures of exact cases: as many are shown, the others wait as well.
constexpr std::size_t k_most_cases = 6;

bool comes_first(const Figure& figure) {
  return !figure.over_time ||
         std::ranges::find(k_first_curves, figure.heading) != k_first_curves.end();
}

std::string grid(const std::string& figures) {
  return "<div class=\"figures\">\n" + figures + "</div>\n";
}

std::string figures_html(const std::vector<Figure>& figures, const SceneNames& names,
                         bool draw_svg) {
  std::string out;
  for (auto from = figures.begin(); from != figures.end();) {
    const auto to = std::find_if(from, figures.end(),
                                 [&](const Figure& other) { return other.scene != from->scene; });
    if (!from->scene.empty())
      out += fmt::format("<h4>{}</h4>\n", escape_markup(names.brief(from->scene)));
    const bool any_first = std::any_of(from, to, comes_first);
    std::string first;
    std::string rest;
    std::size_t shown = 0;
    std::size_t waiting = 0;
    for (; from != to; ++from) {
      const bool fits = !from->scene.empty() || shown < k_most_cases;
      const bool now = (!any_first || comes_first(*from)) && fits;
      shown += now ? 1U : 0U;
      waiting += now ? 0U : 1U;
      (now ? first : rest) += html_figure(*from, draw_svg);
    }
    out += grid(first);
    if (waiting > 0) {
      out +=
          fmt::format("<details class=\"more\"><summary>{} more figures</summary>\n{}</details>\n",
                      waiting, grid(rest));
    }
  }
  return out;
}

// What keeps the page small, the same for all its replays.
struct ReplayLimits {
  std::size_t frames;
  std::size_t contact_stride;
};

ReplayLimits replay_limits(std::span<const ReportSource> sources, const ReportOptions& options) {
  std::size_t bodies = 0;
  for (const ReportSource& source : sources) {
    for (const Replay& replay : source.replays) bodies += replay.bodies.size();
  }
  const std::size_t frames = frames_within_page(bodies, options.replay_frames);
  std::size_t points = 0;
  for (const ReportSource& source : sources) {
    for (const Replay& replay : source.replays) {
      const std::size_t all = std::max<std::size_t>(1, replay.times_s.size());
      points += replay.contact_points_m.size() / 3 * std::min(frames, all) / all;
    }
  }
  return {frames, 1 + points / k_page_contact_points};
}

// What is shown of what was recorded.
std::string replay_facts(const ReportSource& source, const ReplayLimits& limits) {
  std::size_t most = 0;
  bool contacts = false;
  std::string notes;
  for (const Replay& replay : source.replays) {
    most = std::max({most, replay.recorded_frames, replay.times_s.size()});
    contacts = contacts || !replay.contact_offsets.empty();
    if (replay.note.empty()) continue;
    notes += fmt::format(" {}{}: {}.", replay.engine, replay.flagged_from_s ? "" : " ended early",
                         replay.note);
  }
  std::string out = fmt::format(
      "{} of {} recorded cells{}; {} of up to {} recorded frames each, motion between them "
      "interpolated; positions to {:g} mm.",
      source.replays.size(), std::max(source.recorded_cells, source.replays.size()),
      source.replays.size() < source.recorded_cells ? " (of several seeds the lowest)" : "",
      std::min(limits.frames, most), most, 500.0 * k_position_lattice_m);
  if (contacts) {
    out += fmt::format(
        " Contact points as each engine tells them, to {:g} mm, {}.", 500.0 * k_contact_lattice_m,
        limits.contact_stride == 1
            ? std::string("of the last frame shown")
            : fmt::format("of every frame number {} of those shown", limits.contact_stride));
  }
  if (std::ranges::any_of(source.replays,
                          [](const Replay& r) { return !r.penetrations_m.empty(); })) {
    out += fmt::format(
        " Penetration: of each body the deepest overlap with any other, from the recorded poses "
        "alone, to {:g} mm.",
        500.0 * k_penetration_lattice_m);
  }
  return "<p class=\"quiet\">" + escape_markup(out + notes) + "</p>\n";
}

std::string replay_html(const ReportSource& source, const PageAssets& assets,
                        const ReplayLimits& limits) {
  if (source.replays.empty()) {
    return "<p class=\"quiet\">No trajectories were recorded, so there is nothing to replay.</p>\n";
  }
  if (assets.script.empty()) {
    return fmt::format(
        "<p class=\"quiet\">{} trajectories were recorded; the 3D view is missing: "
        "{}.</p>\n",
        source.replays.size(), escape_markup(assets.missing));
  }
  return std::string("<div class=\"replay\" data-replay></div>\n") +
         "<noscript><p>The 3D view needs JavaScript.</p></noscript>\n" +
         replay_facts(source, limits);
}

// The replays by scene: bodies once, one view per engine.
void add_scenes(const ReportSource& source, const Palette& palette, const ReplayLimits& limits,
                nlohmann::ordered_json& scenes) {
  const SceneNames names(summarize(source.rows));
  for (const Replay& replay : source.replays) {
    auto found = std::find_if(scenes.begin(), scenes.end(), [&](const auto& scene) {
      return scene["label"] == replay.scene && scene["source"] == source.name &&
             scene["bodies"] == bodies_json(replay.bodies);
    });
    if (found == scenes.end()) {
      scenes.push_back({{"name", names.brief(replay.scene)},
                        {"label", replay.scene},
                        {"source", source.name},
                        {"bodies", bodies_json(replay.bodies)},
                        {"views", nlohmann::ordered_json::array()}});
      found = scenes.end() - 1;
    }
    auto view = to_json(thinned(replay, limits.frames), limits.contact_stride);
    const auto label = std::ranges::find(palette.labels(), replay.engine);
    view["colour"] = palette_colour(static_cast<std::size_t>(label - palette.labels().begin()));
    (*found)["views"].push_back(std::move(view));
  }
}

std::string source_html(const ReportSource& source, const SourceFigures& figures,
                        const Palette& palette, const PageAssets& assets, const std::string& prefix,
                        const ReplayLimits& limits, const std::string& ensembles) {
  const std::vector<Block> blocks = summarize(source.rows);
  const SceneNames names(blocks);
  const bool svg = assets.script.empty();
  const Provenance& p = source.provenance;
  std::string out = fmt::format("<header><h1>{}</h1>\n", escape_markup(p.title));
  const auto overrides = overrides_of(p);
  if (!overrides.empty()) {
    out += fmt::format("<p><strong>Run with {}.</strong> {}</p>\n",
                       escape_markup(fmt::format("{}", fmt::join(overrides, ", "))),
                       "The title and the text below are the plan's, for its own settings.");
  }
  if (!p.analysis.empty())
    out += fmt::format("<p class=\"lead\">{}</p>\n", escape_markup(p.analysis));
  out += "</header>\n";
  const auto section = [&](const char* id, const char* title, const std::string& body) {
    out += html_section(prefix + id, title, body);
  };
  section("laws", "Who broke a law here", html_answer(source, palette));
  section("verdict", "Verdict", html_verdict(source, blocks, names, palette));
  if (!source.rows.empty()) section("replay", "Replay", replay_html(source, assets, limits));
  section("time", "Over time", figures_html(figures.time, names, svg));
  section("tables", "Scenes", html_scene_tables(blocks, names, palette));
  section("ensembles", "Ensembles", ensembles);
  section("step", "Error against the step", figures_html(figures.step, names, svg));
  section("cost", "Accuracy against cost", figures_html(figures.cost, names, svg));
  section("validation", "Validation",
          html_validation(source, palette, "figures/" + prefix + "validation.csv"));
  section("unfinished", "Cells without numbers", html_unfinished(source, names));
  section("flagged", "Cells whose numbers do not count", html_flagged(source, names));
  section("engines", "Who was run", html_contenders(source, palette));
  section("method", "Method and provenance", html_method(source));
  section("numbers", "What the numbers mean", html_glossary(source));
  return out;
}

std::string markdown_validation(const ReportSource& source) {
  if (source.validation.is_null()) return "";
  const Table audit = audit_table(source);
  return "\n## Validation\n\n" + validation_legend(source) + "\n\n" +
         to_markdown(validation_matrix(source)) +
         (audit.rows.empty() ? "" : "\n### Who was validated\n\n" + to_markdown(audit));
}

std::string navigation(const std::string& body) {
  std::string out = "<nav>";
  constexpr std::string_view mark = "<section id=\"";
  for (std::size_t at = body.find(mark); at != std::string::npos; at = body.find(mark, at)) {
    at += mark.size();
    const std::size_t end = body.find('"', at);
    const std::size_t title = body.find("<h2>", end) + 4;
    out += fmt::format("<a href=\"#{}\">{}</a>", body.substr(at, end - at),
                       body.substr(title, body.find("</h2>", title) - title));
  }
  return out + "</nav>\n";
}

std::string assets_html(const PageAssets& assets) {
  if (assets.missing.empty() && assets.script.empty()) return "";
  if (!assets.missing.empty()) {
    return fmt::format(
        "<p class=\"quiet\">This page shows static figures and no 3D view: {}.</p>\n",
        escape_markup(assets.missing));
  }
  return fmt::format(
      "<details><summary>Licences of the scripts in this page</summary><pre>{}</pre></details>\n",
      escape_markup(assets.licences));
}

SourceFigures figures_of(const ReportSource& source, const std::string& prefix, Palette& palette) {
  SourceFigures figures{figures_over_time(source, palette), figures_against_step(source, palette),
                        figures_against_cost(source, palette)};
  std::ranges::move(orders_against_step(source, palette), std::back_inserter(figures.step));
  std::ranges::move(orders_against_cost(source, palette), std::back_inserter(figures.cost));
  number_ids(figures.time, prefix);
  number_ids(figures.step, prefix);
  number_ids(figures.cost, prefix);
  return figures;
}

void learn_labels(const ReportSource& source, Palette& palette) {
  for (const Row& row : source.rows) {
    palette.index(Contender{row.engine, row.variant, split_axes(row.axes).knobs}.label());
  }
  for (const Replay& replay : source.replays) palette.index(replay.engine);
  const Table audit = audit_table(source);
  for (const auto& row : audit.rows) palette.index(row.front().text);
}

// "" for a single source: most pages have one.
std::string prefix_of(std::size_t index, std::size_t count) {
  return count == 1 ? "" : fmt::format("r{}-", index + 1);
}

}  // namespace

std::string page(const std::string& title, const std::string& body, const std::string& data_json,
                 const PageAssets& assets) {
  std::string out = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n"
      "<link rel=\"icon\" href=\"data:,\">\n<title>{}</title>\n<style>\n",
      escape_markup(title));
  out += assets.style + "</style></head>\n<body>\n" + navigation(body) + "<main>\n" + body +
         assets_html(assets) + "</main>\n";
  if (!assets.script.empty()) {
    out += "<script type=\"application/json\" id=\"data\">" + script_json(data_json) +
           "</script>\n<script type=\"module\">" + assets.script + "</script>\n";
  }
  return out + "</body></html>\n";
}

std::vector<Figure> report_figures(std::span<const ReportSource> sources,
                                   const ReportOptions& options) {
  Palette palette;
  for (const ReportSource& source : sources) learn_labels(source, palette);
  std::vector<Figure> all;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const std::string prefix = prefix_of(i, sources.size());
    const SourceFigures figures = figures_of(sources[i], prefix, palette);
    if (i < options.ensembles.size()) {
      std::ranges::move(ensemble_figures(options.ensembles[i], palette, prefix),
                        std::back_inserter(all));
    }
    for (const auto* list : {&figures.time, &figures.step, &figures.cost}) {
      all.insert(all.end(), list->begin(), list->end());
    }
  }
  return all;
}

std::vector<OutputFile> report_files(std::span<const ReportSource> sources,
                                     const PageAssets& assets, const ReportOptions& options) {
  Palette palette;
  for (const ReportSource& source : sources) learn_labels(source, palette);
  std::string body;
  std::string markdown;
  auto figures_json = nlohmann::ordered_json::array();
  auto scenes = nlohmann::ordered_json::array();
  std::vector<OutputFile> files;
  const ReplayLimits limits = replay_limits(sources, options);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const ReportSource& source = sources[i];
    const std::string prefix = prefix_of(i, sources.size());
    const SourceFigures figures = figures_of(source, prefix, palette);
    const Ensembles none;
    const Ensembles& ensembles = i < options.ensembles.size() ? options.ensembles[i] : none;
    body += source_html(source, figures, palette, assets, prefix, limits,
                        html_ensembles(ensembles, palette, prefix));
    add_scenes(source, palette, limits, scenes);
    markdown += (i == 0 ? "" : "\n") +
                markdown_report({source.rows, source.timings, &source.provenance}) +
                markdown_answer(source) + markdown_validation(source) +
                markdown_ensembles(ensembles, palette, prefix);
    std::ranges::move(ensemble_files(ensembles, palette, prefix), std::back_inserter(files));
    if (!source.validation.is_null()) {
      files.push_back({"figures/" + prefix + "validation.csv", validation_csv(source)});
    }
    for (const auto* list : {&figures.time, &figures.step, &figures.cost}) {
      for (const Figure& figure : *list) {
        figures_json.push_back(to_json(figure));
        files.push_back({"figures/" + figure.id + ".svg", to_svg(figure, true)});
        files.push_back({"figures/" + figure.id + ".csv", to_csv(figure)});
      }
    }
  }
  const nlohmann::ordered_json data = {{"figures", figures_json}, {"scenes", scenes}};
  const std::string title = sources.empty() ? "report" : sources.front().provenance.title;
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  files.insert(files.begin(),
               {{"index.html", page(title, body, data.dump(-1, ' ', false, replace), assets)},
                {"report.md", markdown}});
  return files;
}

}  // namespace brickbench
