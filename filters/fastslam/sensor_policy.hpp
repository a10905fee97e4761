// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "filters/moments/sensor_sight.hpp"

#include <variant>

/// The sensor as an argument of the templates of FastSLAM. It is chosen once per filter, so that
/// loops over particles are compiled for it.
namespace montecarta::filters {

/// Converts the pose of the vehicle to that of its sensor and back, lane by lane (EQUATIONS (2.5)).
class MountedPose {
 public:
  explicit MountedPose(const Mounting& mounting) : mounting_(mounting) {}

  template <class Real>
  [[gnu::always_inline]] BasicPose<Real> sensor(const BasicPose<Real>& vehicle) const {
    const BasicPoint<Real> arm = arm_of(vehicle.heading);
    return {vehicle.x + arm.x, vehicle.y + arm.y, wrap(Real(vehicle.heading + mounting_.turn))};
  }
  template <class Real>
  [[gnu::always_inline]] PoseGaussian<Real> sensor(const PoseGaussian<Real>& vehicle) const {
    const BasicPoint<Real> arm = arm_of(vehicle.mean.heading);
    return {sensor(vehicle.mean), sheared(vehicle.covariance, Real(-arm.y), arm.x)};
  }
  template <class Real>
  [[gnu::always_inline]] PoseGaussian<Real> vehicle(const PoseGaussian<Real>& sensor) const {
    const Real heading = wrap(Real(sensor.mean.heading - mounting_.turn));
    const BasicPoint<Real> arm = arm_of(heading);
    return {{sensor.mean.x - arm.x, sensor.mean.y - arm.y, heading},
            sheared(sensor.covariance, arm.y, Real(-arm.x))};
  }

 private:
  template <class Real>
  [[gnu::always_inline]] BasicPoint<Real> arm_of(const Real& heading) const {
    const Direction<Real> d = direction_of(heading);
    return {d.cosine * mounting_.forward - d.sine * mounting_.left,
            d.sine * mounting_.forward + d.cosine * mounting_.left};
  }

  Mounting mounting_;
};

/// `Transform` for a sensor that is mounted on the vehicle: refines the pose of the sensor. All
/// other arguments, called `scan`, are passed on.
template <class Transform>
class Mounted {
 public:
  static constexpr bool kRefinesInBatch = Transform::kRefinesInBatch;
  Mounted(const Mounting& mounting, const Transform& transform)
      : mounting_(mounting), transform_(transform) {}

  void advance(MotionIncrement& motion, const Control& control, double duration,
               const Belief& belief) const {
    transform_.advance(motion, control, duration, belief);
  }
  template <class Real>
  [[gnu::always_inline]] Innovation<Real> refine(PoseGaussian<Real>& pose, auto&&... scan) const {
    PoseGaussian<Real> sensor = mounting_.sensor(pose);
    Innovation<Real> v = transform_.refine(sensor, scan...);
    pose = mounting_.vehicle(sensor);
    return v;
  }
  template <class Real>
  void refine_in_batch(PoseGaussian<Real>& pose, const BasicPose<Real>& predicted,
                       auto&&... scan) const {
    PoseGaussian<Real> sensor = mounting_.sensor(pose);
    transform_.refine_in_batch(sensor, mounting_.sensor(predicted), scan...);
    pose = mounting_.vehicle(sensor);
  }
  template <class Real>
  [[gnu::always_inline]] Innovation<Real> update(LandmarkGaussian<Real>& landmark,
                                                 const BasicPose<Real>& pose,
                                                 auto&&... scan) const {
    return transform_.update(landmark, mounting_.sensor(pose), scan...);
  }
  template <class Real>
  LandmarkGaussian<Real> initialise(const BasicPose<Real>& pose, const Measurement<Real>& seen,
                                    const SensorNoise& noise) const {
    return transform_.initialise(mounting_.sensor(pose), seen, noise);
  }

 private:
  MountedPose mounting_;
  Transform transform_;
};

/// Range and bearing, measured at the pose of the vehicle.
struct SensorAtPose {
  using Kind = RangeBearingSensor;
  explicit SensorAtPose(const Sensor& sensor) {
    expect(std::holds_alternative<RangeBearingSensor>(sensor.kind) && sensor.mounting.is_none(),
           "SensorAtPose is given another sensor than its FilterKind has in `sensors`");
  }

  template <class Gaussian>
  [[gnu::always_inline]] const Gaussian& sensor(const Gaussian& vehicle) const {
    return vehicle;
  }
  template <class Transform>
  const Transform& transform(const Transform& of_range_and_bearing) const {
    return of_range_and_bearing;
  }
};

/// A sensor of any kind, mounted anywhere on the vehicle.
template <class KindOfSensor>
class OnMounting {
 public:
  using Kind = KindOfSensor;
  explicit OnMounting(const Sensor& sensor) : mounting_(sensor.mounting) {}

  template <class Real>
  [[gnu::always_inline]] PoseGaussian<Real> sensor(const PoseGaussian<Real>& vehicle) const {
    return MountedPose(mounting_).sensor(vehicle);
  }
  template <class Transform>
  auto transform(const Transform& of_range_and_bearing) const {
    const auto of_sensor = of_kind(Kind(), of_range_and_bearing);
    return Mounted<std::decay_t<decltype(of_sensor)>>(mounting_, of_sensor);
  }

 private:
  Mounting mounting_;
};

/// Calls `make` with SensorAtPose or OnMounting for the given sensor.
template <class Make>
auto with_sensor(const Sensor& sensor, const Make& make) {
  if (std::holds_alternative<RangeBearingSensor>(sensor.kind) && sensor.mounting.is_none())
    return make(SensorAtPose(sensor));
  return std::visit(
      [&](const auto& kind) { return make(OnMounting<std::decay_t<decltype(kind)>>(sensor)); },
      sensor.kind);
}

}  // namespace montecarta::filters
