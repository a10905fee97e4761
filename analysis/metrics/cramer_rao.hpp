// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/spread.hpp"
#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"
#include "engine/records/result_file.hpp"
#include "filters/models/field_of_view.hpp"
#include "filters/models/range_bearing.hpp"
#include "filters/models/sensor.hpp"
#include "filters/models/vehicle.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

/// The true vehicle, sensor and noise of a simulation, which filters may believe to be different.
struct SimulatedWorld {
  Vehicle vehicle;
  ControlNoise control_noise;
  Eigen::Vector2d sigma_observation;  ///< of the sensor's components (deviations_of())
  double detected = 1.0;              ///< probability that a landmark in view is detected
  FieldOfView view;
  bool same_path = true;  ///< of all runs: the noise is on the controls that filters are given
  Sensor sensor = {};
};

/// The simulated world, read from the attributes of /scenario; nullopt if the file is not of a
/// simulation or lacks an attribute.
std::optional<SimulatedWorld> simulated_world_of(const ResultFile& file);

/// The Cramer-Rao bound on pose and landmarks together, as a covariance that is propagated along a
/// known path: the recursion of a Kalman filter with all Jacobians at the truth. A landmark is
/// unknown before its first observation; if one detection does not fix it, its standard deviation
/// is a kilometre. The pose is known exactly at the start.
class JointBound {
 public:
  /// Room for all `landmarks`; nothing is allocated later. `control_noise`: of the vehicle,
  /// `observation_variance`: of the components of the sensor.
  JointBound(std::size_t landmarks, const Vehicle& vehicle, const ControlNoise& control_noise,
             const Eigen::Vector2d& observation_variance, const Sensor& sensor = {});

  /// One control step from the true `pose`; returns the pose after it.
  Pose move(const Pose& pose, const Control& control, double duration);
  /// A scan from the true `pose` that detects `landmarks`, true positions with their identities.
  /// False if the noise is too small for the computation; the bound is unusable then.
  struct Seen {
    std::size_t identity = 0;
    Point point;
  };
  [[nodiscard]] bool scan(const Pose& pose, std::span<const Seen> landmarks);

  const Eigen::Matrix3d& pose() const { return pose_; }
  /// [m^2] Mean squared position error over the landmarks that the detections locate; NaN if there
  /// are none.
  double mean_map_variance() const;

 private:
  void finish_motion();
  [[nodiscard]] bool correct(const Pose& pose, std::span<const Seen> landmarks);
  void append(const Pose& pose, const Seen& landmark);
  void append_unknown(const Seen& landmark);
  Eigen::VectorXd column(Eigen::Index j) const;
  Eigen::Index& row_of(std::size_t identity) { return row_[identity]; }

  Vehicle vehicle_;
  ControlNoise control_noise_;
  Eigen::Vector2d observation_variance_;
  Sensor sensor_;
  Eigen::Matrix3d pose_ = Eigen::Matrix3d::Zero();  ///< symmetric
  double pending_x_heading_ = 0.0;                  ///< [m/rad] of Fx since the last scan
  double pending_y_heading_ = 0.0;                  ///< [m/rad]
  Eigen::MatrixXd joint_;                           ///< lower triangle; its pose block is in pose_
  Eigen::Index size_ = 3;                           ///< rows in use
  std::vector<Eigen::Index> row_;                   ///< of each landmark; 0: never seen
};

/// Number of runs in the average if every run has a path of its own.
inline constexpr std::size_t kBoundRuns = 16;

/// The least root mean square error, just after each scan, of any estimator without bias that knows
/// which landmark is which. Empty if it cannot be computed. If every run has a path of its own
/// (is_bound is false), it is no bound but the covariance that a linearised filter with Jacobians
/// at the truth reports (STATISTICS 11).
struct CramerRaoBound {
  std::vector<double> position;  ///< [m] {scan}
  std::vector<double> heading;   ///< [rad] {scan}
  double map = kNaN;             ///< [m] at the end, RMS over the landmarks
                                 ///< that came into view; NaN: none did
  std::size_t runs = 0;          ///< number of averaged paths; 1 where all runs share one path
  bool is_bound = true;          ///< false: a linearised reference
  std::string missing;           ///< why there is none

  bool empty() const { return position.empty(); }
  bool operator==(const CramerRaoBound&) const = default;
};

/// A true path as rows of poses, with the rows at which the scans are.
struct TruePath {
  Pose start;
  std::vector<Pose> rows;
  std::vector<std::size_t> steps;          ///< control steps from the row before, >= 1
  std::vector<double> durations;           ///< [s] of one of those steps
  std::vector<Eigen::Vector2d> landmarks;  ///< [m] by identity
  std::vector<std::uint32_t> scan_rows;    ///< row of each scan
};

/// Squares of the bound along one path [m^2], [rad^2], [m^2]. All control steps between two rows
/// turn and advance alike. `missing` says why it cannot be computed.
CramerRaoBound squared_bound(const SimulatedWorld& world, const TruePath& path);

/// The bound of a result file. Where noise is on the controls that filters are given, the path is
/// the same in all runs, and so is the bound. Where noise moves the vehicle, it is a linearised
/// reference, the average over the paths of the first kBoundRuns runs with a complete cell.
class BoundOfStudy {
 public:
  explicit BoundOfStudy(const ResultFile& file);

  std::size_t paths() const { return paths_.size(); }
  /// Computes the bound along path `i`. Any number of threads may do so, each along its own.
  void follow(std::size_t i) { squares_[i] = squared_bound(*world_, paths_[i]); }
  /// Once every path has been followed.
  CramerRaoBound result() const;

 private:
  std::optional<SimulatedWorld> world_;
  std::vector<TruePath> paths_;
  std::vector<CramerRaoBound> squares_;  ///< {path}
  std::string missing_;                  ///< why there is no path
};

struct CellAnalysis;

/// The bound divided by the error: 1 is as good as any filter without bias can be. NaN if there is
/// no bound (a linearised reference is none) or no error.
struct Efficiency {
  /// Root mean squares over scans, that of the error also over runs.
  double position = kNaN;
  double heading = kNaN;
  /// For the landmarks in the map at the end; needs known association.
  double map = kNaN;
};

Efficiency efficiency_of(const CellAnalysis& cell, const CramerRaoBound& bound);

/// Notes on the bound and on the efficiency, or the reason why there is none.
std::vector<std::string> bound_notes(const CramerRaoBound& bound);

}  // namespace montecarta::analysis
