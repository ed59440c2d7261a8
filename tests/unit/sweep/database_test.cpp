// The database of a sweep, read back through SQLite itself.
#include "experiments/sweep/database.hpp"

#include <sqlite3.h>

#include <fstream>

#include "tests/support/sweep_folder.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

// Cells of awkward text and seeds, of success, divergence, refusal and exclusion.
const std::string k_plan = fall_plan(
    R"(["good", "nan", "refuser", "good/fancy"])",
    "parameters = { balls = [1, 2, 3], mass_kg = [1.0, 2.5] }\n"
    "seeds = 2\nperturb = { position_m = 0.1 }\n"
    "except = [{ engine = \"good/fancy\", when = \"balls > 2\", why = \"not, 'today'\" }]\n");

class SweepDatabase : public TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    ASSERT_TRUE(has_databases());
  }
  void TearDown() override {
    sqlite3_close(database_);
    TemporaryFolder::TearDown();
  }

  // The answer as lines of fields, NULL as "(null)"; numbers as SQLite holds them, shortest.
  std::vector<std::vector<std::string>> ask(const fs::path& file, const std::string& sql) {
    if (database_ == nullptr) {
      EXPECT_EQ(sqlite3_open_v2(file.c_str(), &database_, SQLITE_OPEN_READONLY, nullptr),
                SQLITE_OK);
    }
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_prepare_v2(database_, sql.c_str(), -1, &statement, nullptr), SQLITE_OK)
        << sqlite3_errmsg(database_);
    std::vector<std::vector<std::string>> lines;
    while (sqlite3_step(statement) == SQLITE_ROW) {
      std::vector<std::string> fields;
      for (int i = 0; i < sqlite3_column_count(statement); ++i) {
        const int type = sqlite3_column_type(statement, i);
        if (type == SQLITE_NULL) {
          fields.emplace_back("(null)");
        } else if (type == SQLITE_FLOAT) {
          fields.push_back(shortest(sqlite3_column_double(statement, i)));
        } else {
          fields.emplace_back(reinterpret_cast<const char*>(sqlite3_column_text(statement, i)));
        }
      }
      lines.push_back(std::move(fields));
    }
    sqlite3_finalize(statement);
    return lines;
  }

 private:
  sqlite3* database_ = nullptr;
};

TEST_F(SweepDatabase, HoldsTheSameRowsAsTheTable) {
  const SweepOfFakes fakes(k_plan);
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const auto sweep = read_sweep(folder_ / "s");
  const auto summary = merge_to_database(*sweep, folder_ / "s.db");
  ASSERT_TRUE(summary.has_value()) << summary.error().reason;
  EXPECT_EQ(summary->cells, fakes.cells.size());

  ASSERT_TRUE(write_new_file(folder_ / "all.csv", merged(folder_ / "s")).has_value());
  const auto rows = read_csv<Row>(folder_ / "all.csv");
  const auto stored = ask(folder_ / "s.db", "SELECT * FROM rows ORDER BY rowid");
  ASSERT_EQ(stored.size(), rows->size());
  const auto columns = Schema<Row>::columns();
  std::string worst;
  for (std::size_t line = 0; line < stored.size() && worst.empty(); ++line) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      std::string expected = columns[i].text((*rows)[line]);
      if (columns[i].is_number && expected.empty()) expected = "(null)";
      if (stored[line][i] != expected) {
        worst = std::string(columns[i].name) + " is " + stored[line][i] + ", not " + expected;
      }
    }
  }
  EXPECT_EQ(worst, "");
}

TEST_F(SweepDatabase, NumbersCountAndCellsTellTheirOutcomes) {
  const SweepOfFakes fakes(k_plan);
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const auto sweep = read_sweep(folder_ / "s");
  ASSERT_TRUE(merge_to_database(*sweep, folder_ / "s.db").has_value());
  using Lines = std::vector<std::vector<std::string>>;
  EXPECT_EQ(ask(folder_ / "s.db", "SELECT outcome, count(*) FROM cells GROUP BY 1 ORDER BY 1"),
            (Lines{{"diverged", "12"}, {"excluded", "4"}, {"ok", "20"}, {"refused", "12"}}));
  EXPECT_EQ(ask(folder_ / "s.db", "SELECT DISTINCT reason FROM cells WHERE outcome = 'excluded'"),
            (Lines{{"not, 'today'"}}));
  EXPECT_EQ(ask(folder_ / "s.db",
                "SELECT typeof(value), count(*) FROM rows WHERE metric = 'height_m' GROUP BY 1"),
            (Lines{{"null", "28"}, {"real", "20"}}));
  EXPECT_EQ(ask(folder_ / "s.db",
                "SELECT count(*) FROM rows JOIN cells USING (cell) "
                "WHERE rows.seed = cells.seed"),
            ask(folder_ / "s.db", "SELECT count(*) FROM rows"));
}

TEST_F(SweepDatabase, IsWrittenWholeOrNotAtAll) {
  const SweepOfFakes fakes(k_plan);
  ASSERT_TRUE(fakes.run(folder_ / "s").has_value());
  const auto sweep = read_sweep(folder_ / "s");
  const auto file = result_path(folder_ / "s", sweep->cells[5].cell);
  const auto whole = read_file(file);
  fs::resize_file(file, 10);
  const auto incomplete = merge_to_database(*sweep, folder_ / "s.db");
  ASSERT_TRUE(incomplete.has_value()) << incomplete.error().reason;
  EXPECT_EQ(incomplete->missing, std::vector<std::size_t>{5});
  for (const auto& entry : fs::directory_iterator(folder_)) {
    EXPECT_EQ(entry.path().filename(), "s") << "left behind";
  }
  ASSERT_TRUE(replace_file(file, *whole).has_value());
  ASSERT_TRUE(merge_to_database(*sweep, folder_ / "s.db").has_value());
  const auto again = merge_to_database(*sweep, folder_ / "s.db");
  ASSERT_FALSE(again.has_value());
  EXPECT_EQ(again.error().fault, Fault::invalid) << again.error().reason;
}

}  // namespace
}  // namespace brickbench::testing
