// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/block_tasks.hpp"
#include "filters/fastslam/delayed_map.hpp"
#include "filters/fastslam/gaussian_proposal.hpp"
#include "filters/moments/correlated_birth.hpp"
#include "filters/moments/correlated_draw.hpp"
#include "filters/moments/correlated_motion.hpp"
#include "filters/moments/correlated_sight.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta {

/// When a delayed filter draws its poses.
struct DrawTimes {
  std::size_t every = 10;  ///< scans that see something; 0 = never for their number
  double beyond = std::numeric_limits<double>::infinity();  ///< [rad] heading uncertain by more
};

/// FastSLAM II that draws the pose only now and then (EQUATIONS 11). In between a particle
/// is a joint Gaussian over its pose and the landmarks seen since the draw, updated as EKF-SLAM is;
/// all others are independent of the pose, given where it was drawn. Where every scan draws, this
/// is GaussianProposal; where none does, every particle is EKF-SLAM.
template <class Real>
class DelayedProposal : public GaussianProposal<Real, Linearised, Linearised> {
 public:
  using Immediate = GaussianProposal<Real, Linearised, Linearised>;
  DelayedProposal(std::size_t particles, const Belief& belief, const DrawTimes& times)
      : Immediate(particles, belief, WeightForm::closed, Linearised(), Linearised()),
        times_(times),
        joint_(blocks_for<Real>(particles)),
        refined_(blocks_for<Real>(particles)),
        predicted_(blocks_for<Real>(particles)) {}

  void start(const std::vector<BasicPose<Real>>& poses) {
    Immediate::start(poses);
    joint_.clear();
    is_open_ = false;
    scans_ = 0;
  }
  PoseGaussian<Real> predicted(std::size_t b, const BasicPose<Real>& pose) const {
    if (!is_open_) return Immediate::predicted(b, pose);
    return driven(joint_.map().pose(b), this->motion()).pose;
  }
  void begin_scan(const StepContext& context, std::vector<BasicPose<Real>>& poses) {
    if (is_open_) drive_on(context, poses);
  }
  Innovation<Real> expected(std::size_t b, std::uint32_t slot, const PoseGaussian<Real>& pose,
                            const LandmarkGaussian<Real>& landmark,
                            const Sightline<Real>& s) const {
    if (!is_open_ || !joint_.holds(slot)) {
      return Immediate::expected(b, slot, pose, landmark, s);
    }
    return correlated_innovation(pose.covariance, landmark.covariance,
                                 joint_.map().pose_cross(joint_.index_of(slot), b),
                                 SightRows<Real>(s), RangeBearing<Real>{}, this->noise());
  }

  /// Decides whether this scan draws, and takes what it sees into the joint Gaussian.
  template <class Matches>
  void prepare(const StepContext& context, const Matches& matches, const Weights<Real>& weights,
               const std::vector<BasicPose<Real>>& poses, ParticleMaps<Real>& maps) {
    ++scans_;
    draws_ = is_time(weights, poses);
    if (draws_ && !is_open_) return;
    if (!is_open_) open(context, poses);
    joint_.enter_matches(matches, maps);
    refined_.clear();
    for (std::size_t k = 0; draws_ && k < matches.matches(); ++k) refined_.add();
  }

  template <class Matches, class Note>
  Weighing<Real> weigh_and_draw(const StepContext& context, const Matches& matches, std::size_t b,
                                BasicPose<Real>& pose, const Note& note) {
    if (!is_open_) return Immediate::weigh_and_draw(context, matches, b, pose, note);
    joint_.fill(matches, b);
    return draws_ ? draw(context, matches, b, pose, note) : absorb_scan(matches, b, pose, note);
  }

  LandmarkGaussian<Real> birth(std::size_t b, const BasicPose<Real>& pose,
                               const RangeBearing<Real>& seen) {
    if (!is_open_) return Immediate::birth(b, pose, seen);
    newborn_ = new_correlated_landmark(joint_.map().pose(b), seen, this->noise());
    return newborn_.landmark;
  }
  template <class Put>
  void settled(ParticleMaps<Real>& maps, std::size_t b, std::uint32_t slot, const Put& put) {
    if (is_open_) place(joint_.map(), b, joint_.enter(slot, maps), newborn_, put);
  }
  void resample(std::span<const std::uint32_t> parents) {
    if (is_open_) joint_.map().resample(parents);
  }
  void end_scan() {
    if (!draws_) return;
    Immediate::end_scan();
    joint_.clear();
    is_open_ = false;
    scans_ = 0;
  }
  /// Poses that were not drawn are as uncertain as the whole mixture.
  PoseEstimate estimate(const Weights<Real>& weights,
                        const std::vector<BasicPose<Real>>& poses) const {
    if (!is_open_) return Immediate::estimate(weights, poses);
    for (std::size_t b = 0; b < poses.size(); ++b) predicted_[b] = predicted(b, poses[b]);
    const PoseMoments mixture = mixture_of(weights, predicted_);
    return {mixture, mixture};
  }

