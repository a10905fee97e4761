// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/blocked_cholesky.hpp"
#include "filters/joint/map_moments.hpp"
#include "filters/smoothing/segment.hpp"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace montecarta::filters {

/// One linearisation of a factor graph (EQUATIONS 21). Poses are eliminated in segments, each of
/// which knows few landmarks; then the poses between segments, of which all landmarks are given.
/// The newest pose comes last: with the landmarks it is what remains.
class Elimination {
 public:
  explicit Elimination(const SensorNoise& noise) : noise_(noise) {}

  /// Linearises at `estimate`; false where that leaves landmarks undetermined.
  [[nodiscard]] bool linearise(const FactorGraph& graph, const GraphEstimate& estimate);
  /// The least of the last linearisation, which was at `estimate`.
  void minimise(const FactorGraph& graph, const GraphEstimate& estimate, GraphMinimum& minimum);
  /// Its covariance of the newest pose and the map, in the map frame; writes no means.
  void covariance(Eigen::Matrix3d& pose, MapMoments& map) const;
  /// Rows of the landmarks there.
  Eigen::Index map_rows() const { return factor_.rows(); }
  /// The segments of the last linearisation, in order; the newest pose ends the last one.
  std::size_t segments() const { return n_links_; }
  const Segment& segment(std::size_t i) const { return links_[i].segment; }

 private:
  /// A segment, and the pose before it.
  struct Link {
    Segment segment;
    Eigen::Matrix3d covariance;  ///< given the landmarks and what was measured until its end
    Eigen::Vector3d filtered;    ///< the mean likewise, the landmarks where the sum is least
    Eigen::Vector3d smoothed;    ///< by all that was measured
    Eigen::Vector3d adjoint;     ///< of the last pose of the segment
  };

  std::span<Link> links();
  void begin(const FactorGraph& graph);
  void join(Link& link);
  void add_information(const Link& link);
  void flush();
  Eigen::Vector3d at_minimum(const Segment& segment, const Segment::Rows& rows) const;
  Eigen::Vector3d gradient(const Segment& segment, const Eigen::Vector3d& x) const;
  void filter_links();
  void smooth_links();
  void place_landmarks(const FactorGraph& graph, const GraphEstimate& estimate,
                       GraphMinimum& minimum);

  SensorNoise noise_;
  std::vector<Link> links_;  ///< of this linearisation and, behind them, earlier ones
  std::size_t n_links_ = 0;  ///< of this one
  SegmentScratch scratch_;
  Eigen::Index rows_ = 0;         ///< of the landmarks seen so far, in packs
  Eigen::Index height_ = 0;       ///< rows of all landmarks, in packs
  Segment::Rows given_;           ///< of the last pose so far: row 0 g; from 2 on G'
  Eigen::Matrix3d covariance_;    ///< likewise C
  Segment::Rows gradient_;        ///< half of that by the last pose, as given_
  Eigen::MatrixXd information_;   ///< of (1, 0, l): the sum of squares as a form; lower triangle
  Eigen::MatrixXd left_, right_;  ///< columns whose products are not in information_ yet
  Eigen::Index filled_ = 0;       ///< of them
  BlockedCholesky factor_;        ///< of the information of l
  Eigen::VectorXd step_;          ///< of l, where the sum is least
};

}  // namespace montecarta::filters
