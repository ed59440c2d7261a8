// Files that are whole or absent: temporary name, fsync, rename; nothing is ever written over.
#pragma once

#include <filesystem>
#include <string_view>

#include "adapters/seam/failure.hpp"

namespace brickbench {

// Creates the folder and its parents; Fault::invalid if it exists already or cannot be created.
Expected<void> create_new_folder(const std::filesystem::path& folder);

// Writes `file` whole; Fault::invalid if it exists, Fault::crashed if the disk refuses (the reason
// is the system's). On failure nothing is left behind.
Expected<void> write_new_file(const std::filesystem::path& file, std::string_view content);

// The whole file as text; Fault::invalid with the system's reason if it cannot be read.
Expected<std::string> read_file(const std::filesystem::path& file);

}  // namespace brickbench
