// Numbers as HDF5 files hold them, into those of this machine. Only for .cpp files: it brings the library's headers.
#pragma once

#include <hdf5.h>

#include <cstddef>

namespace underbody::postproc {

/// Takes `count` numbers as the file has them and writes them as they are wanted.
using Hdf5Convert = void (*)(const unsigned char* stored, std::size_t count, void* out);

/// For the type of a data set, to 32 bits without a sign (`whole`; see `Hdf5Rows::add`) or to reals: whole numbers of
/// 1, 2, 4 and 8 bytes and IEEE reals of 4 and 8, in both byte orders; null for all others.
Hdf5Convert conversion_from(hid_t type, bool whole);

}  // namespace underbody::postproc
