// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/merging.hpp"
#include "analysis/statistics/spread.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Names of the components of an error in the frame of the true vehicle.
inline constexpr std::array kErrorComponents = {"forward", "left", "heading"};

/// Errors over runs beside the covariance that the filter believes, in the frame of the true
/// vehicle (forward [m], left [m], heading [rad]).
struct ErrorAnatomy {
  std::array<std::vector<double>, 3> happened;  ///< {component}{scan} root mean square error
  std::array<std::vector<double>, 3> believed;  ///< {component}{scan} root mean variance
  std::array<std::vector<double>, 3> bias;      ///< {component}{scan} mean error
  /// {scan} share of the NEES that comes from the mean error rather than from its scatter
  std::vector<double> bias_share;
  double mean_bias_share = kNaN;  ///< over scans
};

/// The errors of one run and the deviations that the filter believes, in the same frame.
struct ErrorTrace {
  std::uint64_t run = 0;                         ///< its number in the study
  std::array<std::vector<double>, 3> error;      ///< {component}{scan}
  std::array<std::vector<double>, 3> deviation;  ///< {component}{scan}
  static constexpr auto members() {
    return std::tuple(&ErrorTrace::run, &ErrorTrace::error, &ErrorTrace::deviation);
  }
};

/// The trace of run number `run`; both {scan}, in the frame of the true vehicle.
ErrorTrace error_trace(std::uint64_t run, std::span<const Eigen::Vector3d> errors,
                       std::span<const Eigen::Matrix3d> covariances);

/// Adds up the moments of errors and the covariances over runs.
class ErrorMoments {
 public:
  explicit ErrorMoments(std::size_t scans) : scans_(scans) {}

  /// Adds one run, {scan}, both in the frame of the true vehicle. Scans with an error or a
  /// covariance that is not finite are left out.
  void add(std::span<const Eigen::Vector3d> errors, std::span<const Eigen::Matrix3d> covariances);
  ErrorAnatomy result() const;
  static constexpr auto parts() { return std::tuple(added(&ErrorMoments::scans_)); }

 private:
  struct Sums {
    double n = 0.0;
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    static constexpr auto parts() {
      return std::tuple(added(&Sums::n, &Sums::error, &Sums::squares, &Sums::covariance));
    }
  };
  std::vector<Sums> scans_;
};

}  // namespace montecarta::analysis
