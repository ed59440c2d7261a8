// Records: text and back without loss, whole files or none, and a documented schema.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "experiments/record/provenance.hpp"

namespace brickbench::testing {
namespace {

namespace fs = std::filesystem;

class Record : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("brickbench_record." + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path put(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  fs::path folder_;
};

Row nasty_row(double value) {
  Row row;
  row.experiment = "a,b";
  row.engine = "\"quoted\"";
  row.axes = " leading and trailing ";
  row.reason = "line one\nline \\n two\r\n\"three\", four";
  row.note = "\\";
  row.value = value;
  row.step_s = 1.0 / 3.0;
  row.seed = std::numeric_limits<std::uint64_t>::max();
  return row;
}

TEST_F(Record, RowsComeBackExactly) {
  std::vector<Row> rows;
  for (const double value : {0.1, -0.0, 1e-320, 1.7976931348623157e308, 2.0 / 3.0,
                             std::numeric_limits<double>::infinity()}) {
    rows.push_back(nasty_row(value));
  }
  rows.emplace_back();
  const auto back = read_csv<Row>(put("rows.csv", to_csv<Row>(rows)));
  ASSERT_TRUE(back.has_value()) << back.error().reason;
  EXPECT_EQ(*back, rows);
  EXPECT_TRUE(std::signbit(*back->at(1).value));
}

TEST_F(Record, DamagedFilesAreNamedWithTheLine) {
  const std::vector<Row> rows = {nasty_row(1.0), nasty_row(2.0)};
  const std::string good = to_csv<Row>(rows);
  const auto complaint = [&](const std::string& text) {
    const auto read = read_csv<Row>(put("bad.csv", text));
    return read ? std::string("accepted") : read.error().reason;
  };
  const std::string file = (folder_ / "bad.csv").string();
  std::string number = good;
  number.replace(number.rfind(",2,"), 3, ",two,");
  EXPECT_EQ(complaint(number), file + ":3: value: 'two' is not a number");
  EXPECT_TRUE(complaint(good.substr(0, good.size() - 12)).starts_with(file + ":3: "));
  std::string header = good;
  header.replace(header.find("engine"), 6, "engyne");
  EXPECT_NE(complaint(header), "accepted");
  EXPECT_NE(complaint(""), "accepted");
  EXPECT_NE(read_csv<Row>(folder_ / "none.csv").error().reason.find("none.csv"), std::string::npos);
}

TEST_F(Record, NothingIsWrittenOver) {
  const fs::path file = put("kept.txt", "old");
  EXPECT_FALSE(write_new_file(file, "new").has_value());
  EXPECT_EQ(*read_file(file), "old");
  EXPECT_FALSE(create_new_folder(folder_).has_value());
  EXPECT_TRUE(create_new_folder(folder_ / "a" / "b").has_value());
  EXPECT_TRUE(write_new_file(folder_ / "a" / "b" / "new.txt", "text").has_value());
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "a" / "b"), {}), 1) << "no leftovers";
  EXPECT_FALSE(create_new_folder(file / "below_a_file").has_value());
}

// A refused cell has no steps, hence no median.
TEST(Timings, OfACellWithoutStepsComeBack) {
  Timing refused;
  refused.outcome = "refused";
  refused.step_median_cpu_s = std::numeric_limits<double>::quiet_NaN();
  Timing back;
  for (const auto& column : Schema<Timing>::columns()) {
    const auto parsed = column.parse(back, column.text(refused));
    ASSERT_TRUE(parsed.has_value()) << column.name << ": " << parsed.error().reason;
  }
  EXPECT_TRUE(std::isnan(back.step_median_cpu_s));
  EXPECT_EQ(back.outcome, "refused");
}

TEST_F(Record, ProvenanceComesBack) {
  Provenance p;
  p.command = "brickbench run x";
  p.title = "t";
  p.machine = this_machine();
  p.engines = {{"e", "1", "f64", true}};
  p.metrics = {{"m", "1", "g", "lower", "meaning", "good"}};
  const auto back = provenance_from_json(to_json(p));
  ASSERT_TRUE(back.has_value()) << back.error().reason;
  EXPECT_EQ(to_json(*back), to_json(p));
  EXPECT_FALSE(provenance_from_json({{"schema", 1}}).has_value());
}

TEST(Shell, CommandsSurviveTheShell) {
  EXPECT_EQ(shell_command({"brickbench", "run", "a b", "it's", "x=[1,2]", ""}),
            "brickbench run 'a b' 'it'\\''s' 'x=[1,2]' ''");
}

template <typename Record>
std::string documented() {
  std::string text;
  for (const auto& column : Schema<Record>::columns()) {
    text += "| `" + std::string(column.name) + "` | " + std::string(column.meaning) + " |\n";
  }
  return text;
}

TEST(Documentation, StatesTheColumnsAsTheyAre) {
  const auto text = read_file("docs/format.md");
  ASSERT_TRUE(text.has_value()) << text.error().reason;
  EXPECT_NE(text->find(documented<Row>()), std::string::npos) << documented<Row>();
  EXPECT_NE(text->find(documented<Timing>()), std::string::npos) << documented<Timing>();
  EXPECT_NE(text->find(documented<SeriesPoint>()), std::string::npos) << documented<SeriesPoint>();
}

}  // namespace
}  // namespace brickbench::testing
