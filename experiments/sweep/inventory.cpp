#include "experiments/sweep/inventory.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "experiments/run/run_plan.hpp"

namespace brickbench {
namespace {

// The whole file, quicker than by streams; errno says why there is none.
std::optional<std::string> content_of(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return std::nullopt;
  struct stat facts {};
  std::string text;
  if (::fstat(descriptor, &facts) == 0) text.resize(static_cast<std::size_t>(facts.st_size));
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::read(descriptor, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  ::close(descriptor);
  text.resize(done);
  return text;
}

}  // namespace

Expected<std::optional<CellFile>> find_result(const Sweep& sweep, std::size_t cell) {
  const std::string& id = sweep.cells[cell].cell;
  const auto file = result_path(sweep.folder, id);
  const auto text = content_of(file);
  if (!text) {
    if (errno == ENOENT) return std::nullopt;
    return fail(Fault::invalid,
                fmt::format("'{}': {}", file.string(), std::generic_category().message(errno)));
  }
  auto parsed = parse_cell_file(*text, id);
  if (!parsed) {
    return fail(Fault::invalid, fmt::format("'{}': {}", file.string(), parsed.error().reason));
  }
  return std::optional<CellFile>(std::move(*parsed));
}

std::vector<CellState> take_inventory(const Sweep& sweep, const Shard& shard) {
  std::vector<CellState> states(sweep.cells.size());
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!shard.holds(i)) continue;
    auto found = find_result(sweep, i);
    if (!found)
      states[i].damage = found.error().reason;
    else if (*found)
      states[i].outcome = (*found)->outcome;
  }
  return states;
}

bool is_failure(const PlannedCell& cell, const std::string& outcome) {
  CellOutcome done;
  done.cell.expected_outcome = cell.expected;
  done.outcome = outcome;
  return is_failure(done);
}

std::string label(const PlannedCell& cell) {
  return fmt::format("{} {}/{} step {} s{}{}", cell.experiment, cell.engine, cell.variant,
                     cell.step_s, cell.seed == 0 ? "" : fmt::format(" seed {}", cell.seed),
                     cell.axes.empty() ? "" : " " + cell.axes);
}

}  // namespace brickbench
