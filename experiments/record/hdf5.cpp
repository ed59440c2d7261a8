#include "experiments/record/hdf5.hpp"

#include <algorithm>

namespace brickbench::hdf5 {
namespace {

// The last visited entry of the upward walk's first call is the innermost one.
herr_t first_reason(unsigned number, const H5E_error2_t* error, void* text) {
  if (number == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

Id scalar() { return {H5Screate(H5S_SCALAR), H5Sclose, "a dataspace"}; }

Id text_type(std::size_t bytes) {
  Id type(H5Tcopy(H5T_C_S1), H5Tclose, "a text type");
  check(H5Tset_size(type, std::max<std::size_t>(bytes, 1)), "the size of a text");
  check(H5Tset_strpad(type, H5T_STR_NULLPAD), "the padding of a text");
  check(H5Tset_cset(type, H5T_CSET_UTF8), "the encoding of a text");
  return type;
}

void write_attribute(hid_t object, const char* name, hid_t file_type, hid_t type,
                     const void* value) {
  const Id space = scalar();
  const Id attribute(H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                     std::string("attribute ") + name);
  check(H5Awrite(attribute, type, value), std::string("attribute ") + name);
}

Id open_attribute(hid_t object, const char* name, H5T_class_t wanted) {
  const std::string what = std::string("attribute '") + name + "'";
  Id attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose, what);
  const Id type(H5Aget_type(attribute), H5Tclose, what);
  const Id space(H5Aget_space(attribute), H5Sclose, what);
  if (H5Tget_class(type) != wanted || H5Sget_simple_extent_npoints(space) != 1) {
    throw Hdf5Error(what + " has the wrong type");
  }
  return attribute;
}

// A rectangle of whole rows in the table's file space.
Id rows_of(hid_t table, std::uint64_t start, std::uint64_t rows, Id& memory) {
  std::vector<hsize_t> count = shape_of(table);
  std::vector<hsize_t> offset(count.size(), 0);
  if (count.empty() || start + rows > count[0]) throw Hdf5Error("rows beyond the end of a table");
  offset[0] = start;
  count[0] = rows;
  Id space(H5Dget_space(table), H5Sclose, "the space of a table");
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, offset.data(), nullptr, count.data(), nullptr),
        "rows of a table");
  memory = Id(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr), H5Sclose,
              "the space of rows");
  return space;
}

}  // namespace

void raise(const std::string& what) {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, first_reason, &reason);
  H5Eclear2(H5E_DEFAULT);
  throw Hdf5Error(reason.empty() ? what : what + ": " + reason);
}

void write_attribute(hid_t object, const char* name, const std::string& text) {
  const Id type = text_type(text.size());
  const std::string padded = text.empty() ? std::string(1, '\0') : text;
  write_attribute(object, name, type, type, padded.data());
}

void write_attribute(hid_t object, const char* name, double number) {
  write_attribute(object, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &number);
}

void write_attribute(hid_t object, const char* name, std::uint64_t number) {
  write_attribute(object, name, H5T_STD_U64LE, H5T_NATIVE_UINT64, &number);
}

std::string read_text(hid_t object, const char* name) {
  const Id attribute = open_attribute(object, name, H5T_STRING);
  const Id type(H5Aget_type(attribute), H5Tclose, name);
  if (H5Tis_variable_str(type) != 0) {
    throw Hdf5Error(std::string("attribute '") + name + "' has the wrong type");
  }
  std::string text(H5Tget_size(type), '\0');
  check(H5Aread(attribute, type, text.data()), std::string("attribute ") + name);
  text.resize(std::min(text.find('\0'), text.size()));
  return text;
}

double read_number(hid_t object, const char* name) {
  const Id attribute = open_attribute(object, name, H5T_FLOAT);
  double number = 0.0;
  check(H5Aread(attribute, H5T_NATIVE_DOUBLE, &number), std::string("attribute ") + name);
  return number;
}

