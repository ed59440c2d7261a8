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
#include <utility>

namespace brickbench {
namespace {

std::string system_reason(int error) { return std::generic_category().message(error); }

// Opens a new temporary file beside `file`; host and pid keep writers on a shared disk apart, the
// counter steps over what a killed process with the same pid has left. Descriptor, or -1 and errno.
int open_temporary(const std::filesystem::path& file, std::filesystem::path& temporary) {
  constexpr int most_leftovers = 10000;
  char host[256] = "host";
  (void)::gethostname(host, sizeof host - 1);
  for (int count = 0; count < most_leftovers; ++count) {
    temporary = fmt::format("{}.tmp.{}.{}.{}", file.string(), host, ::getpid(), count);
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

int write_all(int descriptor, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(descriptor, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

// Brings the file to the disk and closes it; 0 or errno.
int sync_and_close(int descriptor) {
  const int error = ::fsync(descriptor) == 0 ? 0 : errno;
  if (::close(descriptor) != 0 && error == 0) return errno;
  return error;
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

tl::unexpected<Failure> cannot_write(const std::filesystem::path& file, int error) {
  const Fault fault = error == EEXIST ? Fault::invalid : Fault::crashed;
  return fail(fault, fmt::format("cannot write '{}': {}", file.string(), system_reason(error)));
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

Expected<void> check_is_new(const std::filesystem::path& out) {
  namespace fs = std::filesystem;
  if (out.empty()) return {};
  std::error_code error;
  if (fs::exists(fs::symlink_status(out, error))) {
    return fail(
        Fault::invalid,
        fmt::format("'{}' exists already; nothing is written over, name a new one", out.string()));
  }
  fs::path above = fs::absolute(out, error).parent_path();
  while (above.has_relative_path() && !fs::exists(above, error)) above = above.parent_path();
  if (!fs::is_directory(above, error)) {
    return fail(Fault::invalid, fmt::format("cannot make '{}': '{}' is not a folder", out.string(),
                                            above.string()));
  }
  if (::access(above.c_str(), W_OK | X_OK) != 0) {
    return fail(Fault::invalid,
                fmt::format("cannot make '{}': {}", out.string(), system_reason(errno)));
  }
  return {};
}

NewFile::NewFile(std::filesystem::path file, std::filesystem::path temporary, int descriptor)
    : file_(std::move(file)), temporary_(std::move(temporary)), descriptor_(descriptor) {}

NewFile::NewFile(NewFile&& other) noexcept
    : file_(std::move(other.file_)),
      temporary_(std::move(other.temporary_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

NewFile::~NewFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

Expected<NewFile> NewFile::create(const std::filesystem::path& file) {
  if (std::filesystem::exists(std::filesystem::symlink_status(file))) {
    return fail(Fault::invalid, fmt::format("'{}' exists already", file.string()));
  }
  std::filesystem::path temporary;
  const int descriptor = open_temporary(file, temporary);
  if (descriptor < 0) return cannot_write(file, errno);
  return NewFile(file, std::move(temporary), descriptor);
}

Expected<void> NewFile::append(std::string_view content) {
  if (const int error = write_all(descriptor_, content); error != 0) {
    return cannot_write(file_, error);
  }
  return {};
}

Expected<void> NewFile::commit() {
  int error = sync_and_close(std::exchange(descriptor_, -1));
  if (error == 0) error = rename_new(temporary_, file_);
  if (error != 0) {
    ::unlink(temporary_.c_str());
    return cannot_write(file_, error);
  }
  sync_folder(file_.parent_path());
  return {};
}

Expected<void> write_new_file(const std::filesystem::path& file, std::string_view content) {
  auto made = NewFile::create(file);
  if (!made) return tl::unexpected(made.error());
  if (auto ok = made->append(content); !ok) return ok;
  return made->commit();
}

Expected<void> replace_file(const std::filesystem::path& file, std::string_view content) {
  std::filesystem::path temporary;
  const int descriptor = open_temporary(file, temporary);
  if (descriptor < 0) return cannot_write(file, errno);
  int error = write_all(descriptor, content);
  if (const int closed = sync_and_close(descriptor); error == 0) error = closed;
  if (error == 0 && ::rename(temporary.c_str(), file.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    return cannot_write(file, error);
  }
  sync_folder(file.parent_path());
  return {};
}

Expected<std::filesystem::path> temporary_beside(const std::filesystem::path& file) {
  if (std::filesystem::exists(std::filesystem::symlink_status(file))) {
    return fail(Fault::invalid, fmt::format("'{}' exists already", file.string()));
  }
  std::filesystem::path temporary;
  const int descriptor = open_temporary(file, temporary);
  if (descriptor < 0) return cannot_write(file, errno);
  ::close(descriptor);
  return temporary;
}

Expected<void> publish(const std::filesystem::path& temporary, const std::filesystem::path& file) {
  const int descriptor = ::open(temporary.c_str(), O_RDONLY | O_CLOEXEC);
  int error = descriptor < 0 ? errno : sync_and_close(descriptor);
  if (error == 0) error = rename_new(temporary, file);
  if (error != 0) {
    ::unlink(temporary.c_str());
    return cannot_write(file, error);
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
