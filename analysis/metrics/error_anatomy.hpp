// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// Names of the components of an error in the frame of the true vehicle.
inline constexpr std::array kErrorComponents = {"forward", "left", "heading"};

/// Why a NEES is what it is: errors against what the filter believed of them, in the frame of the
/// true vehicle (forward [m], left [m], heading [rad]), over runs.
struct ErrorAnatomy {
  std::array<std::vector<double>, 3> happened;  ///< {component}{scan} root mean square error
  std::array<std::vector<double>, 3> believed;  ///< {component}{scan} root mean variance
  std::array<std::vector<double>, 3> bias;      ///< {component}{scan} mean error
  std::vector<double>
      bias_share;  ///< {scan} of the NEES that the mean error makes, not its scatter
  std::vector<double> worst_ratio;  ///< {scan} of mean squared error to mean variance in the
                                    ///< direction where it is greatest (generalised eigenvalue)
  double mean_bias_share = 0.0;     ///< over scans
  double mean_worst_ratio = 0.0;    ///< geometric, over scans
  std::array<double, 3> worst_direction{};  ///< share of each component in it, in units of its
                                            ///< believed deviation, over scans; adds up to 1
};

/// What mean_worst_ratio at one scan is below with probability `level` if a filter is consistent:
/// the largest of three ratios is above 1 even then.
double expected_worst_ratio(std::size_t runs, double level);

/// Adds up the moments of errors and the covariances over runs.
class ErrorMoments {
 public:
  explicit ErrorMoments(std::size_t scans) : scans_(scans) {}

  /// One run, {scan}, both in the frame of the true vehicle; what is not finite is left out.
  void add(std::span<const Eigen::Vector3d> errors, std::span<const Eigen::Matrix3d> covariances);
  ErrorAnatomy result() const;

 private:
  struct Sums {
    double n = 0.0;
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };
  std::vector<Sums> scans_;
};

}  // namespace montecarta::analysis
