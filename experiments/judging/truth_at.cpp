// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/truth_at.hpp"

#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"
#include "experiments/text/words.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace montecarta::experiments {
namespace {

/// Interpolates from state `a` (`share` = 0) to state `b` (`share` = 1).
Eigen::VectorXd between(const StateShape& shape, const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                        double share) {
  Eigen::VectorXd state = a + share * (b - a);
  for (Eigen::Index k = 0; k < state.size(); ++k) {
    if (is_angle(shape, k)) state(k) = wrap(a(k) + share * wrap(b(k) - a(k)));
  }
  if (shape.kind == StateKind::pose_in_space) {
    const Eigen::Quaterniond from(Eigen::Vector4d(a.segment<4>(kQuaternionPlace)));
    const Eigen::Quaterniond to(Eigen::Vector4d(b.segment<4>(kQuaternionPlace)));
    state.segment<4>(kQuaternionPlace) = from.slerp(share, to).coeffs();
  }
  return state;
}

}  // namespace

Eigen::VectorXd truth_at(const StateRows& truth, double time, const TimeMatch& match,
                         const std::filesystem::path& estimate,
                         const std::filesystem::path& truths) {
  const auto after = std::ranges::lower_bound(truth.time, time);
  const auto right = static_cast<std::size_t>(after - truth.time.begin());
  const bool has_left = right > 0, has_right = right < truth.time.size();
  const double to_left = has_left ? time - truth.time[right - 1] : INFINITY;
  const double to_right = has_right ? truth.time[right] - time : INFINITY;
  if (std::min(to_left, to_right) <= match.tolerance) {
    return truth.state[to_right <= to_left ? right : right - 1];
  }
  if (match.interpolate && has_left && has_right) {
    return between(truth.shape, truth.state[right - 1], truth.state[right],
                   to_left / (to_left + to_right));
  }
  throw StudyError(estimate.string() + ": time " + to_text(time) + " s has no truth in " +
                   truths.string() + " (the nearest is " + to_text(std::min(to_left, to_right)) +
                   " s away, --tolerance is " + to_text(match.tolerance) + " s): " +
                   (has_left && has_right
                        ? "give truths at the times of the estimates, or use --interpolate, or a "
                          "larger --tolerance if times have few digits"
                        : "leave out estimates outside of the truth, or use a larger --tolerance "
                          "if times have few digits"));
}

}  // namespace montecarta::experiments
