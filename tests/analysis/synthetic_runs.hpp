// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/run/run_criteria.hpp"
#include "analysis/run/run_rows.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/random/stream.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Times of scans that begin a period after the start [s].
inline std::vector<double> scan_times(std::size_t scans, double period = 1.0) {
  std::vector<double> times;
  for (std::size_t s = 0; s < scans; ++s) times.push_back(period * static_cast<double>(s + 1));
  return times;
}

/// Criteria of runs with these scans, which must outlive them.
inline RunCriteria criteria_of_scans(std::span<const double> times) {
  return {.times = times,
          .references = {},
          .beacons = {},
          .map = {},
          .joint_scans = {},
          .components = {"forward", "left", "heading"}};
}

/// Runs with errors that are drawn, independently at each scan, from a known Gaussian.
struct SyntheticStudy {
  std::size_t scans = 400;
  double scan_period = 0.2;                        ///< [s]
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< [m, m, rad] of the error
  double inflation = 1.0;                          ///< of the errors' deviations
  std::uint64_t seed = 1;

  /// The covariance that the filter reports [m, m, rad]^2.
  static Eigen::Matrix3d covariance() {
    Eigen::Matrix3d P;
    P << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.0025;
    return P;
  }

  std::vector<double> times() const { return scan_times(scans, scan_period); }

  RunRows run(std::uint64_t number) const {
    RngStream draw({seed, number, 0, 0, Draw::test});
    const Eigen::Matrix3d L = covariance().llt().matrixL();
    RunRows rows;
    for (std::size_t s = 0; s < scans; ++s) {
      const double t = 0.2 * static_cast<double>(s);
      const Eigen::Vector3d truth(3.0 * t, 10.0 * std::sin(0.1 * t), wrap(0.5 * t));
      const Eigen::Vector3d noise(draw.normal(), draw.normal(), draw.normal());
      Eigen::Vector3d mean = truth + bias + inflation * (L * noise);
      mean(2) = wrap(mean(2));
      rows.truth.insert(rows.truth.end(), truth.begin(), truth.end());
      rows.spread.mean.insert(rows.spread.mean.end(), mean.begin(), mean.end());
      const Eigen::Matrix3d P = covariance();  // symmetric: either order of storage
      rows.spread.covariance.insert(rows.spread.covariance.end(), P.data(), P.data() + 9);
    }
    rows.numerical_faults.assign(scans, 0);
    rows.cpu_seconds = 0.5;
    return rows;
  }
};

}  // namespace montecarta::analysis
