// A sweep of fakes in a folder of its own, for tests.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <string>

#include "experiments/record/csv.hpp"
#include "experiments/record/file.hpp"
#include "experiments/sweep/inventory.hpp"
#include "experiments/sweep/merge.hpp"
#include "experiments/sweep/run_sweep.hpp"
#include "tests/support/troubled_engine.hpp"

namespace brickbench::testing {

inline const Origin k_origin = {"rev", "machine"};

// A plan of one experiment "fall".
inline std::string fall_plan(const std::string& engines, const std::string& rest = "") {
  return "title = \"t\"\n[[experiment]]\nscenario = \"fall\"\nengines = " + engines +
         "\nstep_s = 0.01\n" + rest;
}

struct SweepOfFakes {
  Catalogues catalogues = troubled_catalogues();
  Plan plan;
  std::vector<Cell> cells;
  Provenance provenance;

  explicit SweepOfFakes(const std::string& text, const std::string& revision = "rev") {
    auto parsed = parse_plan(text, "p.toml", catalogues);
    EXPECT_TRUE(parsed.has_value()) << parsed.error().text();
    plan = *parsed;
    auto expanded = expand(plan, catalogues);
    EXPECT_TRUE(expanded.has_value()) << expanded.error().text();
    cells = *expanded;
    provenance = provenance_of(plan, catalogues);
    provenance.machine.revision = revision;
  }

  Expected<Sweep> open(const std::filesystem::path& folder) const {
    return open_sweep(folder, plan, {},
                      planned_cells(cells, catalogues, provenance.machine.revision), provenance);
  }

  Expected<SweepSummary> run(const std::filesystem::path& folder, SweepOptions options = {},
                             const SweepCallbacks& callbacks = {}) const {
    const auto sweep = open(folder);
    if (!sweep) return tl::unexpected(sweep.error());
    return run_sweep(*sweep, cells, catalogues, {provenance.machine.revision, "machine"}, options,
                     callbacks);
  }
};

// A new folder that goes away with the test.
class TemporaryFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name =
        (std::filesystem::temp_directory_path() / "brickbench_sweep.XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // The merged rows of the sweep in `folder`; empty if it is not complete.
  std::string merged(const std::filesystem::path& folder) const {
    const auto sweep = read_sweep(folder);
    EXPECT_TRUE(sweep.has_value()) << sweep.error().reason;
    const auto rows = folder_ / ("rows" + std::to_string(++merges_) + ".csv");
    const auto summary = merge(*sweep, {rows, folder_ / (rows.stem().string() + ".timings.csv")});
    EXPECT_TRUE(summary.has_value()) << summary.error().reason;
    return summary && summary->missing.empty() ? *read_file(rows) : "";
  }

  std::filesystem::path folder_;

 private:
  mutable int merges_ = 0;
};

}  // namespace brickbench::testing
