// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "experiments/study/study.hpp"

namespace montecarta::experiments {

/// A sum of scores, and their number.
struct ScoreSum {
  double sum = 0.0;
  double n = 0.0;

  void add(double score) {
    sum += score;
    n += 1.0;
  }
  void add(const ScoreSum& more) {
    sum += more.sum;
    n += more.n;
  }
  double mean() const { return sum / n; }
};

/// Student's score at the usual level for the mean of `n` independent samples, which need not be a
/// whole number. Fewer than two say hardly anything, and have a finite score all the same.
double t_of_samples(double n);

/// The log score of the pose after a scan (STATISTICS 7); NaN where its covariance is singular.
double pose_score(const PoseEstimate& estimate, const Pose& truth);

/// The log score of the innovations of a scan (STATISTICS 23). With nearest association the filter
/// gives a detection that it leaves out a density which falls with the noise that it assumes
/// (EQUATIONS (17.2)). Here this density is that of the study, so that scores with different noise
/// can be compared.
class InnovationScore {
 public:
  InnovationScore(const Study& study, const CellSpec& cell);
  double operator()(const ScanReport& report, Scan scan) const;

 private:
  double components_;
  /// Logarithm by which the density is too large for each component of such a detection.
  double correction_;
};

}  // namespace montecarta::experiments
