// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"
#include "filters/moments/mounted.hpp"
#include "filters/moments/sigma_sensor.hpp"

#include <variant>

/// How the templates of FastSLAM are told their sensor, which is chosen once a filter: the loops
/// over particles know it when they are compiled.
namespace montecarta::filters {

/// Range and bearing from the pose of the vehicle.
struct AtPose {
  using Kind = RangeBearingSensor;
  explicit AtPose(const Sensor& sensor) {
    expect(std::holds_alternative<RangeBearingSensor>(sensor.kind) && sensor.mounting.is_none(),
           "AtPose is given another sensor than its FilterKind has in `sensors`");
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

/// A sensor of any kind, anywhere on the vehicle.
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

/// Calls `make` with one of these.
template <class Make>
auto with_sensor(const Sensor& sensor, const Make& make) {
  if (std::holds_alternative<RangeBearingSensor>(sensor.kind) && sensor.mounting.is_none())
    return make(AtPose(sensor));
  return std::visit(
      [&](const auto& kind) { return make(OnMounting<std::decay_t<decltype(kind)>>(sensor)); },
      sensor.kind);
}

}  // namespace montecarta::filters
