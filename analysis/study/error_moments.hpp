// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/sums.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

namespace montecarta::analysis {

/// Errors over runs and the deviations that the filter reports, in the ErrorFrame: forward [m],
/// left [m], heading [rad].
struct ErrorsOverTime {
  std::array<std::vector<double>, 3> rms;  ///< {component}{scan} root mean square error
  /// {component}{scan} root of the mean reported variance.
  std::array<std::vector<double>, 3> believed;
  std::array<std::vector<double>, 3> mean;  ///< {component}{scan} mean error
};

/// The errors of one run and the deviations that the filter reports, in the same frame.
struct ErrorTrace {
  std::uint64_t run = 0;                     ///< number of the run in the study
  std::array<std::vector<double>, 3> error;  ///< {component}{scan} error of the estimate
  /// {component}{scan} standard deviation that the filter reports.
  std::array<std::vector<double>, 3> deviation;
  static constexpr auto members() {
    return std::tuple(&ErrorTrace::run, &ErrorTrace::error, &ErrorTrace::deviation);
  }
};

/// The trace of run number `run`; `errors` and `covariances` are {scan} in the ErrorFrame.
ErrorTrace error_trace(std::uint64_t run, std::span<const Eigen::Vector3d> errors,
                       std::span<const Eigen::Matrix3d> covariances);

/// Adds up errors, their squares and the reported variances over runs.
class ErrorMoments {
 public:
  explicit ErrorMoments(std::size_t scans) : scans_(scans) {}

  /// Adds one run; `errors` and `covariances` are {scan} in the ErrorFrame. Scans with an error or
  /// a covariance that is not finite are left out.
  void add(std::span<const Eigen::Vector3d> errors, std::span<const Eigen::Matrix3d> covariances);
  ErrorsOverTime result() const;
  static constexpr auto parts() { return std::tuple(added(&ErrorMoments::scans_)); }

 private:
  struct ScanSums {
    double n = 0.0;
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    Eigen::Vector3d variances = Eigen::Vector3d::Zero();
    static constexpr auto parts() {
      return std::tuple(
          added(&ScanSums::n, &ScanSums::error, &ScanSums::squares, &ScanSums::variances));
    }
  };
  std::vector<ScanSums> scans_;
};

}  // namespace montecarta::analysis
