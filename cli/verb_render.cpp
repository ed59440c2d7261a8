#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/browser.hpp"
#include "cli/complain.hpp"
#include "cli/number_option.hpp"
#include "cli/record_command.hpp"
#include "cli/replay_depths.hpp"
#include "cli/report_output.hpp"
#include "cli/terminal.hpp"
#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/provenance.hpp"
#include "reports/src/base64.hpp"

namespace brickbench {
namespace {

namespace fs = std::filesystem;

struct RenderOptions {
  std::string folder;
  std::string out;
  std::vector<std::string> views = {"three-quarter"};
  std::vector<std::string> engines;
  std::vector<std::string> scenes;
  std::string colour = "material";
  bool contacts = false;
  std::string video;
  double time_s = -1.0;  // negative: half of the recorded time
  double speed = 0.25;
  int fps = 25;
  int width_px = 1280;
  bool json = false;
};

// A folder of our own that goes with this value.
struct Workshop {
  fs::path folder;
  ~Workshop() {
    std::error_code ignored;
    if (!folder.empty()) fs::remove_all(folder, ignored);
  }
};

// The bytes of a data URL.
Expected<std::string> image_bytes(const nlohmann::json& url) {
  const std::string text = url.is_string() ? url.get<std::string>() : "";
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) return fail(Fault::crashed, "the browser made no picture");
  const auto bytes = from_base64(std::string_view(text).substr(comma + 1));
  if (!bytes) return tl::unexpected(bytes.error());
  return std::string(bytes->begin(), bytes->end());
}

class Renderer {
 public:
  Renderer(Browser& browser, const RenderOptions& options, std::string ffmpeg, fs::path folder)
      : browser_(browser),
        options_(options),
        ffmpeg_(std::move(ffmpeg)),
        folder_(std::move(folder)) {}

  // Pictures and videos of all scenes and views.
  Expected<std::vector<OutputFile>> all() {
    auto scenes = browser_.evaluate("brickbench.data.scenes.map((s) => s.name)");
    if (!scenes) return tl::unexpected(scenes.error());
    std::vector<std::size_t> wanted;
    std::set<std::string> names;
    std::string known;
    for (std::size_t scene = 0; scene < scenes->size(); ++scene) {
      const std::string name = (*scenes)[scene].get<std::string>();
      known += (known.empty() ? "" : ", ") + name;
      if (options_.scenes.empty() || std::ranges::count(options_.scenes, name) > 0) {
        wanted.push_back(scene);
      }
    }
    if (wanted.empty()) return fail(Fault::invalid, "no such scene; here are: " + known);
    Progress progress(wanted.size() * options_.views.size());
    std::vector<OutputFile> files;
    for (const std::size_t scene : wanted) {
      std::string name = file_id((*scenes)[scene].get<std::string>());
      if (!names.insert(name).second) name += fmt::format("-{}", scene + 1);
      for (const std::string& view : options_.views) {
        progress.begin(name + ' ' + view);
        if (auto ok = one(scene, name + '-' + view, view, progress, files); !ok) {
          return tl::unexpected(ok.error());
        }
        progress.end(fmt::format("{} {}: done", name, view));
      }
    }
    return files;
  }

 private:
  Expected<void> one(std::size_t scene, const std::string& name, const std::string& view,
                     Progress& progress, std::vector<OutputFile>& files) {
    const nlohmann::json arrangement = {{"view", view},
                                        {"width", options_.width_px},
                                        {"engines", options_.engines},
                                        {"colour", options_.colour},
                                        {"contacts", options_.contacts}};
    const auto end = browser_.evaluate(fmt::format(
        "brickbench.ready.then(async (r) => {{ if (!r) throw new Error('no WebGL');"
        " await r.load({}); brickbench.arrange(r, {}); return brickbench.clock.end; }})",
        scene, arrangement.dump()));
    if (!end) return tl::unexpected(end.error());
    const double end_s = end->get<double>();
    if (options_.time_s > end_s) {
      return fail(Fault::invalid, fmt::format("--time {}: the motion of {} ends at {} s",
                                              options_.time_s, name, end_s));
    }
    const double still_s = options_.time_s < 0.0 ? 0.5 * end_s : options_.time_s;
    auto still = frame(still_s, "image/png");
    if (!still) return tl::unexpected(still.error());
    files.push_back({name + ".png", std::move(*still)});
    if (options_.video.empty()) return {};
    return film(name, end_s, progress, files);
  }

  Expected<std::string> frame(double time_s, const char* type) {
    auto url = browser_.evaluate(fmt::format(
        "brickbench.ready.then((r) => brickbench.picture(r, brickbench.clock, {}, '{}'))", time_s,
        type));
    if (!url) return tl::unexpected(url.error());
    return image_bytes(*url);
  }

  Expected<void> film(const std::string& name, double end_s, Progress& progress,
                      std::vector<OutputFile>& files) {
    const fs::path target = folder_ / (name + ".mp4");
    const std::string command = shell_command(
        {ffmpeg_,      "-loglevel",  "error",    "-y",         "-f",
         "image2pipe", "-c:v",       "mjpeg",    "-framerate", std::to_string(options_.fps),
         "-i",         "-",          "-c:v",     "libx264",    "-preset",
         "veryfast",   "-crf",       "24",       "-pix_fmt",   "yuv420p",
         "-movflags",  "+faststart", "-threads", "2",          target.string()});
    FILE* pipe = ::popen(command.c_str(), "w");
    if (pipe == nullptr) return fail(Fault::crashed, "ffmpeg could not be started");
    const double step_s = options_.speed / options_.fps;
    const int frames = std::max(2, static_cast<int>(end_s / step_s) + 1);
    Expected<void> drawn;
    for (int i = 0; i < frames && drawn; ++i) {
      auto image = frame(std::min(i * step_s, end_s), "image/jpeg");
      if (!image)
        drawn = tl::unexpected(image.error());
      else if (std::fwrite(image->data(), 1, image->size(), pipe) != image->size())
        drawn = fail(Fault::crashed, "ffmpeg takes no more frames");
      progress.update(static_cast<double>(i + 1) / frames);
    }
    const int status = ::pclose(pipe);
    if (!drawn) return drawn;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
      return fail(Fault::crashed, "ffmpeg failed");
    auto bytes = read_file(target);
    if (!bytes) return tl::unexpected(bytes.error());
    files.push_back({name + ".mp4", std::move(*bytes)});
    return {};
  }

