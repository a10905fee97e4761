// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/waiting_landmarks.hpp"
#include "filters/joint/compressed_gaussian.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace montecarta::filters {

/// Initialises landmarks that one detection does not fix from two (EQUATIONS 15). What a waiting
/// landmark was seen by is kept in the Gaussian as points of the map: the place of the sensor and,
/// of a bearing, a point on the ray; so it stays correlated with pose and map, and every detection
/// is used once.
class DelayedInitialisation {
 public:
  explicit DelayedInitialisation(const Belief& belief);
  void clear();

  /// Points of the Gaussian that are kept for a landmark, to make near.
  void add_points_of(std::int32_t identity, std::vector<std::uint32_t>& slots) const;
  /// Whether this detection can take its landmark a step further. The points are near.
  bool can_advance(const CompressedGaussian& gaussian, const Detection& detection);
  /// Takes it that step, where can_advance(). Returns the point that now is the landmark, if any.
  /// The points of other landmarks may be far then.
  std::optional<std::uint32_t> advance(CompressedGaussian& gaussian, const Detection& detection);

 private:
  struct Kept {
    std::size_t points = 0;                            ///< of two
    std::uint32_t first = 0, second = 0;               ///< points of the Gaussian
    Eigen::Vector2d ranges = Eigen::Vector2d::Zero();  ///< [m] of the first two detections
  };
  using Waiting = WaitingLandmarks<Kept>::Waiting;

  /// A detection beside what is kept of its landmark.
  struct Pair {
    const DelayedInitialisation& by;
    const CompressedGaussian& gaussian;
    const Kept& kept;
    const Detection& detection;

    std::optional<TriangulatedLandmark> landmark(double side) const;
    bool cross_well() const;
    bool cross() const { return landmark(1.0).has_value(); }
    double squared_distance(double side) const;
  };

  NewPoint sensor_point(const Pose& pose) const;
  NewPoint ray_point(const Pose& pose, double bearing) const;
  std::uint32_t add(CompressedGaussian& gaussian, const NewPoint& point);
  void keep(CompressedGaussian& gaussian, Kept& kept, const Detection& detection);
  std::uint32_t finish(CompressedGaussian& gaussian, Waiting& waiting, const Detection& detection);

  Belief belief_;
  double variance_;  ///< of the one component
  WaitingLandmarks<Kept> waiting_;
  std::vector<std::uint32_t> free_;  ///< points of the Gaussian that nothing is kept in any more
};

}  // namespace montecarta::filters
