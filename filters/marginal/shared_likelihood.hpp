// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/marginal/marginal_options.hpp"
#include "filters/marginal/shared_association.hpp"
#include "filters/moments/linearised.hpp"
#include "filters/population/innovation_sums.hpp"

#include <cstddef>
#include <vector>

namespace montecarta::filters {

/// How well poses explain the matched detections of a scan, the map being the same for all.
template <class Real>
class SharedLikelihood {
 public:
  SharedLikelihood(const SensorNoise& noise, MapMode mode) : noise_(noise), mode_(mode) {}

  /// One-step maps are parameters, known exactly as far as the likelihood goes (Havangi eq. 28);
  /// recursive ones add Hf Lambda^-1 Hf' to R (EQUATIONS 14).
  bool map_is_exact() const { return mode_ != MapMode::recursive; }

  void see(const std::vector<SharedMatch>& matches, const SharedMap& map) {
    seen_.clear();
    for (const SharedMatch& match : matches) {
      const SharedLandmark& landmark = map[match.landmark];
      const Symmetric2<double> P = map_is_exact() ? Symmetric2<double>{} : landmark.covariance();
      seen_.push_back(
          {{{Real(landmark.mean.x), Real(landmark.mean.y)}, {Real(P.xx), Real(P.xy), Real(P.yy)}},
           {Real(match.seen.range), Real(match.seen.bearing)}});
    }
  }
  std::size_t matches() const { return seen_.size(); }

  /// log p(z | pose).
  [[gnu::always_inline]] Weighing<Real> at(const BasicPose<Real>& pose) const {
    Evidence<Real> evidence;
    for (const Seen& seen : seen_) {
      LandmarkGaussian<Real> landmark = seen.landmark;
      update_landmark(landmark, pose, seen.observation, noise_, Everywhere(), evidence);
    }
    return {evidence.log_density(), evidence.left_out()};
  }

  using Innovations = typename MixtureInnovations<Real>::OfBlock;
  /// log p(z | mean of the kernel) (Havangi eq. 16).
  Weighing<Real> at_mean(const PoseGaussian<Real>& kernel, const Innovations& innovations) const {
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const LineOfSight<Real> s = line_of_sight(kernel.mean, seen_[k].landmark.mean);
      innovations.add(k,
                      innovation_of(kernel.covariance, s, residual(seen_[k].observation, s),
                                    seen_[k].landmark.covariance, noise_),
                      Everywhere());
    }
    return at(kernel.mean);
  }

  /// The kernel becomes p(s | s_j, z); returns log p(z | s_j) (EQUATIONS 12).
  Weighing<Real> refine(PoseGaussian<Real>& kernel, const Innovations& innovations) const {
    Evidence<Real> evidence;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      innovations.add(k,
                      refine_pose(kernel, seen_[k].landmark, seen_[k].observation, noise_,
                                  Everywhere(), evidence),
                      Everywhere());
    }
    return {evidence.log_density(), evidence.left_out()};
  }

 private:
  struct Seen {
    LandmarkGaussian<Real> landmark;
    RangeBearing<Real> observation;
  };
  SensorNoise noise_;
  MapMode mode_;
  std::vector<Seen> seen_;
};

}  // namespace montecarta::filters
