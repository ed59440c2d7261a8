// A build without SQLite: no database is written, and the reason is given.
#include "experiments/sweep/database.hpp"

namespace brickbench {

bool has_databases() { return false; }

Expected<MergeSummary> merge_to_database(const Sweep&, const std::filesystem::path&) {
  return fail(Fault::unsupported, std::string(no_databases_reason()));
}

}  // namespace brickbench
