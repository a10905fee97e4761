// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/particle_maps.hpp"
#include "filters/moments/linearised.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace montecarta {

/// What a proposal answers that draws every pose at every scan: pose and map are never correlated
/// within a particle, and there is nothing else to carry along. Proposals that do answer otherwise.
template <class Real>
class DrawnPoses {
 public:
  explicit DrawnPoses(const SensorNoise& noise) : noise_(noise) {}

  /// Before a scan is looked at.
  void begin_scan(const StepContext& /*context*/, std::vector<BasicPose<Real>>& /*poses*/) {}
  /// What a landmark should look like from the predicted pose of block b.
  Innovation<Real> expected(std::size_t /*b*/, std::uint32_t /*slot*/,
                            const PoseGaussian<Real>& pose, const LandmarkGaussian<Real>& landmark,
                            const Sightline<Real>& s) const {
    return innovation_of(pose.covariance, s, RangeBearing<Real>{}, landmark.covariance, noise_);
  }
  /// A new landmark of block b stands in its slot.
  template <class Maps, class Put>
  void settled(Maps& /*maps*/, std::size_t /*b*/, std::uint32_t /*slot*/, const Put& /*put*/) {}
  /// Particle i becomes a copy of particle parents[i].
  void resample(std::span<const std::uint32_t> /*parents*/) {}

 protected:
  const SensorNoise& noise() const { return noise_; }

 private:
  SensorNoise noise_;
};

}  // namespace montecarta
