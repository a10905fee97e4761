// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace montecarta::analysis {

/// The map of a run after its last scan, row by row; rows are identities of the world with known
/// association, else the order of initialisation.
struct FinalMap {
  std::vector<std::uint32_t> seen;          ///< {landmark} 1 where it is in the map
  std::vector<Eigen::Vector2d> mean;        ///< [m] {landmark}
  std::vector<Eigen::Matrix2d> covariance;  ///< [m^2] {landmark}

  /// [m] of the landmarks that are in the map.
  std::vector<Eigen::Vector2d> places() const {
    std::vector<Eigen::Vector2d> found;
    for (std::size_t l = 0; l < seen.size(); ++l) {
      if (seen[l] != 0) found.push_back(mean[l]);
    }
    return found;
  }
};

}  // namespace montecarta::analysis
