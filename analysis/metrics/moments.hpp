// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/data/run_rows.hpp"
#include "analysis/statistics/sampler_scale.hpp"

#include <array>
#include <cstddef>

namespace montecarta::analysis {

/// Which mean and covariance of a filter are judged (STATISTICS 1).
enum class Moments {
  corrected,  ///< of a particle filter: spread of the poses that a scan drew, its NEES put on the
              ///< chi-square's scale (SamplerScale); where it drew none, the mixture
  mixture,    ///< spread of the particles plus each particle's own covariance, before sampling
  spread      ///< of the weighted drawn particles; of the Gaussian for a Kalman filter
};

/// In the order in which they lead the verdict, where they are there: a consistent filter's NEES by
/// the one that leads is chi-square, whatever the filter. Errors are those of the mixture's mean
/// where there is one.
inline constexpr std::array kMoments = {Moments::corrected, Moments::mixture, Moments::spread};

/// Which components of the pose error are judged.
enum class ErrorBlock {
  pose,      ///< x, y, heading
  position,  ///< x, y, with the position block of the covariance
  heading
};

inline constexpr std::array kErrorBlocks = {ErrorBlock::pose, ErrorBlock::position,
                                            ErrorBlock::heading};

/// Components of a block.
constexpr std::size_t dimension_of(ErrorBlock block) {
  return block == ErrorBlock::pose ? 3 : block == ErrorBlock::position ? 2 : 1;
}

/// Whether the spread at scan `s` is of poses that this scan drew. Where a filter with a mixture
/// did not draw, both have the same covariance, each particle's own included. `rows` of a particle
/// filter.
bool is_drawn(const RunRows& rows, std::size_t s);

/// How many draws the weighted particles at scan `s` are worth; all of them where no effective
/// sample size is stored.
EffectiveDraws draws_at(const RunRows& rows, std::size_t particles, std::size_t s);

}  // namespace montecarta::analysis
