// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/compressed_gaussian.hpp"
#include "filters/models/triangulation.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace montecarta::filters {

/// Initialises landmarks that one detection does not fix from two (EQUATIONS 15). What a waiting
/// landmark was seen by is kept in the Gaussian as points of the map: the place of the sensor and,
/// of a bearing, a point on the ray; so it stays correlated with pose and map, and every detection
/// is used once. A detection that only decides (whether the lines of sight cross well, on which
/// side of two places) is not used otherwise: what is chosen by its noise must not be estimated
/// from it.
class DelayedInitialisation {
 public:
  explicit DelayedInitialisation(const Belief& belief);
  void clear();

  /// Points of the Gaussian that are kept for a landmark, to make near.
  void add_points_of(std::int32_t identity, std::vector<std::uint32_t>& slots) const;
  /// Whether this detection can take its landmark a step further. The points are near.
  bool advances(const CompressedGaussian& gaussian, const Detection& detection);
  /// Takes it that step, where advances(). Returns the point that now is the landmark, if any. The
  /// points of other landmarks may be far then.
  std::optional<std::uint32_t> advance(CompressedGaussian& gaussian, const Detection& detection);

 private:
  /// What is known of a landmark.
  enum class Stage : std::uint8_t {
    unseen,
    seen,       ///< by a first detection
    crossing,   ///< and a second one would cross it well: the next is used
    ambiguous,  ///< two ranges: two places
  };
  struct Waiting {
    std::int32_t identity = 0;
    Stage stage = Stage::unseen;
    std::uint32_t first = 0, second = 0;               ///< points of the Gaussian
    Eigen::Vector2d ranges = Eigen::Vector2d::Zero();  ///< [m] of the first two detections
    double side = 1.0;                                 ///< of the two places
  };

  bool is_bearing() const { return components_of(belief_.sensor)[0] == Quantity::bearing; }
  const Waiting* find(std::int32_t identity) const;
  Waiting& entry(std::int32_t identity);
  NewPoint sensor_point(const Pose& pose) const;
  NewPoint ray_point(const Pose& pose, double bearing) const;
  std::optional<TriangulatedLandmark> triangulated(const CompressedGaussian& gaussian,
                                                   const Waiting& waiting,
                                                   const Detection& detection, double side) const;
  bool crosses_well(const CompressedGaussian& gaussian, const Waiting& waiting,
                    const Detection& detection) const;
  std::optional<double> decided_side(const CompressedGaussian& gaussian, const Waiting& waiting,
                                     const Detection& detection) const;
  double squared_distance(const CompressedGaussian& gaussian, const Waiting& waiting,
                          const Detection& detection, double side) const;
  std::uint32_t add(CompressedGaussian& gaussian, const NewPoint& point);
  std::uint32_t finish(CompressedGaussian& gaussian, Waiting& waiting, const Detection& detection);

  Belief belief_;
  double variance_;                  ///< of the one component
  std::vector<Waiting> waiting_;     ///< in no order
  std::vector<std::uint32_t> free_;  ///< points of the Gaussian that nothing is kept in any more
};

}  // namespace montecarta::filters
