// SPDX-License-Identifier: BSD-3-Clause
#include "filters/moments/motion_increment.hpp"

#include "filters/models/ackermann.hpp"

namespace montecarta::filters {

template <class V>
void MotionIncrement::advance(const V& vehicle, const Control& control, double duration,
                              const std::array<double, Control::kMost>& sigma) {
  const double angle = bend_angle(vehicle, control, duration);
  const auto [heading, turning_angle] = directions_of<2>({pose_.heading, angle});
  const auto [pose, F] =
      linearised_move(pose_, heading, control, {angle, turning_angle}, duration, vehicle);
  covariance_ = sheared(covariance_, F.x_heading, F.y_heading);
  for (std::size_t i = 0; i < kControlsOf<V>; ++i) {
    const auto& [x, y, turn] = F.by_control[i];
    add_outer(covariance_, sigma[i] * sigma[i], {x, y, turn});
  }
  pose_ = pose;
}

void MotionIncrement::advance(const Control& control, double duration, const Belief& belief) {
  const auto sigma = deviations_of(belief.control, control, belief.vehicle);
  const double heading = pose_.heading;
  std::visit([&](const auto& one) { advance(one, control, duration, sigma); }, belief.vehicle);
  if (belief.control.increment.is_none()) return;
  add_increment_noise(direction_of(heading), control, duration, belief);
}

void MotionIncrement::add_increment_noise(const Direction<double>& course, const Control& control,
                                          double duration, const Belief& belief) {
  const BodyStep<double> step = body_step(belief.vehicle, control, duration);
  for (const auto& column : increment_columns(belief.control.increment, step, duration)) {
    const Point way = in_world(course, column.forward, column.left);
    add_outer(covariance_, 1.0, {way.x, way.y, column.turn});
  }
}

}  // namespace montecarta::filters
