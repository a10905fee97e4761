// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace montecarta::analysis {

/// How far the covariance is from the errors that happened (Li, Zhao and Duan 2006): the ratio of
/// e' P^-1 e to e' S^-1 e, where S is the mean squared error matrix over runs, in decibel. 3 dB is
/// a factor of 2.
struct Credibility {
  /// [dB] Mean of the ratio's absolute logarithm; 0: as reported.
  double noncredibility = std::numeric_limits<double>::quiet_NaN();
  /// [dB] Mean of its logarithm; above 0: overconfident, below: conservative.
  double inclination = std::numeric_limits<double>::quiet_NaN();
};

/// Keeps errors at up to a hundred scans, fewer of many runs.
class CredibilitySamples {
 public:
  explicit CredibilitySamples(std::size_t scans);

  /// One run: `errors` {scan} [m, m, rad] and their NEES {scan}; what is not finite is left out.
  void add(std::span<const Eigen::Vector3d> errors, std::span<const double> nees);
  /// NaN where there are too few runs to know S: fewer than ten.
  Credibility result() const;

 private:
  struct Sample {
    Eigen::Vector3d error;
    double nees;
  };
  struct KeptScan {
    std::size_t scan;
    std::vector<Sample> runs;
  };
  void keep_every_second();

  std::vector<KeptScan> kept_;
  std::size_t samples_ = 0;
};

}  // namespace montecarta::analysis
