// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/joint/joint_gaussian.hpp"

#include <Eigen/Core>

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// Represents columns over the points of a map by a few orthonormal vectors: columns = vectors
/// coefficients, up to rounding.
class Basis {
 public:
  /// Computes the basis of `columns`, which are overwritten. For the right-invariant error the
  /// basis is closed under a quarter turn of every point: vectors come in pairs q and J q, and the
  /// pair of coefficients of a column turns like the points of the column.
  void span(Eigen::MatrixXd& columns, Retraction retraction);
  void clear() { size_ = 0; }

  /// Number of vectors, which is even and at most two for every column.
  Eigen::Index size() const { return size_; }
  auto vectors() const { return vectors_.leftCols(size_); }
  auto coefficients() const { return coefficients_.topRows(size_); }

 private:
  Eigen::MatrixXd vectors_, coefficients_;
  Eigen::Index size_ = 0;
};

/// A JointGaussian in which a detection costs as much as the landmarks near the vehicle require,
/// however large the map: the compressed filter of Guivant and Nebot (EQUATIONS (15.7)), exact for
/// every error. All landmarks are near in a small map, and for a while if compression does not pay
/// off.
///
/// Far landmarks change only through their covariances C with the pose and the near landmarks. As
/// long as the same landmarks are near, every change of the far ones lies in the span W of C: their
/// mean is m + W z, their covariance P + W Y W', and that with pose and near landmarks W X. The
/// updates of z, X and Y are those of an unobserved point in a JointGaussian. So they are stored in
/// it as additional points, stand-ins for the far landmarks, which begin with z = 0, Y = 0, W X =
/// C. For the right-invariant error, W is closed under a quarter turn, and coefficients turn in
/// pairs. For the left-invariant error all landmarks stay near, since every detection turns P.
class CompressedGaussian {
 public:
  using ObservationStatus = JointGaussian::ObservationStatus;

  CompressedGaussian(const Belief& belief, Retraction retraction, std::size_t room);

  void start(const Pose& start, const Eigen::Matrix3d& covariance = Eigen::Matrix3d::Zero());

  /// Replaces the moments of the pose and of all landmarks, in the order of their slots.
  void replace(const PoseMoments& pose, const MapMoments& map);

  const PoseMoments& pose() const { return near_.pose(); }
  LinearisedMotion linearised(const MotionIncrement& motion) const {
    return near_.linearised(motion);
  }
  LinearisedMotion regressed(const MotionIncrement& motion) const {
    return near_.regressed(motion);
  }
  PoseMoments pose_after(const auto& motion) const { return near_.pose_after(motion); }
  void move(const LinearisedMotion& motion) { near_.move(motion); }
  void move(const MotionIncrement& motion) { near_.move(motion); }

  std::size_t landmarks() const { return point_of_.size(); }
  LandmarkEstimate landmark(std::size_t slot) const;
  Eigen::Vector2d mean_of(std::size_t slot) const;
  PointMoments point(std::size_t slot) const;
  /// Moments of the whole map, landmarks in the order of their slots.
  MapMoments map() const;
  /// Moments of the pose and all landmarks, in the same order.
  JointEstimate joint() const;
  bool is_near(std::size_t slot) const { return point_of_[slot] != kFar; }

  /// Bounds on the change of a far landmark since it became far, per unit of its `Far::share`.
  struct Drift {
    double mean;      ///< [m] bound on the change of the mean
    double variance;  ///< [m^2] bound on the change of the variance
  };
  Drift drift() const;
  /// Returns whether no detection up to `range` [m] from the pose can lie within `sigmas` standard
  /// deviations of a far landmark. This is cheaper than predict_observation().
  bool is_out_of_reach(std::size_t slot, const Drift& drift, double range, double sigmas) const;
  [[nodiscard]] ObservationStatus predict_observation(
      std::size_t slot, ExpectedObservation& expected,
      const std::optional<ObservationPoint>& at = {}) const;
  [[nodiscard]] ObservationStatus predict_by_sigma_points(std::size_t slot,
                                                          ExpectedObservation& expected) const {
    return near_.predict_by_sigma_points(point(slot), expected);
  }