std::uint64_t read_count(hid_t object, const char* name) {
  const Id attribute = open_attribute(object, name, H5T_INTEGER);
  std::uint64_t number = 0;
  check(H5Aread(attribute, H5T_NATIVE_UINT64, &number), std::string("attribute ") + name);
  return number;
}

Id table_properties(int rank, const hsize_t* chunk) {
  Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "the storage of a table");
  check(H5Pset_obj_track_times(list, false), "the storage of a table");
  check(H5Pset_chunk(list, rank, chunk), "the chunks of a table");
  check(H5Pset_shuffle(list), "the shuffling of a table");
  check(H5Pset_deflate(list, 1), "the compression of a table");
  check(H5Pset_fletcher32(list), "the checksums of a table");
  return list;
}

Id create_table(hid_t parent, const char* name, hid_t file_type, std::size_t width,
                std::size_t chunk_rows) {
  const int rank = width == 0 ? 1 : 2;
  const std::array<hsize_t, 2> none = {0, width};
  const std::array<hsize_t, 2> most = {H5S_UNLIMITED, width};
  const std::array<hsize_t, 2> chunk = {chunk_rows, width};
  const std::string what = std::string("data set ") + name;
  const Id space(H5Screate_simple(rank, none.data(), most.data()), H5Sclose, what);
  const Id list = table_properties(rank, chunk.data());
  return {H5Dcreate2(parent, name, file_type, space, H5P_DEFAULT, list, H5P_DEFAULT), H5Dclose,
          what};
}

void append_rows(hid_t table, hid_t type, std::uint64_t start, std::uint64_t rows,
                 const void* values) {
  if (rows == 0) return;
  std::vector<hsize_t> size = shape_of(table);
  size[0] = start + rows;
  check(H5Dset_extent(table, size.data()), "a table does not grow");
  Id memory;
  const Id space = rows_of(table, start, rows, memory);
  check(H5Dwrite(table, type, memory, space, H5P_DEFAULT, values), "rows are not written");
}

void read_rows(hid_t table, hid_t type, std::uint64_t start, std::uint64_t rows, void* values) {
  if (rows == 0) return;
  Id memory;
  const Id space = rows_of(table, start, rows, memory);
  check(H5Dread(table, type, memory, space, H5P_DEFAULT, values), "damaged data");
}

Id open_table(hid_t parent, const char* name) {
  return {H5Dopen2(parent, name, H5P_DEFAULT), H5Dclose,
          std::string("no readable data set '") + name + "'"};
}

std::vector<hsize_t> shape_of(hid_t table) {
  const Id space(H5Dget_space(table), H5Sclose, "the space of a table");
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0) raise("the sizes of a table");
  std::vector<hsize_t> sizes(static_cast<std::size_t>(rank));
  if (rank > 0) check(H5Sget_simple_extent_dims(space, sizes.data(), nullptr), "sizes of a table");
  return sizes;
}

void write_texts(hid_t parent, const char* name, const std::vector<std::string>& texts) {
  std::size_t longest = 1;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  const Id type = text_type(longest);
  std::string packed;
  for (const std::string& text : texts) {
    packed += text;
    packed.append(longest - text.size(), '\0');
  }
  const Id table =
      create_table(parent, name, type, 0, std::clamp<std::size_t>(texts.size(), 1, 1024));
  append_rows(table, type, 0, texts.size(), packed.data());
}

std::vector<std::string> read_texts(hid_t parent, const char* name) {
  const Id table = open_table(parent, name);
  const Id type(H5Dget_type(table), H5Tclose, name);
  const std::vector<hsize_t> sizes = shape_of(table);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || sizes.size() != 1) {
    throw Hdf5Error(std::string("data set '") + name + "' does not hold texts of one length");
  }
  const std::size_t length = H5Tget_size(type);
  std::string packed(length * sizes[0], '\0');
  read_rows(table, type, 0, sizes[0], packed.data());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < sizes[0]; ++i) {
    std::string text = packed.substr(i * length, length);
    text.resize(std::min(text.find('\0'), text.size()));
    texts.push_back(std::move(text));
  }
  return texts;
}

}  // namespace brickbench::hdf5
