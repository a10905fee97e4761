// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/particles/blocks.hpp"
#include "filters/moments/gaussians.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// Covariance of a landmark's coordinates with the pose.
template <class Real>
struct PoseCross {
  Column3<Real> x, y;
};

/// Covariance of one landmark's coordinates (rows) with another's (columns).
template <class Real>
struct MapCross {
  Real xx{}, xy{}, yx{}, yy{};
};

/// Covariance of a number with the two components of an innovation, made independent of each other
/// and divided by their standard deviations.
template <class Real>
struct WhiteGain {
  Real first, second;
};

/// The white gains of a landmark.
template <class Real>
struct MapGain {
  WhiteGain<Real> x, y;
};

/// Moves a landmark's mean by `step` and takes `less` from its covariance.
template <class Real>
void change(LandmarkGaussian<Real>& landmark, const BasicPoint<Real>& step,
            const Symmetric2<Real>& less) {
  landmark.mean = landmark.mean + step;
  landmark.covariance = landmark.covariance - less;
}

/// Which landmark of a correlated map is meant: the same for every particle of a block ...
struct ForAll {
  std::size_t index;
};
/// ... or one for each.
template <class Real>
struct ForEach {
  std::array<std::uint32_t, kLanesOf<Real>> index;
};

/// A joint Gaussian over pose and landmarks for every particle, block by block: what a particle
/// keeps that did not draw its pose. Landmarks are numbered from 0 in the order in which they come;
/// covariances of two are kept once, the later one's rows. Keeps its memory from run to run.
template <class Real>
class CorrelatedMap {
 public:
  using Landmark = LandmarkGaussian<Real>;
  explicit CorrelatedMap(std::size_t blocks)
      : n_blocks_(blocks), poses_(blocks), spare_poses_(blocks) {}

  /// Forgets the landmarks.
  void clear() { size_ = 0; }
  std::size_t size() const { return size_; }
  std::size_t blocks() const { return n_blocks_; }

  PoseGaussian<Real>& pose(std::size_t b) { return poses_[b]; }
  const PoseGaussian<Real>& pose(std::size_t b) const { return poses_[b]; }
  Landmark& landmark(std::size_t i, std::size_t b) { return landmarks_[i * n_blocks_ + b]; }
  const Landmark& landmark(std::size_t i, std::size_t b) const {
    return landmarks_[i * n_blocks_ + b];
  }
  PoseCross<Real>& pose_cross(std::size_t i, std::size_t b) {
    return pose_crosses_[i * n_blocks_ + b];
  }
  const PoseCross<Real>& pose_cross(std::size_t i, std::size_t b) const {
    return pose_crosses_[i * n_blocks_ + b];
  }
  /// Of landmark i with the earlier landmark j < i.
  MapCross<Real>& map_cross(std::size_t i, std::size_t j, std::size_t b) {
    return map_crosses_[(i * (i - 1) / 2 + j) * n_blocks_ + b];
  }
  const MapCross<Real>& map_cross(std::size_t i, std::size_t j, std::size_t b) const {
    return map_crosses_[(i * (i - 1) / 2 + j) * n_blocks_ + b];
  }
  /// Scratch of one absorption.
  MapGain<Real>& gain(std::size_t i, std::size_t b) { return gains_[i * n_blocks_ + b]; }
  /// Of any landmark with any, itself included.
  MapCross<Real> covariance(std::size_t i, std::size_t j, std::size_t b) const {
    if (i > j) return map_cross(i, j, b);
    if (i < j) {
      const MapCross<Real>& c = map_cross(j, i, b);
      return {c.xx, c.yx, c.xy, c.yy};
    }
    const Symmetric2<Real>& P = landmark(i, b).covariance;
    return {P.xx, P.xy, P.xy, P.yy};
  }

