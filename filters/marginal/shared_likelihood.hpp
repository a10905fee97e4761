// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/random/normals.hpp"
#include "filters/fastslam/innovation_sums.hpp"
#include "filters/marginal/marginal_options.hpp"
#include "filters/marginal/shared_association.hpp"
#include "filters/moments/linearised.hpp"

#include <cstddef>
#include <vector>

namespace montecarta {

/// How well poses explain the matched detections of a scan, the map being the same for all.
template <class Real>
class SharedLikelihood {
 public:
  SharedLikelihood(const SensorNoise& noise, MapMode mode) : noise_(noise), mode_(mode) {}

  /// One-step maps are parameters, known exactly as far as the likelihood goes (Havangi eq. 28);
  /// recursive ones add Hf Lambda^-1 Hf' to R (SPEC 15.3).
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
      update_landmark(landmark, pose, seen.sight, noise_, Everywhere(), evidence);
    }
    return {evidence.log_density(), evidence.left_out()};
  }

  /// log p(z | mean of the kernel) (Havangi eq. 16); notes what block `b` of weight w predicted.
  Weighing<Real> at_mean(const PoseGaussian<Real>& kernel, std::size_t b, const Real& weight,
                         InnovationSums<Real>& innovations) const {
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      const Sightline<Real> s = sightline(kernel.mean, seen_[k].landmark.mean);
      innovations.add(b, k,
                      innovation_of(kernel.covariance, s, residual(seen_[k].sight, s.predicted),
                                    seen_[k].landmark.covariance, noise_),
                      weight);
    }
    return at(kernel.mean);
  }

  /// The kernel becomes p(s | s_j, z); returns log p(z | s_j) (SPEC 14.2).
  Weighing<Real> refine(PoseGaussian<Real>& kernel, std::size_t b, const Real& weight,
                        InnovationSums<Real>& innovations) const {
    Evidence<Real> evidence;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      innovations.add(
          b, k,
          refine_pose(kernel, seen_[k].landmark, seen_[k].sight, noise_, Everywhere(), evidence),
          weight);
    }
    return {evidence.log_density(), evidence.left_out()};
  }

 private:
  struct Seen {
    LandmarkGaussian<Real> landmark;
    RangeBearing<Real> sight;
  };
  SensorNoise noise_;
  MapMode mode_;
  std::vector<Seen> seen_;
};

/// A pose drawn from a Gaussian by the numbers of the stream; the factor is that in the frame of
/// the vehicle, so that a turned world gives a turned draw.
template <class Real>
BasicPose<Real> drawn_from(const PoseGaussian<Real>& gaussian, const StreamIdentity& identity) {
  const auto [e0, e1] = normal_pairs<Real>(identity, 0);
  const Real e2 = normal_pairs<Real>(identity, 1).first;
  const Direction<Real> ahead = direction_of(gaussian.mean.heading);
  const Cholesky3<Real> L(turned(gaussian.covariance, {ahead.cosine, -ahead.sine}));
  const Real x = L.xx * e0, y = L.yx * e0 + L.yy * e1;
  return {gaussian.mean.x + ahead.cosine * x - ahead.sine * y,
          gaussian.mean.y + ahead.sine * x + ahead.cosine * y,
          wrap(Real(gaussian.mean.heading + L.hx * e0 + L.hy * e1 + L.hh * e2))};
}

}  // namespace montecarta
