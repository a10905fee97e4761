// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/posix_file.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

/// The seal of a result file: a block behind the HDF5 data with a fingerprint of all bytes that do
/// not change after the file is laid out (analysis/FORMAT.md, "The seal"). It is checked before the
/// HDF5 library opens the file, because damaged metadata can crash the library.
namespace montecarta::engine {

/// Bytes [offset, offset + length) of a file.
struct ByteRange {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
};

/// Appends the seal to a new file. Its fingerprint leaves out the ranges `open`.
void put_seal(const PosixFile& file, const std::vector<ByteRange>& open);

enum class Seal : std::uint8_t {
  holds,
  absent,  ///< the version is older, or another program rewrote the file
};
/// Throws StudyError if the file is not HDF5, is cut short, or does not match its seal.
Seal check_seal(const std::filesystem::path& path);

}  // namespace montecarta::engine
