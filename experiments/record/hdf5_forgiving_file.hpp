// A file driver for HDF5 that keeps the first error of the disk to itself.
//
// HDF5 1.10 cannot close a file whose last writes fail: it ends in an endless loop or a crash when
// the process ends. Through this driver every write succeeds as far as HDF5 knows; the error of the
// system is kept for us, and from then on nothing more is written.
#pragma once

#include "experiments/record/hdf5.hpp"

namespace brickbench::hdf5 {

// Sets the driver on a file access list. `error` (0 at first, then an errno) must outlive the file.
void use_forgiving_file(hid_t access, int* error);

}  // namespace brickbench::hdf5
