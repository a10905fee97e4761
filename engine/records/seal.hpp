// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

/// The seal of a result file: a block behind the end of what is HDF5's, with a fingerprint of every
/// byte that is not written again once the file is laid out (analysis/FORMAT.md, "The seal"). It is
/// looked at before the HDF5 library sees the file, which damaged metadata can crash.
namespace montecarta::engine {

/// Bytes [offset, offset + length) of a file.
struct ByteRange {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
};

/// What is written after a file is laid out: increasing, none touches another.
std::vector<ByteRange> written_later(const ResultSlabs& slabs);

/// Appends the seal to a file just laid out; `open` are the ranges that it leaves open.
void put_seal(const PosixFile& file, const std::vector<ByteRange>& open);

enum class Seal : std::uint8_t {
  holds,
  absent,  ///< laid out by an older version, or written again by another program
};
/// Throws StudyError where the file is not HDF5, was cut short, or does not fit its seal.
Seal check_seal(const std::filesystem::path& path);

/// Opens a result file for reading once its seal is checked; throws as check_seal() does.
h5::Handle open_checked(const std::filesystem::path& path);

}  // namespace montecarta::engine
