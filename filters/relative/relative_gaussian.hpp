// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "filters/moments/believed_sensor.hpp"
#include "filters/moments/motion_increment.hpp"
#include "filters/relative/relative_conditioning.hpp"

#include <Eigen/Core>

#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace montecarta::filters {

/// One Gaussian over the displacements along a chain of frames and the landmarks in these frames
/// (EQUATIONS 22). It does not depend on the pose of the start in the map.
class RelativeGaussian {
 public:
  /// A detection of a landmark.
  struct Seen {
    std::size_t landmark;
    Eigen::Vector2d observed;  ///< components of the detection
  };

  explicit RelativeGaussian(const BelievedSensor& sensor) : sensor_(sensor) {}

  void start(const Pose& start);
  void move(const MotionIncrement& motion);
  /// Conditions on all detections together; landmarks too near for a derivative are left out.
  RelativeOutcome see(std::span<const Seen> scan, int iterations);
  /// Returns whether the vehicle is exactly at the newest frame.
  bool is_at_newest_frame() const;
  /// Makes the pose of the vehicle the newest frame.
  void add_frame();
  /// Drops the frame without landmarks that costs least; false if all frames have landmarks.
  bool drop_empty_frame();
  /// Adds a landmark, in the newest frame.
  void add_landmark(const Eigen::Vector2d& observed);
  /// Initialises a landmark a second time, without use of its first coordinates.
  void add_duplicate(const Seen& seen);
  /// Conditions on the equality of both positions of all landmarks that were initialised again.
  /// Returns false if that fails; nothing is changed then.
  [[nodiscard]] bool condition_on_equality(int iterations);
  /// Conditions on this equality, and drops the second coordinates or, if it failed, the first
  /// ones.
  [[nodiscard]] bool merge_duplicates(int iterations);

  const RelativeChain& chain() const { return chain_; }
  const Eigen::VectorXd& mean() const { return mean_; }
  const Eigen::MatrixXd& covariance() const { return P_; }
  /// The point of a landmark to which detections belong.
  const RelativeChain::Point& point(std::size_t landmark) const;
  bool has_duplicates() const;
  /// Writes {frame} [m] how far uncertain headings bend the path to each frame (EQUATIONS (22.4)).
  void bends(std::vector<double>& bends) const;
  using Expect =
      std::function<void(std::size_t landmark, const Eigen::Vector2d& expected,
                         const Eigen::Matrix2d& covariance)>;  ///< covariance of the innovation
  /// Calls `expect` for all landmarks except those too near for a derivative.
  void expect_all(const Expect& expect) const;

 private:
  /// Memory that is reused between calls. A copy begins with its own.
  struct Scratch {
    Scratch() = default;
    Scratch(const Scratch& /*other*/) {}
    Scratch& operator=(const Scratch& /*other*/) { return *this; }

    std::vector<Seen> used;
    std::vector<std::pair<RelativeChain::Point, RelativeChain::Point>> twice;
    std::vector<char> is_empty, is_kept;
    std::vector<Eigen::Index> kept, now;
    ConditioningScratch conditioning;
  };

  bool linearise(std::span<const Seen> scan, const Eigen::VectorXd& mean,
                 const VehicleInFrames& vehicle, LinearisedPairs& pairs) const;
  void expect_one(std::size_t landmark, const VehicleGaussian& vehicle, const Expect& expect) const;
  RelativeChain::Point add_point(const Eigen::Vector2d& observed);
  Eigen::Index add_rows(Eigen::Index count);
  void drop_frame(std::size_t frame);
  void keep_rows();

  BelievedSensor sensor_;
  RelativeChain chain_;
  Eigen::Index rows_ = 0;  ///< number of used rows; the others are zero
  Eigen::VectorXd mean_;
  Eigen::MatrixXd P_;
  Scratch scratch_;
};

}  // namespace montecarta::filters
