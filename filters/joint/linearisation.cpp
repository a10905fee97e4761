// SPDX-License-Identifier: BSD-3-Clause
#include "filters/joint/linearisation.hpp"

#include "filters/joint/robocentric_frame.hpp"

namespace montecarta::filters {

void LinearisationPoints::start(const Pose& start) {
  pose_ = start;
  landmarks_.clear();
}

Eigen::Vector2d LinearisationPoints::behind(const Pose& place) const {
  return place_of(place) - place_of(pose_);
}

Eigen::Vector2d LinearisationPoints::shift_to(const CompressedGaussian& gaussian) const {
  Eigen::Vector2d sum = behind(gaussian.pose().mean);
  for (std::size_t slot = 0; slot < landmarks_.size(); ++slot) {
    sum += gaussian.mean_of(slot) - landmarks_[slot];
  }
  return sum / static_cast<double>(1 + landmarks_.size());
}

void LinearisationPoints::shift(const Eigen::Vector2d& way) {
  pose_.x += way(0);
  pose_.y += way(1);
  for (Eigen::Vector2d& landmark : landmarks_) landmark += way;
}

void LinearisationPoints::turn(double angle) {
  const Eigen::Matrix2d R = rotation_by(angle);
  const Eigen::Vector2d place = R * place_of(pose_);
  pose_ = {place.x(), place.y(), pose_.heading};
  for (Eigen::Vector2d& landmark : landmarks_) landmark = (R * landmark).eval();
}

void LinearisationPoints::move(const LinearisedMotion& motion) {
  const Eigen::Vector2d way = -quarter_turned(motion.by_heading);
  pose_ = {pose_.x + way(0), pose_.y + way(1), motion.mean.heading};
}

Eigen::Vector2d turned(const ExpectedObservation& expected, const Eigen::Vector2d& place,
                       const Eigen::Vector2d& landmark) {
  return expected.pose_jacobian.leftCols<2>() * quarter_turned(place) +
         expected.pose_jacobian.col(2) + expected.landmark_jacobian * quarter_turned(landmark);
}

LinearisedMotion Linearisation::linearised(const LinearisedSystem& system,
                                           const MotionIncrement& motion) const {
  return system.gaussian.linearised(motion);
}

void Linearisation::move(const MotionIncrement& motion, LinearisedSystem& system) const {
  const LinearisedMotion how = linearised(system, motion);
  system.gaussian.move(how);
  system.points.move(how);
}

CompressedGaussian::ObservationStatus Linearisation::predict(const LinearisedSystem& system,
                                                             std::size_t slot,
                                                             ExpectedObservation& expected) const {
  return system.gaussian.predict_observation(slot, expected);
}

Eigen::Vector2d Linearisation::offset(const LinearisedSystem& /*system*/) const {
  return Eigen::Vector2d::Zero();
}

ObservationPoint Linearisation::rotation_point(const LinearisedSystem& system,
                                               std::size_t slot) const {
  return {system.points.pose(), system.points.landmark(slot)};
}

PoseMoments Linearisation::pose_after(const LinearisedSystem& system,
                                      const MotionIncrement& motion) const {
  return system.gaussian.pose_after(linearised(system, motion));
}

LandmarkEstimate Linearisation::landmark(const CompressedGaussian& gaussian,
                                         std::size_t slot) const {
  return gaussian.landmark(slot);
}

namespace {

bool stands_still(const MotionIncrement& motion) {
  const Pose& pose = motion.pose();
  return pose.x == 0.0 && pose.y == 0.0 && pose.heading == 0.0 &&
         symmetric(motion.covariance()).isZero(0.0);
}

class AtEstimate final : public Linearisation {
 public:
  /// Computes no derivatives, since it is called at every control step.
  PoseMoments pose_after(const LinearisedSystem& system,
                         const MotionIncrement& motion) const override {
    return system.gaussian.pose_after(motion);
  }
};

class AtFirstEstimates : public Linearisation {
 public:
  /// Linearises at the first estimates. A vehicle that has not moved keeps its point, and nothing
  /// is linearised.
  LinearisedMotion linearised(const LinearisedSystem& system,
                              const MotionIncrement& motion) const override {
    LinearisedMotion linearised = system.gaussian.linearised(motion);
    if (stands_still(motion)) return linearised;
    linearised.by_heading += quarter_turned(offset(system) - shift(system));
    return linearised;
  }
  CompressedGaussian::ObservationStatus predict(const LinearisedSystem& system, std::size_t slot,
                                                ExpectedObservation& expected) const override {
    return system.gaussian.predict_observation(
        slot, expected, ObservationPoint{system.points.pose(), system.points.landmark(slot)});
  }
  Eigen::Vector2d offset(const LinearisedSystem& system) const override {
    return system.points.behind(system.gaussian.pose().mean);
  }

 protected:
  /// Shift [m] of all points before a motion.
  virtual Eigen::Vector2d shift(const LinearisedSystem& /*system*/) const {
    return Eigen::Vector2d::Zero();
  }
};

class AtConstrainedEstimates final : public AtFirstEstimates {
 public:
  void move(const MotionIncrement& motion, LinearisedSystem& system) const override {
    const LinearisedMotion how = linearised(system, motion);
    if (!stands_still(motion)) system.points.shift(shift(system));
    system.gaussian.move(how);
    system.points.move(how);
  }

 protected:
  Eigen::Vector2d shift(const LinearisedSystem& system) const override {
    return system.points.shift_to(system.gaussian);
  }
};

class RelativeToVehicle final : public Linearisation {
 public:
  void start(const Pose& start, CompressedGaussian& gaussian) override {
    frame_.start(start, gaussian);
  }
  void end_scan(CompressedGaussian& gaussian) override { frame_.centre(gaussian); }
  /// Returns the estimates, since only the frame of the map rotates.
  ObservationPoint rotation_point(const LinearisedSystem& system, std::size_t slot) const override {
    return {system.gaussian.pose().mean, system.gaussian.mean_of(slot)};
  }
  PoseMoments pose_after(const LinearisedSystem& system,
                         const MotionIncrement& motion) const override {
    return frame_.in_map(Linearisation::pose_after(system, motion));
  }
  LandmarkEstimate landmark(const CompressedGaussian& gaussian, std::size_t slot) const override {
    return frame_.in_map(gaussian, slot);
  }
  void put_in_map(JointEstimate& joint) const override { frame_.put_in_map(joint); }

 private:
  RobocentricFrame frame_;
};

class BySigmaPoints final : public Linearisation {
 public:
  LinearisedMotion linearised(const LinearisedSystem& system,
                              const MotionIncrement& motion) const override {
    return system.gaussian.regressed(motion);
  }
  CompressedGaussian::ObservationStatus predict(const LinearisedSystem& system, std::size_t slot,
                                                ExpectedObservation& expected) const override {
    return system.gaussian.predict_by_sigma_points(slot, expected);
  }
};

}  // namespace

std::unique_ptr<Linearisation> at_estimate() { return std::make_unique<AtEstimate>(); }
std::unique_ptr<Linearisation> at_first_estimates() { return std::make_unique<AtFirstEstimates>(); }
std::unique_ptr<Linearisation> at_constrained_estimates() {
  return std::make_unique<AtConstrainedEstimates>();
}
std::unique_ptr<Linearisation> relative_to_vehicle() {
  return std::make_unique<RelativeToVehicle>();
}
std::unique_ptr<Linearisation> by_sigma_points() { return std::make_unique<BySigmaPoints>(); }

}  // namespace montecarta::filters
