#include "experiments/sweep/merge.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
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

Expected<MergeSummary> append_cells(const Sweep& sweep, Table& rows, Table& timings) {
  MergeSummary summary;
  summary.cells = sweep.cells.size();
  for (std::size_t i = 0; i < sweep.cells.size(); ++i) {
    auto found = find_result(sweep, i);
    if (!found) summary.damage.push_back(found.error().reason);
    if (!found || !*found) {
      summary.missing.push_back(i);
      continue;
    }
    const CellFile& cell = **found;
    if (is_failure(sweep.cells[i], cell.outcome)) ++summary.failed;
    if (!summary.missing.empty()) continue;
    if (auto ok = rows.append(cell.rows); !ok) return tl::unexpected(ok.error());
    if (!rows.is_new()) continue;
    if (auto ok = timings.append(cell.timings); !ok) return tl::unexpected(ok.error());
  }
  return summary;
}

}  // namespace

Expected<MergeSummary> merge(const Sweep& sweep, const fs::path& rows, const fs::path& timings) {
  auto row_table = Table::open(rows, sweep.rows_header);
  if (!row_table) return tl::unexpected(row_table.error());
  if (row_table->is_new() && fs::exists(fs::symlink_status(timings))) {
    return fail(Fault::invalid, fmt::format("'{}' exists already", timings.string()));
  }
  auto timing_table = Table::open(timings, sweep.timings_header);
  if (!timing_table) return tl::unexpected(timing_table.error());
  auto summary = append_cells(sweep, *row_table, *timing_table);
  if (!summary || !summary->missing.empty()) return summary;
  summary->bytes = row_table->bytes();
  if (row_table->is_new()) {
    if (auto ok = timing_table->commit(); !ok) return tl::unexpected(ok.error());
  }
  if (auto ok = row_table->commit(); !ok) return tl::unexpected(ok.error());
  return summary;
}

Expected<MergeSummary> merge_to_folder(const Sweep& sweep, const fs::path& folder) {
  // Complete or not must be known before the folder is made.
  MergeSummary first;
  const auto states = take_inventory(sweep);
  first.cells = states.size();
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!states[i].damage.empty()) first.damage.push_back(states[i].damage);
    if (!states[i].is_done()) first.missing.push_back(i);
  }
  if (!first.missing.empty()) return first;
  if (auto ok = create_new_folder(folder); !ok) return tl::unexpected(ok.error());
  const std::string provenance = to_json(sweep.provenance).dump(2) + '\n';
  for (const auto& [name, content] :
       {std::pair<const char*, std::string>{"plan.toml", sweep.plan_text},
        {"provenance.json", provenance},
        {"series.csv", to_csv<SeriesPoint>({})}}) {
    if (auto ok = write_new_file(folder / name, content); !ok) return tl::unexpected(ok.error());
  }
  return merge(sweep, folder / "rows.csv", folder / "timings.csv");
}

}  // namespace brickbench
