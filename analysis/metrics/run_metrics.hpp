// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/diversity.hpp"
#include "analysis/metrics/run_rows.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta {

/// Which mean and covariance of a filter are judged (SPEC 19).
enum class Moments {
  mixture,  ///< spread of the particles plus each particle's own covariance, before sampling
  spread    ///< of the weighted drawn particles; of the Gaussian for a Kalman filter
};

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

/// NEES of one run by one definition of the moments; empty where no covariance is stored.
struct NeesRows {
  std::array<std::vector<double>, 3> value;          ///< {block}{scan}
  std::array<std::vector<std::uint8_t>, 3> floored;  ///< {block}{scan} SPEC 19's floor was added
};

/// What one run says, scan by scan. Keeps its memory from run to run; one per thread.
class RunMetrics {
 public:
  /// Reads `rows` of a complete run with `particles` (0: none); `times` [s] of the scans. Without
  /// truth there are no errors and no NEES: their rows are empty.
  void measure(const RunRows& rows, std::size_t particles, std::span<const double> times);

  const NeesRows& nees(Moments moments) const {
    return moments == Moments::mixture ? mixture_ : spread_;
  }
  /// [m^2] {scan}, of the leading mean: the mixture's where stored.
  const std::vector<double>& squared_position() const { return squared_position_; }
  /// [rad^2] {scan}
  const std::vector<double>& squared_heading() const { return squared_heading_; }
  /// nullptr where there are no ancestors.
  const Diversity* diversity() const { return diversity_; }

 private:
  void measure_errors(const RunRows& rows, std::size_t scans);

  NeesRows spread_, mixture_;
  std::vector<double> squared_position_, squared_heading_;
  DiversityCounter counter_;
  const Diversity* diversity_ = nullptr;
};

}  // namespace montecarta
