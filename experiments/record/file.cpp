#include "experiments/record/file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <system_error>

namespace brickbench {
namespace {

std::string system_reason(int error) { return std::generic_category().message(error); }

// Name of a temporary file beside `file`; host and pid keep writers on a shared disk apart.
std::filesystem::path temporary_name(const std::filesystem::path& file) {
  char host[256] = "host";
  (void)::gethostname(host, sizeof host - 1);
  return fmt::format("{}.tmp.{}.{}", file.string(), host, ::getpid());
}

int write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return ::fsync(descriptor) == 0 ? 0 : errno;
}

// rename() that never replaces; 0 or errno.
int rename_new(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  // File systems without the flag: a hard link fails if the name is taken.
  if (::link(from.c_str(), to.c_str()) != 0) return errno;
  return ::unlink(from.c_str()) == 0 ? 0 : errno;
}

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return;
  (void)::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

Expected<void> create_new_folder(const std::filesystem::path& folder) {
  std::error_code error;
  const auto parent = folder.parent_path();
  if (!parent.empty()) std::filesystem::create_directories(parent, error);
  if (error) {
    return fail(Fault::invalid,
                fmt::format("cannot create folder '{}': {}", parent.string(), error.message()));
  }
  if (::mkdir(folder.c_str(), 0777) == 0) return {};
  if (errno == EEXIST) {
    return fail(Fault::invalid,
                fmt::format("'{}' exists already; nothing is written over, name a new folder",
                            folder.string()));
  }
  return fail(Fault::invalid,
              fmt::format("cannot create folder '{}': {}", folder.string(), system_reason(errno)));
}

Expected<void> write_new_file(const std::filesystem::path& file, std::string_view content) {
  if (std::filesystem::exists(std::filesystem::symlink_status(file))) {
    return fail(Fault::invalid, fmt::format("'{}' exists already", file.string()));
  }
  const auto temporary = temporary_name(file);
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    return fail(Fault::crashed,
                fmt::format("cannot write '{}': {}", file.string(), system_reason(errno)));
  }
  int error = write_all(descriptor, content);
  if (::close(descriptor) != 0 && error == 0) error = errno;
  if (error == 0) error = rename_new(temporary, file);
  if (error != 0) {
    ::unlink(temporary.c_str());
    const Fault fault = error == EEXIST ? Fault::invalid : Fault::crashed;
    return fail(fault, fmt::format("cannot write '{}': {}", file.string(), system_reason(error)));
  }
  sync_folder(file.parent_path());
  return {};
}

Expected<std::string> read_file(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error)) {
    return fail(Fault::invalid, fmt::format("'{}' is a folder", file.string()));
  }
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  if (!stream) {
    return fail(Fault::invalid, fmt::format("cannot read '{}': {}", file.string(),
                                            system_reason(errno == 0 ? EIO : errno)));
  }
  return text.str();
}

}  // namespace brickbench
