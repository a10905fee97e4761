// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/evolution/differential_evolution.hpp"
#include "filters/fastslam/pose_fitness.hpp"
#include "filters/population/cloud_moments.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::filters {

/// Evolves the cloud of predicted poses as one population (Ankishan 3.2, Fig. 1): member i is
/// particle i, and what moves there is judged by particle i's own map. Components are those along,
/// across and about the cloud's mean heading, so that a turned world evolves alike.
template <class Real>
class CloudEvolution {
 public:
  /// What fitness asks for.
  enum class Aim { likelihood, posterior };

  /// Looks at where the particles are and what each takes the detections for.
  template <class Associating>
  void gather(const Associating& association, const Weights<Real>& weights,
              const std::vector<PoseGaussian<Real>>& predicted, const SensorNoise& noise) {
    moments_ = mixture_of(weights, predicted);
    frame_ = direction_of(moments_.mean.heading);
    population_.resize(weights.particles());
    fitness_.clear(), matched_.clear();
    for (std::size_t b = 0; b < predicted.size(); ++b) {
      association.fetch(b);
      append_matched(association, b, matched_);
      fitness_.emplace_back(predicted[b], noise);
      const std::array<Real, 3> members = block_of_members(predicted[b].mean);
      for (std::size_t i = b * kLanes; i < end_of(b); ++i)
        for (std::size_t j = 0; j < 3; ++j) population_[i][j] = get(members[j], i % kLanes);
    }
  }

  /// Evolves within `bounds` standard deviations of the cloud; `poses` are where the particles end.
  void evolve(Aim aim, double bounds, const EvolutionSettings& settings,
              const StreamIdentity& identity, std::vector<BasicPose<Real>>& poses) {
    const auto judge = [&](Members members, std::span<double> fitness) {
      for (std::size_t b = 0; b < fitness_.size(); ++b) {
        const Real fit = fitness_of_block(aim, b, block_of_poses(members, b));
        for (std::size_t i = b * kLanes; i < end_of(b); ++i) fitness[i] = get(fit, i % kLanes);
      }
    };
    filters::evolve<double, 3>(population_, box(bounds), settings, EvolutionDraws{identity},
                               scratch_, judge);
    for (std::size_t b = 0; b < poses.size(); ++b) poses[b] = block_of_poses(population_, b);
  }

 private:
  static constexpr std::size_t kLanes = kLanesOf<Real>;
  using Members = std::span<const std::array<double, 3>>;

  /// Behind the last particle of block b.
  std::size_t end_of(std::size_t b) const { return std::min((b + 1) * kLanes, population_.size()); }

  Real fitness_of_block(Aim aim, std::size_t b, const BasicPose<Real>& pose) const {
    const std::size_t scan_size = matched_.size() / fitness_.size();
    const auto scan = std::span(matched_).subspan(b * scan_size, scan_size);
    return aim == Aim::likelihood ? fitness_[b].likelihood(pose, scan)
                                  : fitness_[b].posterior(pose, scan);
  }

  std::array<Real, 3> block_of_members(const BasicPose<Real>& pose) const {
    const Real x = pose.x - moments_.mean.x, y = pose.y - moments_.mean.y;
    return {frame_.cosine * x + frame_.sine * y, frame_.cosine * y - frame_.sine * x,
            wrap(Real(pose.heading - moments_.mean.heading))};
  }
  /// Of the particles of block b; lanes without one stand on the mean.
  BasicPose<Real> block_of_poses(Members members, std::size_t b) const {
    std::array<Real, 3> m{Real(0.0), Real(0.0), Real(0.0)};
    for (std::size_t i = b * kLanes; i < end_of(b); ++i)
      for (std::size_t j = 0; j < 3; ++j) set(m[j], i % kLanes, members[i][j]);
    return {moments_.mean.x + frame_.cosine * m[0] - frame_.sine * m[1],
            moments_.mean.y + frame_.sine * m[0] + frame_.cosine * m[1],
            wrap(Real(moments_.mean.heading + m[2]))};
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

  PoseMoments moments_;
  Direction<double> frame_{1.0, 0.0};
  std::vector<MatchedDetection<Real>> matched_;  ///< {block, detection}
  std::vector<PoseFitness<Real>> fitness_;       ///< of each block's particles
  std::vector<std::array<double, 3>> population_;
  EvolutionScratch<double, 3> scratch_;
};

}  // namespace montecarta::filters
