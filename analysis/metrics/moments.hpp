// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace montecarta::analysis {

/// Which mean and covariance of a filter are judged (STATISTICS 1).
enum class Moments {
  mixture,    ///< spread of the particles plus each particle's own covariance, before sampling
  corrected,  ///< spread of the particles, its NEES put on the chi-square's scale (SamplerScale)
  spread      ///< of the weighted drawn particles; of the Gaussian for a Kalman filter
};

/// In the order in which they lead the verdict, where they are there.
inline constexpr std::array kMoments = {Moments::mixture, Moments::corrected, Moments::spread};

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

}  // namespace montecarta::analysis
