// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/association/waiting_landmarks.hpp"
#include "filters/joint/compressed_gaussian.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace montecarta::filters {

/// Initialises landmarks that one detection does not fix from two detections (EQUATIONS 15). The
/// first detections of a waiting landmark are kept in the Gaussian as points of the map: the
/// position of the sensor and, for a bearing, a point on the ray. They remain correlated with pose
/// and map, and every detection is used only once.
class DelayedInitialisation {
 public:
  explicit DelayedInitialisation(const Belief& belief);
  void clear();

  /// Adds the points of the Gaussian that are kept for a landmark, for the caller to make near.
  void add_points_of(std::int32_t identity, std::vector<std::uint32_t>& slots) const;
  /// Returns whether this detection advances its landmark by one stage. Kept points must be near.
  bool can_advance(const CompressedGaussian& gaussian, const Detection& detection);
  /// Advances the landmark by one stage, if can_advance(). Returns the point that is now the
  /// landmark, if any. Afterwards the points of other landmarks may be far.
  std::optional<std::uint32_t> advance(CompressedGaussian& gaussian, const Detection& detection);

 private:
  struct Kept {
    std::size_t points = 0;                            ///< number of kept points, at most two
    std::uint32_t first = 0, second = 0;               ///< points of the Gaussian
    Eigen::Vector2d ranges = Eigen::Vector2d::Zero();  ///< [m] the first two detected ranges
  };
  using Waiting = WaitingLandmarks<Kept>::Waiting;

  /// A detection together with the kept points of its landmark.
  struct DetectionPair {
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
  double variance_;  ///< variance of the one component
  WaitingLandmarks<Kept> waiting_;
  std::vector<std::uint32_t> free_;  ///< points of the Gaussian that can be reused
};

}  // namespace montecarta::filters
