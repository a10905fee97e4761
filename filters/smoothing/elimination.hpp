// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/map_moments.hpp"
#include "filters/joint/products.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/moments/believed_sensor.hpp"
#include "filters/smoothing/factor_graph.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace montecarta::filters {

/// The point at which derivatives by the states of a prior are taken: the estimate, or the estimate
/// when the prior first contained the state (EQUATIONS 25).
enum class Jacobians { latest, first };

/// The points at which the measurements of a graph are linearised.
class LinearisationPlaces {
 public:
  LinearisationPlaces(Jacobians jacobians, const FactorGraph& graph, const GraphEstimate& estimate)
      : first_(jacobians == Jacobians::first && graph.has_prior() ? &graph.prior() : nullptr),
        estimate_(estimate) {}

  /// Returns whether they may differ from the estimate.
  bool differ() const { return first_ != nullptr; }
  /// With a prior, the first pose is its start.
  const Pose& pose(std::size_t t) const {
    return differ() && t == 0 ? first_->start : estimate_.poses[t];
  }
  /// The pose before pose `t`.
  const Pose& before(std::size_t t) const {
    if (t > 0) return pose(t - 1);
    return differ() ? first_->start : estimate_.start;
  }
  const Point& landmark(std::size_t l) const {
    return differ() && l < first_->first.size() ? first_->first[l] : estimate_.landmarks[l];
  }

 private:
  const GraphPrior* first_;  ///< null if all are the estimate
  const GraphEstimate& estimate_;
};

/// The minimum of the linearised sum of squares of a graph, in the coordinates of a GraphEstimate.
struct GraphMinimum {
  Eigen::Vector3d start_step;  ///< way from the estimate of the start to the minimum
  Eigen::Vector3d start_multiplier;
  std::vector<Pose> displacements;           ///< {pose} displacements at the minimum
  std::vector<Eigen::Vector3d> multipliers;  ///< {pose} multipliers at the minimum
  std::vector<Point> in_frame;               ///< {landmark} [m] positions at the minimum
  std::vector<Point> in_map;                 ///< {landmark} [m] those of a prior, in the map
  double squares = 0.0;                      ///< value of the linearised sum
};

/// Memory that all segments share, one after the other.
struct SegmentScratch {
  /// {landmark} its row in the segment; 0: not yet observed.
  std::vector<Eigen::Index> row_of_landmark;
  Eigen::MatrixXd panel;        ///< rows of the linearised observations, transposed
  Eigen::MatrixXd information;  ///< quadratic form of (1, pose before, landmarks)
};

/// A motion in the map frame: x = x_before + way e_heading of x_before + offset + noise (EQUATIONS
/// (21.2)).
struct LinearMotion {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  Eigen::Vector2d way;     ///< [m/rad] derivative of the position by the heading before
  Eigen::Vector3d offset;  ///< mean minus estimate
  Eigen::Matrix3d noise;   ///< covariance that it adds

  /// The motion to pose `t`.
  static LinearMotion of(const FactorGraph& graph, const GraphEstimate& estimate,
                         const LinearisationPlaces& places, std::size_t t);
  /// Moves the form {row, 3} and the covariance of a pose, given others, with it.
  void carry(Rows& given, Eigen::Matrix3d& covariance) const;
};

/// Some consecutive poses, linearised and eliminated one after the other (EQUATIONS 21). A pose has
/// the form x = g + G (x_before, l) + N(0, C), given the pose before the segment and the landmarks
/// l that it observes. A motion adds to C, and an observation adds two rows to the information of
/// x_before and l. So a motion may be certain in some or all directions, and a pose known exactly.
class Segment {
 public:
  using Rows = LinearMotion::Rows;
  static constexpr Eigen::Index kPoseRow = 1;      ///< row of x_before; row 0: the constant
  static constexpr Eigen::Index kLandmarkRow = 8;  ///< row of the first landmark

  /// Linearises the poses from `begin` to before `end`. Afterwards scratch.information is that of
  /// this segment, in its lower triangle.
  void linearise(const FactorGraph& graph, const GraphEstimate& estimate,
                 const LinearisationPlaces& places, std::size_t begin, std::size_t end,
                 const BelievedSensor& sensor, SegmentScratch& scratch);
  std::size_t last_pose() const { return end_ - 1; }
  /// The landmarks that it observes, in the order of their rows.
  std::span<const std::uint32_t> landmarks() const { return landmarks_; }
  /// {row, 3} form of the last pose: row 0 is g, the others are G'.
  const Rows& given() const { return given_; }
  /// Covariance of the last pose, given the pose before and the landmarks.
  const Eigen::Matrix3d& covariance() const { return covariance_; }
  /// {row, 3} columns of x_before in the information.
  const Rows& on_pose() const { return on_pose_; }

  /// Computes the displacements of the poses, given the steps of the landmarks, x_before and the
  /// adjoint of the last pose. Returns the sum of squares of the segment.
  double minimise(const FactorGraph& graph, const GraphEstimate& estimate,
                  const Eigen::VectorXd& landmark_steps, const Eigen::Vector3d& before,
                  const Eigen::Vector3d& adjoint, GraphMinimum& minimum);
  /// Computes the step `x` of pose `pose`, which must be one of the segment, from that of the pose
  /// before it. `noise` is the deviation of its displacement from the mean, in the map frame.
  void advance(std::size_t pose, const Eigen::Vector3d& noise, Eigen::Vector3d& x) const;

