// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/joint_filter.hpp"

#include <cmath>
#include <stdexcept>

namespace montecarta::filters {

JointFilter::JointFilter(const FilterSetup& setup, const JointFilterSettings& settings)
    : belief_(setup.belief),
      motion_form_(settings.motion),
      joint_(setup, settings.retraction, settings.iterations, settings.moments,
             settings.linearisation) {}

void JointFilter::start(const Pose& start) {
  motion_.restart();
  joint_.start(start);
  is_at_scan_ = false;
  report_ = {};
}

void JointFilter::predict(const StepContext& /*context*/, const Control& control, double duration) {
  is_at_scan_ = false;
  advance(motion_, control, duration, belief_, motion_form_);
}

void JointFilter::update(const StepContext& /*context*/, Scan scan) {
  joint_.update_with(motion_, scan);
  motion_.restart();
  report_update(scan);
  is_at_scan_ = true;
  pose_at_scan_ = joint_.pose_after(motion_);
  joint_.initialise_landmarks(scan);
  report_.map_size = static_cast<double>(joint_.landmarks());
}

void JointFilter::report_update(Scan scan) {
  const auto& [log_likelihood, faults] = joint_.outcome();
  if (!std::isfinite(log_likelihood))
    throw std::runtime_error("the log-likelihood of the scan is not finite");
  report_ = {.log_likelihood = log_likelihood,
             .numerical_faults = faults,
             .association = joint_.association().counts(),
             .rotation_information = joint_.rotation_information()};
  innovations_.start(1, scan.size(), 0.0);
  const auto innovations = innovations_.of_block(0, 1.0);
  for (const auto& [k, v, S] : joint_.used_detections()) {
    innovations.add(k, {{v(0), v(1)}, {S(0, 0), S(1, 0), S(1, 1)}}, Everywhere());
    innovations_.matched_weight(k) = 1.0;
  }
  innovations_.add_to(report_, components_of(belief_.sensor).size());
}

PoseEstimate JointFilter::estimate() const {
  return {is_at_scan_ ? pose_at_scan_ : joint_.pose_after(motion_), std::nullopt};
}

void JointFilter::map(std::span<std::optional<LandmarkEstimate>> landmarks) const {
  for (std::size_t k = 0; k < landmarks.size(); ++k) landmarks[k] = joint_.landmark(k);
}

std::optional<JointEstimate> JointFilter::joint(std::size_t landmarks) const {
  return joint_.joint(landmarks);
}

}  // namespace montecarta::filters
