// Files that are whole or absent: temporary name, fsync, rename. Nothing is ever written over,
// except by replace_file(), which says so.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "adapters/seam/failure.hpp"

namespace brickbench {

// Creates the folder and its parents; Fault::invalid if it exists already or cannot be created.
Expected<void> create_new_folder(const std::filesystem::path& folder);

// Whether a file or folder of this name could be made, asked before the work whose result goes
// there: Fault::invalid if the name is taken, or if the folder above it is a file or cannot be
// written to. An empty name is fine: nothing was asked for.
Expected<void> check_is_new(const std::filesystem::path& out);

// Writes `file` whole; Fault::invalid if it exists, Fault::crashed if the disk refuses (the reason
// is the system's). On failure nothing is left behind.
Expected<void> write_new_file(const std::filesystem::path& file, std::string_view content);

// The same, in place of whatever file is there: a reader sees the old file or the new one.
Expected<void> replace_file(const std::filesystem::path& file, std::string_view content);

// A file too large to hold in memory, written piece by piece under a temporary name. Without
// commit() nothing is left behind.
class NewFile {
 public:
  // Fault::invalid if `file` exists, Fault::crashed if the disk refuses.
  static Expected<NewFile> create(const std::filesystem::path& file);
  NewFile(NewFile&& other) noexcept;
  NewFile& operator=(NewFile&&) = delete;
  ~NewFile();

  Expected<void> append(std::string_view content);
  // Gives the file its name, once all of it is on the disk; never replaces one.
  Expected<void> commit();

 private:
  NewFile(std::filesystem::path file, std::filesystem::path temporary, int descriptor);

  std::filesystem::path file_;
  std::filesystem::path temporary_;
  int descriptor_ = -1;
};

// For libraries that insist on a path: a new, empty file beside `file` under a temporary name.
// Faults as of NewFile::create().
Expected<std::filesystem::path> temporary_beside(const std::filesystem::path& file);

// Brings the closed file `temporary` to the disk and gives it the name `file`, never in place of
// another. On failure `temporary` is gone.
Expected<void> publish(const std::filesystem::path& temporary, const std::filesystem::path& file);

// The whole file as text; Fault::invalid with the system's reason if it cannot be read.
Expected<std::string> read_file(const std::filesystem::path& file);

}  // namespace brickbench