 private:
  /// An observation in units of the standard deviations of its innovation, given the landmarks.
  struct LinearObservation {
    Matrix23 pose;
    Eigen::Matrix2d landmark;
    Eigen::Vector2d residual;
    Matrix32 gain;
    Eigen::Vector2d innovation;  ///< innovation with the landmarks at the minimum
  };

  void start(const FactorGraph& graph, SegmentScratch& scratch);
  void condition(const FactorGraph::Observation& observation,
                 const std::optional<LinearisedDetection>& at, const BelievedSensor& sensor,
                 SegmentScratch& scratch);
  void add_rows(const LinearObservation& seen, Eigen::Index row, SegmentScratch& scratch);
  double filter_poses(const FactorGraph& graph, const Eigen::VectorXd& landmark_steps,
                      Eigen::Vector3d x);
  void smooth_poses(const FactorGraph& graph, const GraphEstimate& estimate,
                    Eigen::Vector3d adjoint, GraphMinimum& minimum) const;

  std::size_t begin_ = 0;  ///< index of the first pose
  std::size_t end_ = 0;    ///< index after the last pose
  std::vector<std::uint32_t> landmarks_;
  std::vector<LinearMotion> motions_;
  std::vector<LinearObservation> observations_;
  Rows given_;
  Eigen::Matrix3d covariance_;
  Rows on_pose_;
};

/// One linearisation of a factor graph (EQUATIONS 21). Poses are eliminated in segments, each of
/// which involves few landmarks, then the poses between segments, given all landmarks. The newest
/// pose is last and remains together with the landmarks. The graph may begin with a prior.
class Elimination {
 public:
  explicit Elimination(const BelievedSensor& sensor, Jacobians jacobians = Jacobians::latest)
      : sensor_(sensor), jacobians_(jacobians) {}

  /// Linearises at `estimate`; returns false if landmarks are not determined.
  [[nodiscard]] bool linearise(const FactorGraph& graph, const GraphEstimate& estimate);
  /// Computes the minimum of the last linearisation, which was at `estimate`.
  void minimise(const FactorGraph& graph, const GraphEstimate& estimate, GraphMinimum& minimum);
  /// Marginalises the first pose, linearised at `estimate` with its motion, its observations and
  /// the motion to the second pose: `prior` becomes the prior for a graph without it (EQUATIONS
  /// 25). The last linearisation is lost.
  void marginalise_first_pose(const FactorGraph& graph, const GraphEstimate& estimate,
                              GraphPrior& prior);
  /// Computes the covariance of the newest pose and the map in the map frame; writes no means.
  void covariance(Eigen::Matrix3d& pose, MapMoments& map) const;
  /// Number of rows of the landmarks in that covariance.
  Eigen::Index map_rows() const { return factor_.rows(); }
  /// The segments of the last linearisation, in order. The last one ends with the newest pose.
  std::size_t segments() const { return n_links_; }
  const Segment& segment(std::size_t i) const { return links_[i].segment; }

 private:
  /// A segment and the pose before it.
  struct Link {
    Segment segment;
    /// Covariance of the pose before the segment, given the landmarks and all measurements until
    /// the end of the segment.
    Eigen::Matrix3d covariance;
    /// Mean of that pose by the same measurements, with the landmarks at the minimum.
    Eigen::Vector3d filtered;
    Eigen::Vector3d smoothed;  ///< mean of that pose by all measurements
    Eigen::Vector3d adjoint;   ///< adjoint of the last pose of the segment
  };

  std::span<Link> links();
  void begin(const FactorGraph& graph, const GraphEstimate& estimate);
  void begin_at(const GraphPrior& prior, const GraphEstimate& estimate);
  void join(Link& link);
  void add_information(const Link& link);
  void flush();
  Eigen::Vector3d at_minimum(const Segment& segment, const Segment::Rows& rows) const;
  Eigen::Vector3d gradient(const Segment& segment, const Eigen::Vector3d& x) const;
  void filter_links();
  Eigen::Vector3d smooth_links();
  void place_landmarks(const FactorGraph& graph, const GraphEstimate& estimate,
                       GraphMinimum& minimum);

  BelievedSensor sensor_;
  Jacobians jacobians_;
  std::vector<Link> links_;  ///< links of this linearisation, then unused ones
  std::size_t n_links_ = 0;  ///< number of links of this linearisation
  SegmentScratch scratch_;
  Eigen::Index rows_ = 0;         ///< number of rows of the landmarks so far, in packs
  Eigen::Index height_ = 0;       ///< number of rows of all landmarks, in packs
  Segment::Rows start_;           ///< form of the start, with rows like given_
  Segment::Rows given_;           ///< form of the last pose so far: row 0 is g, from row 2 on G'
  Eigen::Matrix3d covariance_;    ///< C: covariance of the last pose so far
  Segment::Rows gradient_;        ///< half the gradient by the last pose, with rows like given_
  Eigen::MatrixXd information_;   ///< quadratic form of (1, 0, l); lower triangle
  Eigen::MatrixXd left_, right_;  ///< columns; their products are not yet in information_
  Eigen::Index filled_ = 0;       ///< number of those columns
  BlockedCholesky factor_;        ///< factor of the information of l
  Eigen::VectorXd step_;          ///< step of l to the minimum
};

}  // namespace montecarta::filters
