#include "experiments/sweep/claims.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

namespace brickbench {
namespace {

struct flock byte_lock(std::size_t cell, short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  lock.l_start = static_cast<off_t>(cell);
  lock.l_len = 1;
  return lock;
}

}  // namespace

Expected<Claims> Claims::open(const std::filesystem::path& sweep) {
  const auto file = sweep / "claims";
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return fail(Fault::crashed, fmt::format("cannot open '{}': {}", file.string(),
                                            std::generic_category().message(errno)));
  }
  return Claims(descriptor);
}

Claims::Claims(Claims&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

Claims::~Claims() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool Claims::take(std::size_t cell) {
  struct flock lock = byte_lock(cell, F_WRLCK);
  if (::fcntl(descriptor_, F_OFD_SETLK, &lock) == 0) return true;
  return errno != EAGAIN && errno != EACCES;
}

void Claims::give_back(std::size_t cell) {
  struct flock lock = byte_lock(cell, F_UNLCK);
  (void)::fcntl(descriptor_, F_OFD_SETLK, &lock);
}

}  // namespace brickbench
