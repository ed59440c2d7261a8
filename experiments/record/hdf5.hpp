// Small owners and helpers around the C interface of HDF5. Inside they throw Hdf5Error; the public
// functions of trajectory.hpp turn it into a value.
#pragma once

#include <hdf5.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace brickbench::hdf5 {

struct Hdf5Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Keeps HDF5 from printing its errors while it lives; they arrive as Hdf5Error instead.
class Silence {
 public:
  Silence() {
    // After damaged files HDF5 1.10 finds no end to its own clean-up when the process ends; we
    // close everything ourselves.
    static const herr_t no_clean_up = H5dont_atexit();
    (void)no_clean_up;
    H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  ~Silence() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

// Throws with the innermost reason that HDF5 knows, after `what`.
[[noreturn]] void raise(const std::string& what);

inline void check(herr_t status, const std::string& what) {
  if (status < 0) raise(what);
}

// An identifier of HDF5 and the function that closes it.
class Id {
 public:
  Id() = default;
  Id(hid_t id, herr_t (*close)(hid_t), const std::string& what) : id_(id), close_(close) {
    if (id < 0) raise(what);
  }
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id& operator=(Id&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Id() { close(); }

  operator hid_t() const { return id_; }
  // Negative if HDF5 could not write what was left.
  herr_t close() {
    const hid_t id = std::exchange(id_, -1);
    return id < 0 ? 0 : close_(id);
  }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

// Attributes: one text or one number each.
void write_attribute(hid_t object, const char* name, const std::string& text);
void write_attribute(hid_t object, const char* name, double number);
void write_attribute(hid_t object, const char* name, std::uint64_t number);
std::string read_text(hid_t object, const char* name);
double read_number(hid_t object, const char* name);
std::uint64_t read_count(hid_t object, const char* name);

// How data sets are stored: chunks of these sizes, shuffled, gzip level 1, with checksums.
Id table_properties(int rank, const hsize_t* chunk);

// A data set (rows, width), or (rows) for width 0, that grows by rows, stored in chunks of so many
// rows.
Id create_table(hid_t parent, const char* name, hid_t file_type, std::size_t width,
                std::size_t chunk_rows);
// Appends rows (rows, width) in memory type `type`; `start` rows are there already.
void append_rows(hid_t table, hid_t type, std::uint64_t start, std::uint64_t rows,
                 const void* values);
// Reads the rows start .. start + rows.
void read_rows(hid_t table, hid_t type, std::uint64_t start, std::uint64_t rows, void* values);
Id open_table(hid_t parent, const char* name);
// The sizes of a data set.
std::vector<hsize_t> shape_of(hid_t table);

// Texts of one fixed length each, padded with zeros.
void write_texts(hid_t parent, const char* name, const std::vector<std::string>& texts);
std::vector<std::string> read_texts(hid_t parent, const char* name);

}  // namespace brickbench::hdf5
