#include "experiments/record/hdf5_forgiving_file.hpp"

#if __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h>
#endif
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

namespace brickbench::hdf5 {
namespace {

struct Place {
  int* error;
};

// HDF5 sees the first member.
struct ForgivingFile {
  H5FD_t shown{};
  int descriptor = -1;
  int* error = nullptr;
  haddr_t end_of_addresses = 0;
  haddr_t end_of_file = 0;
};

ForgivingFile& of(H5FD_t* file) { return *reinterpret_cast<ForgivingFile*>(file); }
const ForgivingFile& of(const H5FD_t* file) {
  return *reinterpret_cast<const ForgivingFile*>(file);
}

H5FD_t* open_file(const char* name, unsigned, hid_t access, haddr_t) {
  const auto* place = static_cast<const Place*>(H5Pget_driver_info(access));
  const int descriptor = ::open(name, O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (place == nullptr || descriptor < 0) return nullptr;
  auto file = std::make_unique<ForgivingFile>();
  file->descriptor = descriptor;
  file->error = place->error;
  return &file.release()->shown;
}

herr_t close_file(H5FD_t* shown) {
  const std::unique_ptr<ForgivingFile> file(&of(shown));
  if (::close(file->descriptor) != 0 && *file->error == 0) *file->error = errno;
  return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
           H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t end_of_addresses(const H5FD_t* file, H5FD_mem_t) { return of(file).end_of_addresses; }
herr_t set_end_of_addresses(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  of(file).end_of_addresses = end;
  return 0;
}
haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) { return of(file).end_of_file; }

// What was never written reads as zeros.
herr_t read_bytes(H5FD_t* shown, H5FD_mem_t, hid_t, haddr_t at, std::size_t size, void* to) {
  auto* bytes = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = ::pread(of(shown).descriptor, bytes, size, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    bytes += got;
    at += static_cast<haddr_t>(got);
    size -= static_cast<std::size_t>(got);
  }
  std::memset(bytes, 0, size);
  return 0;
}

herr_t write_bytes(H5FD_t* shown, H5FD_mem_t, hid_t, haddr_t at, std::size_t size,
                   const void* from) {
  ForgivingFile& file = of(shown);
  const auto* bytes = static_cast<const char*>(from);
  file.end_of_file = std::max(file.end_of_file, at + size);
  while (size > 0 && *file.error == 0) {
    const ssize_t put = ::pwrite(file.descriptor, bytes, size, static_cast<off_t>(at));
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) {
      *file.error = errno;
      break;
    }
    bytes += put;
    at += static_cast<haddr_t>(put);
    size -= static_cast<std::size_t>(put);
  }
  return 0;
}

herr_t truncate_file(H5FD_t* shown, hid_t, hbool_t) {
  ForgivingFile& file = of(shown);
  if (*file.error == 0 &&
      ::ftruncate(file.descriptor, static_cast<off_t>(file.end_of_addresses)) != 0) {
    *file.error = errno;
  }
  file.end_of_file = file.end_of_addresses;
  return 0;
}

H5FD_class_t driver() {
  H5FD_class_t driver{};
#ifdef H5FD_CLASS_VERSION
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED + 1);
#endif
  driver.name = "forgiving";
  driver.maxaddr = static_cast<haddr_t>(1) << 62U;
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(Place);
  driver.open = open_file;
  driver.close = close_file;
  driver.query = query;
  driver.get_eoa = end_of_addresses;
  driver.set_eoa = set_end_of_addresses;
  driver.get_eof = end_of_file;
  driver.read = read_bytes;
  driver.write = write_bytes;
  driver.truncate = truncate_file;
  const H5FD_mem_t map[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(map), std::end(map), std::begin(driver.fl_map));
  return driver;
}

}  // namespace

void use_forgiving_file(hid_t access, int* error) {
  const H5FD_class_t description = driver();
  const Id id(H5FDregister(&description), H5FDunregister, "the file driver");
  const Place place{error};
  check(H5Pset_driver(access, id, &place), "the file driver");
}

}  // namespace brickbench::hdf5
