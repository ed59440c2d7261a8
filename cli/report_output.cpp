#include "cli/report_output.hpp"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "cli/verbs.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/provenance.hpp"

namespace brickbench {
namespace {

namespace fs = std::filesystem;

// A folder of our own beside `out`, removed at the end unless it was renamed.
class Scratch {
 public:
  explicit Scratch(const std::string& out)
      : folder_(fmt::format("{}.tmp.{}", fs::path(out).lexically_normal().string(), ::getpid())) {}
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& folder() const { return folder_; }

 private:
  fs::path folder_;
};

Expected<void> fill(const fs::path& folder, const std::vector<OutputFile>& files) {
  if (auto made = create_new_folder(folder); !made) return made;
  for (const OutputFile& file : files) {
    std::error_code error;
    fs::create_directories((folder / file.name).parent_path(), error);
    if (error) return fail(Fault::crashed, error.message());
    if (auto ok = write_new_file(folder / file.name, file.content); !ok) return ok;
  }
  return {};
}

Expected<void> settle(const fs::path& from, const std::string& out) {
  if (fs::exists(fs::symlink_status(out))) {
    return fail(Fault::invalid, fmt::format("'{}' exists already; nothing is written over, name a "
                                            "new folder",
                                            out));
  }
  std::error_code error;
  fs::rename(from, out, error);
  if (error) {
    return fail(Fault::crashed, fmt::format("cannot make '{}': {}", out, error.message()));
  }
  return {};
}

// Draws all figures in one gnuplot; false if it failed.
bool draw_pdfs(const std::string& gnuplot, const fs::path& figures,
               const std::vector<Figure>& list) {
  std::string script;
  for (const Figure& figure : list) {
    script +=
        "reset\n" + to_gnuplot(figure, figure.id + ".csv", figure.id + ".pdf") + "unset output\n";
  }
  if (!write_new_file(figures / "all.gp", script)) return false;
  const std::string command =
      fmt::format("cd {} && {} all.gp >/dev/null 2>&1", shell_command({figures.string()}),
                  shell_command({gnuplot}));
  const int status = std::system(command.c_str());
  std::error_code ignored;
  fs::remove(figures / "all.gp", ignored);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

Expected<std::vector<ReportSource>> read_sources(const std::vector<std::string>& folders) {
  std::vector<ReportSource> sources;
  for (const std::string& folder : folders) {
    auto source = read_report_source(folder);
    if (!source) return tl::unexpected(source.error());
    sources.push_back(std::move(*source));
  }
  return sources;
}

Expected<void> write_folder(const std::string& out, const std::vector<OutputFile>& files) {
  const auto written = write_report(out, files, {}, false);
  if (!written) return tl::unexpected(written.error());
  return {};
}

Expected<WrittenReport> write_report(const std::string& out, std::vector<OutputFile> files,
                                     const std::vector<Figure>& figures, bool want_pdf) {
  if (fs::exists(fs::symlink_status(out))) return tl::unexpected(settle({}, out).error());
  const Scratch scratch(out);
  if (auto ok = fill(scratch.folder(), files); !ok) return tl::unexpected(ok.error());
  WrittenReport written;
  const std::string gnuplot = program_on_path({"gnuplot"});
  if (want_pdf && !figures.empty() && gnuplot.empty()) {
    written.no_pdf_reason = "gnuplot is not installed (in Debian the package gnuplot-nox)";
  } else if (want_pdf && !figures.empty()) {
    const fs::path folder = scratch.folder() / "figures";
    if (!draw_pdfs(gnuplot, folder, figures)) written.no_pdf_reason = "gnuplot failed";
    for (const Figure& figure : figures) {
      undate_pdf(folder / (figure.id + ".pdf"));
      written.pdfs += fs::exists(folder / (figure.id + ".pdf")) ? 1U : 0U;
    }
  }
  if (auto ok = settle(scratch.folder(), out); !ok) return tl::unexpected(ok.error());
  return written;
}

void undate_pdf(const fs::path& pdf) {
  auto text = read_file(pdf);
  if (!text) return;
  constexpr std::string_view mark = "/CreationDate (D:";
  constexpr std::string_view date = "19700101000000";
  const std::size_t at = text->find(mark);
  if (at == std::string::npos || at + mark.size() + date.size() > text->size()) return;
  text->replace(at + mark.size(), date.size(), date);
  std::error_code ignored;
  fs::remove(pdf, ignored);
  (void)write_new_file(pdf, *text);
}

std::string program_on_path(const std::vector<std::string>& names) {
  const char* path = std::getenv("PATH");
  if (path == nullptr) return "";
  const std::string folders = path;
  for (const std::string& name : names) {
    for (std::size_t at = 0; at <= folders.size();) {
      const std::size_t end = std::min(folders.find(':', at), folders.size());
      const fs::path file = fs::path(folders.substr(at, end - at)) / name;
      if (::access(file.c_str(), X_OK) == 0) return file.string();
      at = end + 1;
    }
  }
  return "";
}

}  // namespace brickbench
