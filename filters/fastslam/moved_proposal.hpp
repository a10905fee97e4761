// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/block_tasks.hpp"
#include "filters/fastslam/gaussian_proposal.hpp"
#include "filters/fastslam/pose_window.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace montecarta {

/// GaussianProposal whose particles part again after a resampling (resample-move, Gilks
/// 2001): each proposes its poses of the last scans anew, from where it stood before them and with
/// its map as it was then, and takes them with probability min(1, w'/w), w the product of the
/// scans' weights. A Metropolis-Hastings step with independent proposals: what is distributed as
/// the weights say stays so. Known association. Faults of a replay, taken or not,
/// are counted with the next scan that is weighed; after the last there is none.
template <class Real, class PoseTransform, class MapTransform>
class MovedProposal : public GaussianProposal<Real, PoseTransform, MapTransform> {
 public:
  using Still = GaussianProposal<Real, PoseTransform, MapTransform>;
  using Landmark = typename Still::Landmark;
  /// `lag`: how many scans, at least one.
  MovedProposal(std::size_t particles, const Belief& belief, WeightForm form,
                const PoseTransform& pose_transform, const MapTransform& map_transform,
                std::size_t lag)
      : Still(particles, belief, form, pose_transform, map_transform),
        window_(particles, lag),
        new_poses_(lag * blocks_for<Real>(particles)),
        new_weights_(new_poses_.size()),
        replay_faults_(blocks_for<Real>(particles)) {}

  void start(const std::vector<BasicPose<Real>>& poses) {
    Still::start(poses);
    window_.start(poses);
    std::fill(replay_faults_.begin(), replay_faults_.end(), Real(0.0));
  }

  template <class Matches>
  void prepare(const StepContext& /*context*/, const Matches& matches,
               const Weights<Real>& /*weights*/, const std::vector<BasicPose<Real>>& /*poses*/,
               ParticleMaps<Real, Landmark>& /*maps*/) {
    window_.add(
        this->motion(), matches,
        [&](Landmark& landmark, const BasicPose<Real>& pose, const RangeBearing<Real>& seen) {
          learn(landmark, pose, seen);
        },
        [&](const BasicPose<Real>& pose, const RangeBearing<Real>& seen) {
          return this->map_transform().birth(pose, seen, this->noise());
        });
  }
  template <class Matches, class Note>
  Weighing<Real> weigh_and_draw(const StepContext& context, const Matches& matches, std::size_t b,
                                BasicPose<Real>& pose, const Note& note) {
    Weighing<Real> weighing = Still::weigh_and_draw(context, matches, b, pose, note);
    weighing.faults += std::exchange(replay_faults_[b], Real(0.0));
    window_.newest().poses[b] = pose;
    window_.newest().log_weights[b] = weighing.log_weight;
    return weighing;
  }
  Landmark birth(std::size_t b, const BasicPose<Real>& pose, const RangeBearing<Real>& seen) {
    if (b == 0) window_.newest().fresh.push_back(seen);  // known association: all see the same
    return Still::birth(b, pose, seen);
  }
  void resample(std::span<const std::uint32_t> parents) { window_.resample(parents); }

  void part(const StepContext& context, ParticleMaps<Real, Landmark>& maps,
            std::vector<BasicPose<Real>>& poses) {
    open(maps);
    BlockTasks<Real>(poses.size()).run(context, [&](std::size_t /*task*/, std::size_t b) {
      const Real log_ratio = propose_anew(context, b);
      const auto identity = [&](Draw purpose) {
        return context.identity(purpose, static_cast<std::uint32_t>(b * kLanesOf<Real>));
      };
      const Real u = uniform_pairs(identity(Draw::move_acceptance), 0, Real()).first;
      for (std::size_t lane = 0; lane < kLanesOf<Real>; ++lane) {
        const bool taken = std::log(get(u, lane)) < get(log_ratio, lane);
        if (taken) take(b, lane, poses);
      }
    });
  }

 private:
  /// The matches of a past scan, with the landmarks of a replay.
  struct Replay {
    const PastScan<Real>& scan;
    std::span<Landmark> scratch;
    std::size_t blocks;

    std::size_t matches() const { return scan.slots.size(); }
    template <class Visit>
    void read(std::size_t b, const Visit& visit) const {
      for (std::size_t k = 0; k < scan.slots.size(); ++k) {
        visit(k, scratch[scan.rows[k] * blocks + b], scan.seen[k], Everywhere());
      }
    }
    template <class Visit>
    void update(std::size_t b, const Visit& visit) const {
      read(b, visit);
    }
  };

