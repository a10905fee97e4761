// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/evolution/differential_evolution.hpp"
#include "filters/fastslam/pose_fitness.hpp"
#include "filters/moments/anchored_landmark.hpp"
#include "filters/moments/cloud_moments.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta {

/// Evolves the cloud of predicted poses as one population (Ankishan 3.2, Fig. 1): member i is
/// particle i, and what moves there is judged by particle i's own map. Components are those along,
/// across and about the cloud's mean heading, so that a turned world evolves alike.
template <class Real>
class CloudEvolution {
 public:
  /// What fitness asks for.
  enum class Aim { likelihood, posterior };

  /// Looks at where the particles are and what each takes the detections for.
  template <class Matches>
  void gather(const Matches& matches, const Weights<Real>& weights,
              const std::vector<PoseGaussian<Real>>& predicted, const SensorNoise& noise) {
    particles_ = weights.particles();
    sightings_.assign(particles_ * matches.matches(), {});
    scan_size_ = matches.matches();
    fitness_.clear();
    moments_ = mixture_of(weights, predicted);
    frame_ = direction_of(moments_.mean.heading);
    for (std::size_t b = 0; b < predicted.size(); ++b) {
      matches.read(b, [&](std::size_t k, const auto& landmark, const auto& seen, const auto& mask) {
        note(b, k, as_gaussian(landmark), seen, as_number<Real>(mask));
      });
    }
    population_.resize(particles_);
    for (std::size_t i = 0; i < particles_; ++i) {
      const PoseGaussian<double> own = of_lane(predicted[i / kLanes], i % kLanes);
      fitness_.emplace_back(own, noise);
      population_[i] = member(own.mean);
    }
  }

  /// Evolves within `bounds` standard deviations of the cloud; `poses` are where the particles end.
  void evolve(Aim aim, double bounds, const EvolutionSettings& settings,
              const StreamIdentity& identity, std::vector<BasicPose<Real>>& poses) {
    const auto objective = [&](std::size_t i, const std::array<double, 3>& candidate) {
      const std::span<const Sighting<double>> scan =
          std::span(sightings_).subspan(i * scan_size_, scan_size_);
      return aim == Aim::likelihood ? fitness_[i].likelihood(pose(candidate), scan)
                                    : fitness_[i].posterior(pose(candidate), scan);
    };
    montecarta::evolve<double, 3>(population_, box(bounds), settings, EvolutionDraws{identity},
                                  scratch_, objective);
    for (std::size_t i = 0; i < particles_; ++i) {
      const Pose moved = pose(population_[i]);
      BasicPose<Real>& block = poses[i / kLanes];
      set(block.x, i % kLanes, moved.x), set(block.y, i % kLanes, moved.y);
      set(block.heading, i % kLanes, moved.heading);
    }
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;

  void note(std::size_t b, std::size_t k, const LandmarkGaussian<Real>& landmark,
            const RangeBearing<Real>& seen, const Real& matched) {
    for (std::size_t lane = 0; lane < kLanes && b * kLanes + lane < particles_; ++lane) {
      const Symmetric2<Real>& P = landmark.covariance;
      sightings_[(b * kLanes + lane) * scan_size_ + k] = {
          {{get(landmark.mean.x, lane), get(landmark.mean.y, lane)},
           {get(P.xx, lane), get(P.xy, lane), get(P.yy, lane)}},
          {get(seen.range, lane), get(seen.bearing, lane)},
          get(matched, lane)};
    }
  }

  std::array<double, 3> member(const Pose& pose) const {
    const double x = pose.x - moments_.mean.x, y = pose.y - moments_.mean.y;
    return {frame_.cosine * x + frame_.sine * y, frame_.cosine * y - frame_.sine * x,
            wrap(pose.heading - moments_.mean.heading)};
  }
  Pose pose(const std::array<double, 3>& member) const {
    return {moments_.mean.x + frame_.cosine * member[0] - frame_.sine * member[1],
            moments_.mean.y + frame_.sine * member[0] + frame_.cosine * member[1],
            wrap(moments_.mean.heading + member[2])};
  }

  /// mean +- bounds standard deviations, and no member outside.
  SearchBox<double, 3> box(double bounds) const {
    const Symmetric3<double> P =
        turned(symmetric_of(moments_.covariance), Direction<double>{frame_.cosine, -frame_.sine});
    SearchBox<double, 3> box{
        {0.0, 0.0, 0.0},
        {bounds * std::sqrt(std::max(P.xx, 0.0)), bounds * std::sqrt(std::max(P.yy, 0.0)),
         bounds * std::sqrt(std::max(P.hh, 0.0))},
        {false, false, true}};
    for (const auto& one : population_) {
      for (std::size_t j = 0; j < 3; ++j) box.half[j] = std::max(box.half[j], std::abs(one[j]));
    }
    box.half[2] = std::min(box.half[2], kPi);
    return box;
  }

  std::size_t particles_ = 0, scan_size_ = 0;
  PoseMoments moments_;
  Direction<double> frame_{1.0, 0.0};
  std::vector<Sighting<double>> sightings_;   ///< {particle, detection}
  std::vector<PoseFitness<double>> fitness_;  ///< of each particle
  std::vector<std::array<double, 3>> population_;
  EvolutionScratch<double, 3> scratch_;
};

}  // namespace montecarta