  const Landmark& landmark(ForAll at, std::size_t b) const { return landmark(at.index, b); }
  const PoseCross<Real>& pose_cross(ForAll at, std::size_t b) const {
    return pose_cross(at.index, b);
  }
  MapCross<Real> covariance(std::size_t i, ForAll at, std::size_t b) const {
    return covariance(i, at.index, b);
  }
  Landmark landmark(const ForEach<Real>& at, std::size_t b) const {
    return by_lane(at, [&](std::size_t j) { return landmark(j, b); });
  }
  PoseCross<Real> pose_cross(const ForEach<Real>& at, std::size_t b) const {
    return by_lane(at, [&](std::size_t j) { return pose_cross(j, b); });
  }
  MapCross<Real> covariance(std::size_t i, const ForEach<Real>& at, std::size_t b) const {
    return by_lane(at, [&](std::size_t j) { return covariance(i, j, b); });
  }
  MapCross<Real> covariance(ForAll of, ForAll with, std::size_t b) const {
    return covariance(of.index, with.index, b);
  }
  MapCross<Real> covariance(const ForEach<Real>& of, const ForEach<Real>& with,
                            std::size_t b) const {
    return by_lane(of, [&](std::size_t i) { return covariance(i, with, b); });
  }

  /// Adds a landmark that nothing is known of and that is independent of all else; returns its
  /// number.
  std::size_t add() {
    append(landmarks_, spare_landmarks_, size_, 1);
    append(pose_crosses_, spare_pose_crosses_, size_, 1);
    gains_.resize(landmarks_.size());
    if (size_ > 0) append(map_crosses_, spare_map_crosses_, pairs(), size_);
    return size_++;
  }

  /// Particle i becomes a copy of particle parents[i].
  void resample(std::span<const std::uint32_t> parents) {
    gather<Real>(poses_, parents, spare_poses_);
    std::swap(poses_, spare_poses_);
    rearrange(landmarks_, size_, parents, spare_landmarks_);
    rearrange(pose_crosses_, size_, parents, spare_pose_crosses_);
    rearrange(map_crosses_, pairs(), parents, spare_map_crosses_);
  }

 private:
  template <class Pick>
  static auto by_lane(const ForEach<Real>& at, const Pick& pick) {
    auto picked = pick(at.index[0]);
    for (std::size_t lane = 1; lane < kLanesOf<Real>; ++lane) {
      if (at.index[lane] != at.index[0]) copy_lane<Real>(pick(at.index[lane]), picked, lane);
    }
    return picked;
  }

  std::size_t pairs() const { return size_ > 0 ? size_ * (size_ - 1) / 2 : 0; }

  /// `count` columns of zeros behind `kept` of them.
  template <class Block>
  void append(std::vector<Block>& columns, std::vector<Block>& spare, std::size_t kept,
              std::size_t count) const {
    const std::size_t first = kept * n_blocks_, last = first + count * n_blocks_;
    if (columns.size() < last) columns.resize(last), spare.resize(last);
    std::fill(columns.begin() + static_cast<std::ptrdiff_t>(first),
              columns.begin() + static_cast<std::ptrdiff_t>(last), Block{});
  }
  template <class Block>
  void rearrange(std::vector<Block>& columns, std::size_t count,
                 std::span<const std::uint32_t> parents, std::vector<Block>& spare) const {
    for (std::size_t k = 0; k < count; ++k) {
      const std::span<const Block> from = std::span(columns).subspan(k * n_blocks_, n_blocks_);
      for (std::size_t b = 0; b < n_blocks_; ++b) {
        spare[k * n_blocks_ + b] = gather_block<Real, Block>(from, parents, b);
      }
    }
    std::swap(columns, spare);
  }

  std::size_t n_blocks_;
  std::size_t size_ = 0;
  std::vector<PoseGaussian<Real>> poses_, spare_poses_;
  std::vector<Landmark> landmarks_, spare_landmarks_;               ///< {landmark, block}
  std::vector<PoseCross<Real>> pose_crosses_, spare_pose_crosses_;  ///< {landmark, block}
  std::vector<MapCross<Real>> map_crosses_, spare_map_crosses_;     ///< {pair, block}
  std::vector<MapGain<Real>> gains_;                                ///< {landmark, block}
};

}  // namespace montecarta::filters