 private:
  bool is_time(const Weights<Real>& weights, const std::vector<BasicPose<Real>>& poses) const {
    if (times_.every > 0 && scans_ >= times_.every) return true;
    if (std::isinf(times_.beyond)) return false;
    const auto variance = weighted_sums<Real, 1>(weights, [&](std::size_t b) {
      return std::array<Real, 1>{predicted(b, poses[b]).covariance.hh};
    });
    return std::sqrt(variance[0]) > times_.beyond;
  }
  /// From here on poses are uncertain within a particle.
  void open(const StepContext& context, const std::vector<BasicPose<Real>>& poses) {
    is_open_ = true;
    BlockTasks<Real>(poses.size()).run(context, [&](std::size_t /*task*/, std::size_t b) {
      joint_.map().pose(b) = {poses[b], {}};
      drive(joint_.map(), b, this->motion());
    });
    this->motion().restart();
  }
  void drive_on(const StepContext& context, std::vector<BasicPose<Real>>& poses) {
    BlockTasks<Real>(poses.size()).run(context, [&](std::size_t /*task*/, std::size_t b) {
      drive(joint_.map(), b, this->motion());
      poses[b] = joint_.map().pose(b).mean;
    });
    this->motion().restart();
  }

  /// The scan updates pose and map together, as in EKF-SLAM; nothing is drawn.
  template <class Matches, class Note>
  Weighing<Real> absorb_scan(const Matches& matches, std::size_t b, BasicPose<Real>& pose,
                             const Note& note) {
    Evidence<Real> evidence;
    matches.read(b, [&](std::size_t k, const auto&, const auto& seen, const auto& mask) {
      if (joint_.map().size() == 0) return;
      note(
          k,
          absorb(joint_.map(), b, joint_.where(matches, b, k), seen, this->noise(), mask, evidence),
          mask);
    });
    pose = joint_.map().pose(b).mean;
    joint_.write_back(b, [](const auto& landmark, const auto&) { return landmark; });
    return {evidence.log_density(), evidence.left_out()};
  }

  /// The pose is drawn from what the joint Gaussian and the scan say of it; then the landmarks are
  /// those of the Gaussian before the scan, given that pose, and take in the scan from there.
  template <class Matches, class Note>
  Weighing<Real> draw(const StepContext& context, const Matches& matches, std::size_t b,
                      BasicPose<Real>& pose, const Note& note) {
    Evidence<Real> evidence;
    joint_.copy_matches(matches, b, refined_);
    matches.read(b, [&](std::size_t k, const auto&, const auto& seen, const auto& mask) {
      note(k, absorb(refined_, b, ForAll{k}, seen, this->noise(), mask, evidence), mask);
    });
    const PoseFactor<Real> factor(refined_.pose(b));
    pose = draw_from(factor, context.identity(Draw::pose_proposal,
                                              static_cast<std::uint32_t>(b * kLanesOf<Real>)));
    const KnownPose<Real> known(joint_.map().pose(b), pose);
    joint_.write_back(b, [&](const auto& landmark, const auto& cross) {
      return known.condition(landmark, cross);
    });
    Unweighed<Real> unweighed;
    this->update_landmarks(matches, b, pose, unweighed);
    this->keep(b, refined_.pose(b));
    return {evidence.log_density(), evidence.left_out() + factor.L.faults + known.faults()};
  }

  DrawTimes times_;
  DelayedMap<Real> joint_;       ///< pose and the landmarks seen since the draw
  CorrelatedMap<Real> refined_;  ///< scratch: pose and the landmarks of one scan that draws
  mutable std::vector<PoseGaussian<Real>> predicted_;  ///< scratch of estimate()
  NewLandmark<Real> newborn_;
  std::size_t scans_ = 0;  ///< since the draw
  bool is_open_ = false;   ///< poses are uncertain within a particle, the joint Gaussian holds
  bool draws_ = false;     ///< this scan
};

}  // namespace montecarta
