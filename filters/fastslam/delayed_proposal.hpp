// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/blocks.hpp"
#include "filters/fastslam/delayed_map.hpp"
#include "filters/fastslam/gaussian_proposal.hpp"
#include "filters/moments/correlated_steps.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace montecarta::filters {

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
class DelayedProposal {
 public:
  using Immediate = GaussianProposal<Real, Linearised, Linearised>;
  using Landmark = LandmarkGaussian<Real>;
  using Refined = typename Immediate::Refined;

  DelayedProposal(std::size_t particles, const Belief& belief, const DrawTimes& times)
      : immediate_(particles, belief, WeightForm::closed, Linearised(), Linearised()),
        times_(times),
        joint_(blocks_for<Real>(particles)),
        scanned_(blocks_for<Real>(particles)),
        predicted_(blocks_for<Real>(particles)) {}

  void start() {
    immediate_.start();
    end_joint();
  }
  void predict(const StepContext& context, const Control& control, double duration,
               std::vector<BasicPose<Real>>& poses) {
    is_predicted_ = false;
    immediate_.predict(context, control, duration, poses);
  }
  PoseGaussian<Real> predicted(std::size_t b, const BasicPose<Real>& pose) const {
    if (!is_joint_) return immediate_.predicted(b, pose);
    if (is_predicted_) return joint_.map().pose(b);
    return predicted_pose(joint_.map().pose(b), immediate_.motion()).pose;
  }
  void begin_scan(const StepContext& context, std::vector<BasicPose<Real>>& poses) {
    if (!is_joint_) return;
    predict_joint(context);
    for (std::size_t b = 0; b < poses.size(); ++b) poses[b] = joint_.map().pose(b).mean;
  }
  const DelayedMap<Real>* joint() const { return is_joint_ ? &joint_ : nullptr; }

  /// Decides whether this scan draws, and takes what it sees into the joint Gaussian.
  template <class Associating>
  void prepare(const StepContext& context, const Associating& association,
               const Weights<Real>& weights, const std::vector<BasicPose<Real>>& poses,
               const std::vector<PoseGaussian<Real>>& predicted, ParticleMaps<Real>& maps) {
    ++scans_;
    draws_ = is_time(weights, predicted);
    if (draws_ && !is_joint_) return;
    if (!is_joint_) begin_joint(context, poses);
    joint_.enter(association.matched_slots(), maps);
    scanned_.clear();
    for (std::size_t k = 0; draws_ && k < association.matches(); ++k) scanned_.add();
  }

  /// The scan updates pose and map together, as in EKF-SLAM; or, where it draws, a copy of the pose
  /// and the landmarks that it shows.
  template <class Associating, class Innovations>
  Refined refine(const StepContext& context, std::size_t b, const PoseGaussian<Real>& predicted,
                 const Associating& association, const Innovations& innovations) {
    if (!is_joint_) return immediate_.refine(context, b, predicted, association, innovations);
    joint_.fill(b);
    if (draws_) joint_.copy_matches(association, b, scanned_);
    CorrelatedMap<Real>& map = draws_ ? scanned_ : joint_.map();
    Evidence<Real> evidence;
    for (std::size_t k = 0; map.size() > 0 && k < association.matches(); ++k) {
      const auto match = association.match(b, k);
      const auto update_at = [&](const auto& at) {
        innovations.add(
            k, update_with(map, b, at, match.seen, immediate_.noise(), match.mask, evidence),
            match.mask);
      };
      draws_ ? update_at(ForAll{k}) : update_at(joint_.where(association, b, k));
    }
    return {predicted, map.pose(b), evidence, evidence.left_out()};
  }

  BasicPose<Real> draw(const StepContext& context, std::size_t b, Refined& refined) {
    if (is_joint_ && !draws_) return refined.posterior.mean;
    return immediate_.draw(context, b, refined);
  }