  Browser& browser_;
  const RenderOptions& options_;
  std::string ffmpeg_;
  fs::path folder_;
};

// What must be there before anything starts; the reason names the package.
Expected<std::pair<std::string, std::string>> find_tools(const RenderOptions& options) {
  const std::string chromium =
      program_on_path({"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"});
  if (chromium.empty()) {
    return fail(Fault::crashed,
                "pictures need Chromium, which is not installed (in Debian the package chromium)");
  }
  const std::string ffmpeg = program_on_path({"ffmpeg"});
  if (!options.video.empty() && ffmpeg.empty()) {
    return fail(Fault::crashed,
                "videos need ffmpeg, which is not installed (in Debian the package ffmpeg)");
  }
  if (page_assets().script.empty()) {
    return fail(Fault::crashed, "pictures need the page's script: " + page_assets().missing);
  }
  return std::pair{chromium, ffmpeg};
}

Expected<std::vector<OutputFile>> draw(const RenderOptions& options) {
  const auto tools = find_tools(options);
  if (!tools) return tl::unexpected(tools.error());
  auto sources = read_sources({options.folder});
  if (!sources) return tl::unexpected(sources.error());
  if (sources->front().replays.empty()) {
    const std::string command = record_command(sources->front().provenance);
    return fail(Fault::invalid,
                fmt::format("'{}' holds no motion to draw. Record it: {}", options.folder,
                            command.empty() ? "brickbench run PLAN --record" : command));
  }
  constexpr std::size_t frames = 600;
  if (options.colour == "penetration") add_replay_depths(*sources, frames);
  std::string pattern = (fs::temp_directory_path() / "brickbench-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) return fail(Fault::crashed, "no temporary folder");
  const Workshop workshop{pattern};
  const auto files = report_files(*sources, page_assets(), {.replay_frames = frames});
  const fs::path page_file = workshop.folder / "index.html";
  if (auto ok = write_new_file(page_file, files.front().content); !ok) {
    return tl::unexpected(ok.error());
  }
  auto browser = Browser::start(tools->first);
  if (!browser) return tl::unexpected(browser.error());
  if (auto ok = (*browser)->open(page_file.string(), options.width_px + 40, 900); !ok) {
    return tl::unexpected(ok.error());
  }
  return Renderer(**browser, options, tools->second, workshop.folder).all();
}

int render(const RenderOptions& options) {
  if (auto ok = check_is_new(options.out); !ok) return complain(ok.error());
  const auto files = draw(options);
  if (!files) return complain(files.error());
  if (auto ok = write_folder(options.out, *files); !ok) return complain(ok.error());
  auto json = nlohmann::ordered_json::array();
  for (const OutputFile& file : *files) {
    json.push_back({{"id", file.name}, {"bytes", file.content.size()}});
    if (!options.json)
      fmt::print("{}/{} ({} kB)\n", options.out, file.name, file.content.size() / 1000);
  }
  if (options.json) fmt::print("{}\n", json.dump(2));
  return k_exit_fine;
}

}  // namespace

void add_render_verb(CLI::App& app, Invocation& invocation) {
  CLI::App* verb =
      app.add_subcommand("render", "Draw pictures and videos of a results folder's trajectories");
  auto options = std::make_shared<RenderOptions>();
  verb->add_option("folder", options->folder, "Results folder with trajectories")->required();
  verb->add_option("--out", options->out, "New folder for the pictures")->required();
  verb->add_option("--view", options->views, "front, side, top, three-quarter; comma-separated")
      ->delimiter(',')
      ->check(CLI::IsMember({"front", "side", "top", "three-quarter"}));
  verb->add_option("--engine", options->engines, "engine/variant to show; default all")
      ->expected(1)
      ->take_all();
  verb->add_option("--scene", options->scenes, "Scene to show, as the page names it; default all")
      ->expected(1)
      ->take_all();
  verb->add_option("--colour", options->colour,
                   "Of the bricks: material, displacement, speed, penetration")
      ->check(CLI::IsMember({"material", "displacement", "speed", "penetration"}));
  verb->add_flag("--contacts", options->contacts, "Draw the recorded contact points");
  verb->add_option("--video", options->video, "Also a video of each view")
      ->check(CLI::IsMember({"mp4"}));
  add_number(*verb, "--time", options->time_s, "Time of the still, s; default half the run",
             Sign::not_negative);
  add_number(*verb, "--speed", options->speed, "Of the video: simulated s per s", Sign::positive);
  verb->add_option("--fps", options->fps, "Frames per second of the video")
      ->check(CLI::Range(1, 120));
  verb->add_option("--width", options->width_px, "Of the picture, pixels")
      ->check(CLI::Range(160, 4000));
  verb->add_flag("--json", options->json, "The list of files as JSON on standard output");
  verb->callback([options, &invocation] { invocation.exit_code = render(*options); });
}

}  // namespace brickbench
