// Claims: which cells are being run right now, by whichever process on whichever machine.
#pragma once

#include <cstddef>
#include <filesystem>

#include "adapters/seam/failure.hpp"

namespace brickbench {

// A claim is a lock on one byte of the file `claims` of the sweep. The system gives it back when
// the process that holds it ends, however it ends, so there are no stale claims.
class Claims {
 public:
  // Fault::crashed if the file cannot be opened.
  static Expected<Claims> open(const std::filesystem::path& sweep);
  Claims(Claims&& other) noexcept;
  Claims& operator=(Claims&&) = delete;
  ~Claims();

  // Whether cell number `cell` of the plan is now ours; false while another process has it.
  // Where the file system has no locks everything can be had: a cell may then be run twice, with
  // the same result.
  bool take(std::size_t cell);
  void give_back(std::size_t cell);

 private:
  explicit Claims(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace brickbench