  /// Where the pose is drawn, the landmarks are those of the joint Gaussian before the scan, given
  /// that pose, and take in the scan from there.
  template <class Associating, class Innovations>
  Weighing<Real> update_map(std::size_t b, const BasicPose<Real>& pose,
                            const Associating& association, Refined& refined,
                            const Innovations& innovations) {
    if (is_joint_ && !draws_) {
      joint_.write_back(b, [](const auto& landmark, const auto&) { return landmark; });
      return {refined.evidence.log_density(), refined.faults};
    }
    if (is_joint_) {
      const KnownPose<Real> known(joint_.map().pose(b), pose);
      joint_.write_back(b, [&](const auto& landmark, const auto& cross) {
        return known.condition(landmark, cross);
      });
      refined.faults += known.faults();
    }
    return immediate_.update_map(b, pose, association, refined, innovations);
  }

  void end_scan() {
    if (!draws_) return;
    immediate_.end_scan();
    end_joint();
  }
  void initialise(const FreshLandmark<Real>& fresh, const BasicPose<Real>& pose,
                  ParticleMaps<Real>& maps) {
    if (!is_joint_) return immediate_.initialise(fresh, pose, maps);
    CorrelatedMap<Real>& map = joint_.map();
    const std::size_t b = fresh.block;
    const NewLandmark<Real> added = new_correlated_landmark(
        map.pose(b), observation_of<Real>(fresh.detection), immediate_.noise());
    fresh.put(added.landmark, maps.blocks_of(fresh.slot)[b]);
    place(map, b, joint_.index_of_added(fresh.slot, maps), added,
          [&](const auto& from, auto& to) { fresh.put(from, to); });
  }
  void begin_step(std::span<const std::uint32_t> parents) {
    if (is_joint_ && !parents.empty()) joint_.map().resample(parents);
    immediate_.begin_step(parents);
  }
  /// Poses that were not drawn are as uncertain as the whole mixture.
  PoseEstimate estimate(const Weights<Real>& weights,
                        const std::vector<BasicPose<Real>>& poses) const {
    if (!is_joint_) return immediate_.estimate(weights, poses);
    for (std::size_t b = 0; b < poses.size(); ++b) predicted_[b] = predicted(b, poses[b]);
    const PoseMoments mixture = mixture_of(weights, predicted_);
    return {mixture, mixture};
  }

 private:
  bool is_time(const Weights<Real>& weights,
               const std::vector<PoseGaussian<Real>>& predicted) const {
    if (times_.every > 0 && scans_ >= times_.every) return true;
    if (std::isinf(times_.beyond)) return false;
    const auto variance = weighted_sums<Real, 1>(
        weights, [&](std::size_t b) { return std::array<Real, 1>{predicted[b].covariance.hh}; });
    return std::sqrt(variance[0]) > times_.beyond;
  }
  /// From here on poses are uncertain within a particle.
  void begin_joint(const StepContext& context, const std::vector<BasicPose<Real>>& poses) {
    is_joint_ = true;
    for (std::size_t b = 0; b < poses.size(); ++b) joint_.map().pose(b) = {poses[b], {}};
    predict_joint(context);
  }
  void end_joint() {
    joint_.clear();
    is_joint_ = false;
    scans_ = 0;
  }
  /// Takes the motion since the last scan into the joint Gaussian.
  void predict_joint(const StepContext& context) {
    BlockTasks<Real>(joint_.map().blocks()).run(context, [&](std::size_t /*task*/, std::size_t b) {
      predict_with_map(joint_.map(), b, immediate_.motion());
    });
    immediate_.motion().restart();
    is_predicted_ = true;
  }

  Immediate immediate_;
  DrawTimes times_;
  DelayedMap<Real> joint_;       ///< pose and the landmarks seen since the draw
  CorrelatedMap<Real> scanned_;  ///< scratch: pose and the landmarks of one scan that draws
  mutable std::vector<PoseGaussian<Real>> predicted_;  ///< scratch of estimate()
  std::size_t scans_ = 0;                              ///< since the draw
  bool is_joint_ = false;      ///< poses are uncertain within a particle, the joint Gaussian holds
  bool is_predicted_ = false;  ///< ... up to now, with no motion since
  bool draws_ = false;         ///< this scan
};

}  // namespace montecarta::filters
