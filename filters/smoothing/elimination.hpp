// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/map_moments.hpp"
#include "filters/joint/products.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/smoothing/factor_graph.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::filters {

/// Where a linearisation of the graph has its least sum of squares, in the coordinates of a
/// GraphEstimate.
struct GraphMinimum {
  std::vector<Pose> displacements;           ///< {pose}
  std::vector<Eigen::Vector3d> multipliers;  ///< {pose}
  std::vector<Point> in_frame;               ///< {landmark} [m]
  double squares = 0.0;                      ///< the sum there, as linearised
};

/// What all segments use, one after the other.
struct SegmentScratch {
  std::vector<Eigen::Index> row_of_landmark;  ///< {landmark} in the segment; 0: not yet seen there
  Eigen::MatrixXd panel;                      ///< rows of the linearised observations, transposed
  Eigen::MatrixXd information;  ///< of (1, pose before, landmarks): the sum of squares as a form
};

/// Some poses in a row, linearised and eliminated one after the other (EQUATIONS 21). A pose is
/// kept in the form x = g + G (x_before, l) + N(0, C), given the pose before the segment and the
/// landmarks l that it sees: a motion adds to C, an observation adds two rows to the information of
/// x_before and l. So a motion may be certain in some direction or all, and a pose known exactly.
class Segment {
 public:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3>;
  static constexpr Eigen::Index kPoseRow = 1;      ///< of x_before; row 0 is the constant's
  static constexpr Eigen::Index kLandmarkRow = 8;  ///< of the first landmark

  /// Of the poses from `begin` on, before `end`; scratch.information is of this segment then, its
  /// lower triangle.
  void linearise(const FactorGraph& graph, const GraphEstimate& estimate, std::size_t begin,
                 std::size_t end, const SensorNoise& noise, SegmentScratch& scratch);
  std::size_t last_pose() const { return end_ - 1; }
  /// That it sees, in the order of their rows.
  std::span<const std::uint32_t> landmarks() const { return landmarks_; }
  /// {row, 3} of the last pose: row 0 g, then G'.
  const Rows& given() const { return given_; }
  /// Of the last pose, given the pose before and the landmarks.
  const Eigen::Matrix3d& covariance() const { return covariance_; }
  /// {row, 3} of the information, the columns of x_before.
  const Rows& on_pose() const { return on_pose_; }

  /// The steps of the landmarks, x_before and the adjoint of the last pose known: returns the sum
  /// of squares of the segment, and writes its displacements.
  double minimise(const FactorGraph& graph, const GraphEstimate& estimate,
                  const Eigen::VectorXd& landmark_steps, const Eigen::Vector3d& before,
                  const Eigen::Vector3d& adjoint, GraphMinimum& minimum);
  /// Of pose `pose`, which is one of the segment: its step, that of the pose before it being `x`
  /// and `noise` what its displacement has more than its mean, in the map frame.
  void advance(std::size_t pose, const Eigen::Vector3d& noise, Eigen::Vector3d& x) const;

 private:
  /// A motion: x = x_before + way e_heading of x_before + offset + noise, in the map frame.
  struct LinearMotion {
    Eigen::Vector2d way;     ///< [m/rad]
    Eigen::Vector3d offset;  ///< of the mean from the estimate
  };
  /// An observation in units of its innovation's standard deviations, given the landmarks.
  struct LinearObservation {
    Matrix23 pose;
    Eigen::Matrix2d landmark;
    Eigen::Vector2d residual;
    Matrix32 gain;
    Eigen::Vector2d innovation;  ///< with the landmarks where the sum is least
  };

  void start(const FactorGraph& graph, SegmentScratch& scratch);
  void carry(const MotionIncrement& motion, const Pose& before, const Pose& after,
             const Direction<double>& heading);
  void condition(const FactorGraph::Observation& observation, const Pose& pose,
                 const Point& landmark, const SensorNoise& noise, SegmentScratch& scratch);
  void add_rows(const LinearObservation& seen, Eigen::Index row, SegmentScratch& scratch);
  double filter_poses(const FactorGraph& graph, const Eigen::VectorXd& landmark_steps,
                      Eigen::Vector3d x);
  void smooth_poses(const FactorGraph& graph, const GraphEstimate& estimate,
                    Eigen::Vector3d adjoint, GraphMinimum& minimum) const;

  std::size_t begin_ = 0;  ///< first pose
  std::size_t end_ = 0;    ///< behind the last
  std::vector<std::uint32_t> landmarks_;
  std::vector<LinearMotion> motions_;
  std::vector<LinearObservation> observations_;
  Rows given_;
  Eigen::Matrix3d covariance_;
  Rows on_pose_;
};

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
