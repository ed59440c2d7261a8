#include "experiments/sweep/database.hpp"

namespace brickbench {

std::string_view no_databases_reason() {
  return "this build has no SQLite, so it writes no databases: install the Debian package "
         "libsqlite3-dev and configure anew";
}

}  // namespace brickbench
