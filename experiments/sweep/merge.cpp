#include "experiments/sweep/merge.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/trajectory.hpp"
#include "experiments/sweep/inventory.hpp"

namespace brickbench {
namespace fs = std::filesystem;
namespace {

// A new file; or, if it exists, a comparison with what is in it.
class Table {
 public:
  static Expected<Table> open(const fs::path& file, const std::string& header) {
    Table table(file);
    if (!fs::exists(fs::symlink_status(file))) {
      auto made = NewFile::create(file);
      if (!made) return tl::unexpected(made.error());
      table.new_.emplace(std::move(*made));
    } else {
      table.old_.open(file, std::ios::binary);
    }
    if (auto ok = table.append(header + '\n'); !ok) return tl::unexpected(ok.error());
    return table;
  }

  Expected<void> append(std::string_view text) {
    bytes_ += text.size();
    buffer_ += text;
    constexpr std::size_t enough = std::size_t{1} << 20U;
    return buffer_.size() < enough ? Expected<void>{} : flush();
  }

  Expected<void> commit() {
    if (auto ok = flush(); !ok) return ok;
    if (new_) return new_->commit();
    if (old_.get() != std::char_traits<char>::eof()) return differs();
    return {};
  }

  bool is_new() const { return new_.has_value(); }
  std::uint64_t bytes() const { return bytes_; }

 private:
  explicit Table(fs::path file) : file_(std::move(file)) {}

  Expected<void> flush() {
    Expected<void> ok;
    if (new_) {
      ok = new_->append(buffer_);
    } else {
      std::string there(buffer_.size(), '\0');
      old_.read(there.data(), static_cast<std::streamsize>(there.size()));
      if (!old_ || there != buffer_) ok = differs();
    }
    buffer_.clear();
    return ok;
  }

  Expected<void> differs() const {
    return fail(
        Fault::invalid,
        fmt::format("'{}' exists with other content; nothing is written over", file_.string()));
  }

  fs::path file_;
  std::optional<NewFile> new_;
  std::ifstream old_;
  std::string buffer_;
  std::uint64_t bytes_ = 0;
};

struct Tables {
  Table rows;
  Table timings;
  std::optional<Table> series;

  static Expected<Tables> open(const Sweep& sweep, const MergeFiles& files) {
    auto rows = Table::open(files.rows, sweep.rows_header);
    if (!rows) return tl::unexpected(rows.error());
    if (rows->is_new() && fs::exists(fs::symlink_status(files.timings))) {
      return fail(Fault::invalid, fmt::format("'{}' exists already", files.timings.string()));
    }
    auto timings = Table::open(files.timings, sweep.timings_header);
    if (!timings) return tl::unexpected(timings.error());
    Tables tables{std::move(*rows), std::move(*timings), std::nullopt};
    if (files.series.empty()) return tables;
    auto series = Table::open(files.series, sweep.series_header);
    if (!series) return tl::unexpected(series.error());
    tables.series.emplace(std::move(*series));
    return tables;
  }

  Expected<void> append(const CellFile& cell) {
    if (auto ok = rows.append(cell.rows); !ok) return ok;
    if (series) {
      if (auto ok = series->append(cell.series); !ok) return ok;
    }
    return rows.is_new() ? timings.append(cell.timings) : Expected<void>{};
  }

  // Rows last: where they are, everything is.
  Expected<void> commit() {
    if (rows.is_new()) {
      if (auto ok = timings.commit(); !ok) return ok;
    }
    if (series) {
      if (auto ok = series->commit(); !ok) return ok;
    }
    return rows.commit();
  }
};

// The trajectories of the sweep's cells, each known to be one and of its cell.
Expected<std::vector<fs::path>> checked_trajectories(const Sweep& sweep) {
  std::vector<fs::path> files;
  std::error_code error;
  if (!fs::is_directory(sweep.folder / "trajectories", error)) return files;
  for (const PlannedCell& cell : sweep.cells) {
    const fs::path file = trajectory_path(sweep.folder, cell.cell);
    if (!fs::exists(file, error)) continue;
    files.push_back(file);
    if (!has_trajectories()) continue;
    const auto trajectory = Trajectory::open(file);
    if (trajectory && trajectory->header().cell == cell.cell) continue;
    return fail(Fault::invalid,
                fmt::format("{}; remove '{}' and give the command of the sweep again, and the cell "
                            "is recorded anew",
                            trajectory ? fmt::format("'{}' is the trajectory of another cell, {}",
                                                     file.string(), trajectory->header().cell)
                                       : trajectory.error().reason,
                            result_path(sweep.folder, cell.cell).string()));
  }
  return files;
}

Expected<void> link_files(const std::vector<fs::path>& files, const fs::path& folder) {
  std::error_code error;
  if (!files.empty()) fs::create_directories(folder, error);
  for (const fs::path& file : files) {
    if (error) break;
    fs::create_hard_link(file, folder / file.filename(), error);
    if (error) fs::copy_file(file, folder / file.filename(), error);
  }
  if (!error) return {};
  return fail(Fault::crashed, fmt::format("cannot bring the trajectories to '{}': {}",
                                          folder.string(), error.message()));
}

}  // namespace

Expected<MergeSummary> for_each_result(const Sweep& sweep, const ResultVisitor& visit) {
  MergeSummary summary;
  summary.cells = sweep.cells.size();
  for (std::size_t i = 0; i < sweep.cells.size(); ++i) {
    auto found = find_result(sweep, i);
    if (!found) summary.damage.push_back(found.error().reason);
    if (!found || !*found) {
      summary.missing.push_back(i);
      continue;
    }
    if (is_failure(sweep.cells[i], (*found)->outcome)) ++summary.failed;
    if (!summary.missing.empty()) continue;
    if (auto ok = visit(sweep.cells[i], **found); !ok) return tl::unexpected(ok.error());
  }
  return summary;
}

Expected<MergeSummary> merge(const Sweep& sweep, const MergeFiles& files) {
  auto tables = Tables::open(sweep, files);
  if (!tables) return tl::unexpected(tables.error());
  auto summary = for_each_result(
      sweep, [&](const PlannedCell&, const CellFile& result) { return tables->append(result); });
  if (!summary || !summary->missing.empty()) return summary;
  summary->bytes = tables->rows.bytes();
  if (auto ok = tables->commit(); !ok) return tl::unexpected(ok.error());
  return summary;
}

Expected<MergeSummary> merge_to_folder(const Sweep& sweep, const fs::path& folder) {
  // Complete or not must be known before the folder is made.
  auto first =
      for_each_result(sweep, [](const PlannedCell&, const CellFile&) { return Expected<void>{}; });
  if (!first || !first->missing.empty()) return first;
  const auto trajectories = checked_trajectories(sweep);
  if (!trajectories) return tl::unexpected(trajectories.error());
  if (auto ok = create_new_folder(folder); !ok) return tl::unexpected(ok.error());
  const std::string provenance = to_json(sweep.provenance).dump(2) + '\n';
  for (const auto& [name, content] :
       {std::pair<const char*, std::string>{"plan.toml", sweep.plan_text},
        {"provenance.json", provenance}}) {
    if (auto ok = write_new_file(folder / name, content); !ok) return tl::unexpected(ok.error());
  }
  if (auto ok = link_files(*trajectories, folder / "trajectories"); !ok) {
    return tl::unexpected(ok.error());
  }
  auto summary = merge(sweep, {folder / "rows.csv", folder / "timings.csv", folder / "series.csv"});
  if (summary) summary->recorded = trajectories->size();
  return summary;
}

}  // namespace brickbench