  /// Makes the given landmarks near, with others around the vehicle, unless they are near already.
  void make_near(std::span<const std::uint32_t> slots);
  /// Does what JointGaussian::update_with() does, for a landmark that is near.
  ObservationStatus update_with(std::size_t slot, const Eigen::Vector2d& detected, int iterations,
                                ExpectedObservation& expected) {
    assert(is_near(slot));
    ++updates_;
    return near_.update_with(point_of_[slot], detected, iterations, expected);
  }
  /// Does what JointGaussian::update_with_fix() does.
  [[nodiscard]] ObservationStatus update_with_fix(const PositionFix& fix, double sigma,
                                                  double& log_density) {
    ++updates_;
    return near_.update_with_fix(fix, sigma, log_density);
  }
  /// Does what JointGaussian::centre_on_pose() does, and makes all landmarks near.
  void centre_on_pose();
  void append(const Eigen::Vector2d& detection,
              const Eigen::Vector2d& behind = Eigen::Vector2d::Zero());
  /// These functions do what those of JointGaussian do, for points that are near.
  void append(NewPoint point);
  void replace(std::size_t slot, NewPoint point);
  Matrix7 covariance_with(std::size_t first, std::size_t second) const;

 private:
  using Columns2 = Eigen::Matrix<double, Eigen::Dynamic, 2>;

  static constexpr std::uint32_t kFar = std::numeric_limits<std::uint32_t>::max();

  /// A landmark at the time when the near ones were chosen.
  struct Far {
    double share = 0.0;     ///< norm of its rows of the basis
    double variance = 0.0;  ///< [m^2] trace of its covariance
  };

  void make_all_near();
  void use_near_slots(NewPoint& point) const;
  Eigen::Index rows() const { return packed(landmarks()); }
  auto coefficients_of_mean() const { return near_.map().mean.segment(stand_ins_, basis_.size()); }
  auto coefficients_of_cross() const {
    return near_.map().cross.middleRows(stand_ins_, basis_.size());
  }
  auto coefficients_of_covariance() const {
    return near_.map()
        .covariance.block(stand_ins_, stand_ins_, basis_.size(), basis_.size())
        .selfadjointView<Eigen::Lower>();
  }
  PointMoments far_point(std::size_t slot) const;
  bool is_time_to_choose() const;
  void choose(std::span<const std::uint32_t> wanted);
  void update_balance();
  void choose_around(std::span<const std::uint32_t> wanted);
  void expand_into(MapMoments& map) const;
  void write_far(MapMoments& map) const;
  void write_near(MapMoments& map) const;
  void write_cross_with_far(Eigen::Index at, Columns2& column) const;
  void gather_near();
  void span_far();
  void use_landmark_stand_ins();
  void note_far();

  JointGaussian near_;  ///< pose, near landmarks, stand-ins, and landmarks initialised later
  Retraction retraction_;
  std::vector<std::uint32_t> point_of_;  ///< {slot} point of the landmark in near_, or kFar
  std::size_t most_near_;                ///< number of points beyond which to choose again
  std::size_t updates_ = 0;              ///< number of detections since the near ones were chosen
  double balance_ = 0.0;  ///< work saved by compression, in units of detections of the whole map
  bool is_suspended_ = false;   ///< all landmarks are near, since compression does not pay off
  Eigen::Index stand_ins_ = 0;  ///< first row of the stand-ins in near_
  Basis basis_;                 ///< W, over the rows of whole_
  MapMoments whole_;            ///< moments of far landmarks when the near ones were chosen
  std::vector<Far> far_;        ///< {slot} landmarks when the near ones were chosen
  Eigen::MatrixXd columns_;  ///< scratch: C, each column divided by its standard deviation sigma_
  Eigen::VectorXd sigma_;    ///< scratch: standard deviations of the columns
  MapMoments gathered_;      ///< scratch: the near landmarks
  std::vector<std::pair<double, std::uint32_t>> by_distance_;  ///< scratch: [m^2], slot
  std::vector<std::uint32_t> chosen_;                          ///< scratch: slots
};

}  // namespace montecarta::filters
