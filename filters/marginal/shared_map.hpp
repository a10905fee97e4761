// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/map_association.hpp"
#include "filters/marginal/marginal_options.hpp"
#include "filters/population/population.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace montecarta::filters {

/// Solves A v = b for a symmetric positive definite A.
inline Point solve(const Symmetric2<double>& A, const Point& b) {
  const double slope = A.xy / A.xx;
  const double y = (b.y - slope * b.x) / (A.yy - slope * A.xy);
  return {(b.x - A.xy * y) / A.xx, y};
}
/// Returns A^-1.
inline Symmetric2<double> inverted(const Symmetric2<double>& A) {
  const Point x = solve(A, {1.0, 0.0}), y = solve(A, {0.0, 1.0});
  return {x.x, x.y, y.y};
}

/// A landmark of the map that all particles share (EQUATIONS 14): its position, and the information
/// about it given the pose.
struct SharedLandmark {
  Point mean;
  Symmetric2<double> information;  ///< Lambda [1/m^2]: information about the position
  bool is_exact = false;           ///< whether the position is known exactly, and never learned

  /// Returns Lambda^-1 [m^2].
  Symmetric2<double> covariance() const {
    return is_exact ? Symmetric2<double>{} : inverted(information);
  }
};

/// All landmarks, in the order of initialisation.
using SharedMap = std::vector<SharedLandmark>;

/// A landmark that a filter is given before the first step (EQUATIONS 23).
inline SharedLandmark given_landmark(const LandmarkEstimate& known) {
  const Point mean{known.mean.x(), known.mean.y()};
  const Eigen::Matrix2d& P = known.covariance;
  if (P.isZero(0.0)) return {mean, {}, true};
  return {mean, inverted(Symmetric2<double>{P(0, 0), P(0, 1), P(1, 1)})};
}

/// Converts to the type in which filters report landmarks.
inline LandmarkEstimate estimate_of(const SharedLandmark& landmark) {
  const Symmetric2<double> P = landmark.covariance();
  return {{landmark.mean.x, landmark.mean.y}, Eigen::Matrix2d{{P.xx, P.xy}, {P.xy, P.yy}}};
}

/// A detection and the landmark that it matched.
struct SharedMatch {
  std::uint32_t landmark;
  RangeBearing<double> seen;
};

/// Associates a scan with the shared map, once for all particles: by identity, or by nearest
/// neighbour for a Gaussian pose (EQUATIONS 17).
class SharedAssociation : public MapAssociation {
 public:
  explicit SharedAssociation(const FilterSetup& setup)
      : MapAssociation(setup), noise_(SensorNoise::of(setup.belief)) {}

  /// Associates by identity.
  void associate(Scan scan);
  /// Associates by nearest neighbour. If `map_is_exact`, the covariance of the map is left out.
  void associate(Scan scan, const SharedMap& map, bool map_is_exact, const PoseMoments& predicted);

  bool matched_nothing() const { return matches_.empty() && fresh_.empty(); }
  const std::vector<SharedMatch>& matches() const { return matches_; }
  /// Detections of new landmarks.
  const std::vector<Detection>& fresh() const { return fresh_; }
  /// Sum of unmatched_log_density() over all detections that match no landmark.
  double unmatched_log_densities() const {
    return unmatched_log_density() * static_cast<double>(unmatched_);
  }

 private:
  void sort_out(Scan scan);

  SensorNoise noise_;
  std::vector<SharedMatch> matches_;
  std::vector<Detection> fresh_;
  std::size_t unmatched_ = 0;
  std::vector<NearestSearch> searches_;  ///< scratch: {detection} searches of a scan
};

/// The likelihood of poses for the matched detections of a scan, with the same map for all.
template <class Real>
class SharedLikelihood {
 public:
  SharedLikelihood(const SensorNoise& noise, MapMode mode) : noise_(noise), mode_(mode) {}

  /// One-step maps are parameters that the likelihood treats as exact (Havangi eq. 28). Recursive
  /// maps add Hf Lambda^-1 Hf' to R (EQUATIONS 14).
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
      Linearised().update(landmark, pose, seen.observation, noise_, AllLanes(), evidence);
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
                      AllLanes());
    }
    return at(kernel.mean);
  }

  /// Replaces the kernel by p(s | s_j, z); returns log p(z | s_j) (EQUATIONS 12).
  Weighing<Real> refine(PoseGaussian<Real>& kernel, const Innovations& innovations) const {
    Evidence<Real> evidence;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      innovations.add(k,
                      Linearised().refine(kernel, seen_[k].landmark, seen_[k].observation, noise_,
                                          AllLanes(), evidence),
                      AllLanes());
    }
    return {evidence.log_density(), evidence.left_out()};
  }

 private:
  struct Seen {
    LandmarkGaussian<Real> landmark;
    Measurement<Real> observation;
  };
  SensorNoise noise_;
  MapMode mode_;
  std::vector<Seen> seen_;
};

}  // namespace montecarta::filters
