// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/h5.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_layout.hpp"

#include <cstdint>
#include <optional>
#include <span>

namespace montecarta::engine {

/// A dataset with one row for each run. If its numbers lie in one piece, in the byte order of this
/// machine, any number of threads read rows at once and without HDF5. Otherwise HDF5 reads them,
/// one at a time.
class RunDataset {
 public:
  /// `file` has the bytes of the dataset and must outlive it. If it is nullptr, HDF5 reads all
  /// rows.
  RunDataset(h5::Handle dataset, const PosixFile* file);

  /// Row `i`, converted to double or std::uint32_t. Throws StudyError unless `out` fits.
  template <class Number>
  void read(std::uint64_t i, std::span<Number> out) const;

 private:
  /// Returns whether row `i` was read without HDF5.
  template <class Number>
  bool read_in_one_piece(std::uint64_t i, std::span<Number> out) const;

  h5::Handle dataset_;
  std::optional<Element> element_;  ///< nullopt: none of ours
  std::optional<Slab> slab_;        ///< nullopt: not in one piece
  const PosixFile* file_;
};

}  // namespace montecarta::engine
