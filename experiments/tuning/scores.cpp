// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/scores.hpp"

#include "analysis/run/nees.hpp"
#include "analysis/statistics/distributions.hpp"
#include "engine/core/judgement.hpp"
#include "experiments/study/vehicle_and_sensor.hpp"
#include "experiments/tuning/filter_on_drive.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {

double t_of_samples(double n) {
  constexpr double kFewestFreedom = 0.5;
  return t_score(kUsualLevel, std::max(n - 1.0, kFewestFreedom));
}

double pose_score(const PoseEstimate& estimate, const Pose& truth) {
  const PoseMoments& judged = judged_moments(estimate);
  WhitenedPose pose;
  whiten_pose(boxminus(judged.mean, truth), judged.covariance, pose);
  return negative_log_density(pose);
}

InnovationScore::InnovationScore(const Study& study, const CellSpec& cell)
    : components_(static_cast<double>(components_of(sensor_of(study.settings, "belief")).size())),
      correction_(study.settings.text("association", "kind") == "known"
                      ? 0.0
                      : -std::log(mismatch_of(cell, "sensor_noise"))) {}

double InnovationScore::operator()(const ScanReport& report, Scan scan) const {
  const double left_out =
      static_cast<double>(scan.size()) * components_ - static_cast<double>(report.nis_dof);
  return -report.log_likelihood + correction_ * left_out;
}

}  // namespace montecarta::experiments