  void learn(Landmark& landmark, const BasicPose<Real>& pose,
             const RangeBearing<Real>& seen) const {
    Unweighed<Real> nobody;
    this->map_transform().update(landmark, pose, seen, this->noise(), Everywhere(), nobody);
  }

  /// Lists the landmarks of the window, and opens them in the maps of now and of then.
  void open(ParticleMaps<Real, Landmark>& maps) {
    std::size_t born = window_.maps().slots();
    first_born_ = born;
    touched_.clear();
    for (std::size_t k = 0; k < window_.size(); ++k) {
      for (const std::uint32_t slot : window_[k].slots) {
        if (slot < first_born_ && row_of(slot) == touched_.size()) touched_.push_back(slot);
      }
      born += window_[k].fresh.size();
    }
    window_.maps().open(touched_, then_);
    for (std::size_t slot = first_born_; slot < born; ++slot) {
      touched_.push_back(static_cast<std::uint32_t>(slot));
    }
    maps.open(touched_, now_);
    for (std::size_t k = 0; k < window_.size(); ++k) {
      window_[k].rows.clear();
      for (const std::uint32_t slot : window_[k].slots) window_[k].rows.push_back(row_of(slot));
    }
    const std::size_t wanted = touched_.size() * maps.blocks();
    if (scratch_.size() < wanted) scratch_.resize(wanted);
  }
  std::size_t row_of(std::uint32_t slot) const {
    return static_cast<std::size_t>(std::find(touched_.begin(), touched_.end(), slot) -
                                    touched_.begin());
  }

  /// Draws the window of block b once more; returns log(w'/w).
  Real propose_anew(const StepContext& context, std::size_t b) {
    const std::size_t blocks = window_.origin().size();
    for (std::size_t row = 0; row < touched_.size(); ++row) {
      now_[row].fetch(b);
      if (row < then_.size()) scratch_[row * blocks + b] = then_[row].fetch(b);
    }
    std::size_t row = then_.size();
    BasicPose<Real> pose = window_.origin()[b];
    Real log_ratio(0.0);
    for (std::size_t k = 0; k < window_.size(); ++k) {
      const PastScan<Real>& scan = window_[k];
      const Weighing<Real> weighing = this->propose(
          context.identity(Draw::pose_move, static_cast<std::uint32_t>(b * kLanesOf<Real>)),
          static_cast<std::uint32_t>(k), scan.motion.from(pose), Replay{scan, scratch_, blocks}, b,
          pose, [](auto&&...) {});
      log_ratio += weighing.log_weight - scan.log_weights[b];
      replay_faults_[b] += weighing.faults;
      new_poses_[k * blocks + b] = pose;
      new_weights_[k * blocks + b] = weighing.log_weight;
      for (const RangeBearing<Real>& seen : scan.fresh) {
        scratch_[row++ * blocks + b] = Still::birth(b, pose, seen);
      }
    }
    return log_ratio;
  }

  void take(std::size_t b, std::size_t lane, std::vector<BasicPose<Real>>& poses) {
    const std::size_t blocks = window_.origin().size();
    for (std::size_t k = 0; k < window_.size(); ++k) {
      copy_lane<Real>(new_poses_[k * blocks + b], window_[k].poses[b], lane);
      copy_lane<Real>(new_weights_[k * blocks + b], window_[k].log_weights[b], lane);
    }
    if (window_.size() > 0) copy_lane<Real>(window_.newest().poses[b], poses[b], lane);
    for (std::size_t row = 0; row < touched_.size(); ++row) {
      copy_lane<Real>(scratch_[row * blocks + b], now_[row].at(b), lane);
    }
  }

  using OpenSlot = typename ParticleMaps<Real, Landmark>::OpenSlot;
  PoseWindow<Real, Landmark> window_;
  std::size_t first_born_ = 0;          ///< first slot that was born in the window
  std::vector<std::uint32_t> touched_;  ///< {row} slots seen in the window, those born in it last
  std::vector<OpenSlot> then_, now_;    ///< {row} before the window, and now
  std::vector<Landmark> scratch_;       ///< {row, block} maps of the replay
  std::vector<BasicPose<Real>> new_poses_;  ///< {scan, block}
  std::vector<Real> new_weights_;           ///< {scan, block}
  std::vector<Real> replay_faults_;         ///< {block} since the last scan that was weighed
};

}  // namespace montecarta
