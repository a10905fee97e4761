// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/moments.hpp"

#include <cstdint>
#include <vector>

namespace montecarta::analysis {

/// What a band says of the average NEES over each batch, by the pointwise band as papers use it.
struct BatchNumbers {
  std::vector<double> share_inside;      ///< {batch} of scans
  std::vector<double> share_above;       ///< {batch} of scans
  std::vector<double> stays_above_from;  ///< [s] {batch} all scans from then on are above the band;
                                         ///< infinite: never
};

/// NEES of one block, by the leading moments, averaged over batches of as many complete runs as a
/// paper had, in their order; runs that fill no batch are left out.
struct BlockBatches {
  ErrorBlock block = ErrorBlock::pose;
  BatchNumbers by_printed;   ///< the band that the paper drew; empty where it drew none
  BatchNumbers by_expected;  ///< the band of so many runs (STATISTICS 3)
};

/// Of a cell; empty where no paper says of how many runs its numbers are.
struct NeesBatches {
  std::uint64_t runs = 0;  ///< in a batch
  std::vector<BlockBatches> blocks;

  /// nullptr where there is no batch of this block.
  const BlockBatches* find(ErrorBlock block) const;
};

}  // namespace montecarta::analysis
