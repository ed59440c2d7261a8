#include "experiments/sweep/database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <array>
#include <limits>
#include <memory>
#include <utility>

#include "experiments/record/csv.hpp"
#include "experiments/record/csv_text.hpp"
#include "experiments/record/file.hpp"

namespace brickbench {
namespace fs = std::filesystem;
namespace {

struct Closer {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, Closer>;
using Statement = std::unique_ptr<sqlite3_stmt, Closer>;

tl::unexpected<Failure> refused(sqlite3* database, const char* what) {
  return fail(Fault::crashed,
              fmt::format("cannot {} the database: {}", what, sqlite3_errmsg(database)));
}

Expected<void> execute(sqlite3* database, const std::string& sql) {
  if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK) return {};
  return refused(database, "write");
}

// Numbers are doubles, but for the seed, which is a count.
template <typename Record>
std::string declaration(const Column<Record>& column) {
  const char* type = !column.is_number ? "TEXT" : column.name == "seed" ? "INTEGER" : "REAL";
  return fmt::format("\"{}\" {}", column.name, type);
}

// Counts above what SQLite holds become the nearest double.
int bind(sqlite3_stmt* statement, int at, const std::string& text, bool is_number) {
  if (is_number && text.empty()) return sqlite3_bind_null(statement, at);
  if (!is_number) {
    return sqlite3_bind_text(statement, at, text.data(), static_cast<int>(text.size()),
                             SQLITE_TRANSIENT);
  }
  constexpr auto most = static_cast<std::uint64_t>(std::numeric_limits<sqlite3_int64>::max());
  if (const auto count = parse_count(text); count && *count <= most) {
    return sqlite3_bind_int64(statement, at, static_cast<sqlite3_int64>(*count));
  }
  return sqlite3_bind_double(statement, at, *parse_number(text));
}

// A table with the columns of a record, and further columns of text.
template <typename Record, std::size_t Extra>
class Table {
 public:
  static Expected<Table> create(sqlite3* database, const char* name,
                                const std::array<const char*, Extra>& extra) {
    std::string columns;
    std::string places;
    const auto add = [&](const std::string& column) {
      columns += (columns.empty() ? "" : ", ") + column;
      places += places.empty() ? "?" : ", ?";
    };
    for (const auto& column : Schema<Record>::columns()) add(declaration(column));
    for (const char* column : extra) add(fmt::format("\"{}\" TEXT", column));
    if (auto ok = execute(database, fmt::format("CREATE TABLE {} ({})", name, columns)); !ok) {
      return tl::unexpected(ok.error());
    }
    sqlite3_stmt* statement = nullptr;
    const std::string sql = fmt::format("INSERT INTO {} VALUES ({})", name, places);
    if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
      return refused(database, "write");
    }
    return Table(database, Statement(statement));
  }

  Expected<void> insert(const Record& record, const std::array<std::string, Extra>& extra) {
    int at = 0;
    bool bound = true;
    for (const auto& column : columns_) {
      const std::string text = column.text(record);
      bound = bind(insert_.get(), ++at, text, column.is_number) == SQLITE_OK && bound;
    }
    for (const std::string& text : extra) {
      bound = bind(insert_.get(), ++at, text, false) == SQLITE_OK && bound;
    }
    const bool done = bound && sqlite3_step(insert_.get()) == SQLITE_DONE;
    if (sqlite3_reset(insert_.get()) != SQLITE_OK || !done) return refused(database_, "write");
    return {};
  }

 private:
  Table(sqlite3* database, Statement insert) : database_(database), insert_(std::move(insert)) {}

  sqlite3* database_;
  Statement insert_;
  decltype(Schema<Record>::columns()) columns_ = Schema<Record>::columns();
};

Expected<Database> open(const fs::path& file) {
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(file.c_str(), &raw, SQLITE_OPEN_READWRITE, nullptr);
  Database database(raw);
  if (code != SQLITE_OK) return refused(raw, "open");
  // Nobody else sees the file before it is whole, so there is nothing to roll back to.
  if (auto ok = execute(raw, "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; BEGIN"); !ok) {
    return tl::unexpected(ok.error());
  }
  return database;
}

// Rows are read in batches: to make a reader costs as much as many rows.
constexpr std::size_t k_batch_bytes = std::size_t{1} << 20U;

Expected<MergeSummary> fill(const Sweep& sweep, const fs::path& file) {
  auto database = open(file);
  if (!database) return tl::unexpected(database.error());
  auto rows = Table<Row, 0>::create(database->get(), "rows", {});
  if (!rows) return tl::unexpected(rows.error());
  auto cells = Table<PlannedCell, 2>::create(database->get(), "cells", {"outcome", "reason"});
  if (!cells) return tl::unexpected(cells.error());
  const std::string header = sweep.rows_header + '\n';
  std::string batch = header;
  const auto flush = [&]() -> Expected<void> {
    const auto parsed = rows_from_csv(batch, sweep.folder.string());
    if (!parsed) return tl::unexpected(parsed.error());
    for (const Row& row : *parsed) {
      if (auto ok = rows->insert(row, {}); !ok) return ok;
    }
    batch = header;
    return {};
  };
  auto summary = for_each_result(
      sweep, [&](const PlannedCell& cell, const CellFile& result) -> Expected<void> {
        if (auto ok = cells->insert(cell, {result.outcome, result.reason}); !ok) return ok;
        batch += result.rows;
        return batch.size() < k_batch_bytes ? Expected<void>{} : flush();
      });
  if (!summary || !summary->missing.empty()) return summary;
  if (auto ok = flush(); !ok) return tl::unexpected(ok.error());
  if (auto ok = execute(database->get(), "CREATE INDEX rows_of_cell ON rows (cell); COMMIT"); !ok) {
    return tl::unexpected(ok.error());
  }
  return summary;
}

}  // namespace

bool has_databases() { return true; }

Expected<MergeSummary> merge_to_database(const Sweep& sweep, const fs::path& file) {
  if (to_csv<Row>({}) != sweep.rows_header + '\n') {
    return fail(Fault::invalid, fmt::format("'{}' is of a program with other columns of rows",
                                            sweep.folder.string()));
  }
  const auto temporary = temporary_beside(file);
  if (!temporary) return tl::unexpected(temporary.error());
  auto summary = fill(sweep, *temporary);
  if (!summary || !summary->missing.empty()) {
    std::error_code error;
    fs::remove(*temporary, error);
    return summary;
  }
  if (auto ok = publish(*temporary, file); !ok) return tl::unexpected(ok.error());
  return summary;
}

}  // namespace brickbench
