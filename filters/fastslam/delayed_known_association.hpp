// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/fastslam/known_association.hpp"
#include "filters/fastslam/waiting_landmarks.hpp"

#include <vector>

namespace montecarta::filters {

/// KnownAssociation of a sensor whose detections do not fix a landmark: it initialises landmarks
/// itself, from several detections. Those that wait weigh no particle.
template <class Real>
class DelayedKnownAssociation : public KnownAssociation<Real> {
 public:
  DelayedKnownAssociation(std::size_t landmarks, std::size_t particles, const Belief& belief)
      : KnownAssociation<Real>(landmarks), waiting_(landmarks, particles, belief) {}

  void start() {
    KnownAssociation<Real>::start();
    waiting_.start();
  }
  /// From vehicles at `poses` {block}, drawn for this scan.
  void initialise(ParticleMaps<Real>& maps, const std::vector<BasicPose<Real>>& poses) {
    for (const Detection& detection : this->new_detections()) {
      if (!waiting_.advance(detection, poses)) continue;
      waiting_.place(detection.identity, maps.blocks_of(this->add_slot(detection, maps)));
    }
  }
  void resample(std::span<const std::uint32_t> parents) { waiting_.resample(parents); }

 private:
  WaitingLandmarks<Real> waiting_;
};

}  // namespace montecarta::filters
