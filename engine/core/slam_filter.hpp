// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"
#include "engine/namespaces.hpp"
#include "engine/random/stream.hpp"
#include "engine/threads/parallel.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace montecarta::engine {

/// Whether somebody has asked the workers to stop. For a filter that waits for something outside of
/// the process; any other ends its step soon enough.
class StopFlag {
 public:
  virtual ~StopFlag() = default;
  virtual bool is_set() const = 0;
};

/// What the engine gives a filter for one step: its place in the study, random streams, and
/// threads.
class StepContext {
 public:
  StepContext(std::uint64_t seed, std::uint64_t run, std::uint32_t step, const Parallel& parallel,
              const StopFlag* stop = nullptr)
      : seed_(seed), run_(run), step_(step), parallel_(&parallel), stop_(stop) {}

  std::uint64_t run() const { return run_; }
  std::uint32_t step() const { return step_; }
  /// The numbers of (study seed, run, step, purpose, index): the same wherever and whenever asked
  /// for.
  RngStream stream(Draw purpose, std::uint32_t index) const {
    return RngStream(identity(purpose, index));
  }
  StreamIdentity identity(Draw purpose, std::uint32_t index) const {
    return {seed_, run_, step_, index, purpose};
  }
  /// Valid for the whole run; nullptr where nobody stops it. What a filter throws after it was made
  /// is no result: the run is dropped.
  const StopFlag* stop() const { return stop_; }
  /// Calls body(i) for i in [0, count), perhaps at once; body i may write only what belongs to i.
  template <class Body>
  void parallel_for(std::size_t count, const Body& body) const {
    parallel_->for_each(count, body);
  }

 private:
  std::uint64_t seed_;
  std::uint64_t run_;
  std::uint32_t step_;
  const Parallel* parallel_;
  const StopFlag* stop_;
};

/// First two moments of a belief about the pose; covariance over (x, y, heading) [m, m, rad].
struct PoseMoments {
  Pose mean;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// What a filter believes now (EQUATIONS 19).
struct PoseEstimate {
  PoseMoments spread;  ///< of the weighted particles; of the Gaussian for a Kalman filter
  std::optional<PoseMoments>
      mixture;  ///< spread plus each particle's own covariance, before sampling
};

/// What became of a scan's detections, counted against the simulator's identities: a landmark of a
/// map is the one of the detection that it was made of. Of a particle filter: mean over its
/// weighted particles. Detections of no landmark that were left out are in none of the five.
struct AssociationCounts {
  double correct = 0.0;  ///< given to the landmark that it is of, or made new where there was none
  double wrong = 0.0;    ///< given to another landmark
  double new_again = 0.0;  ///< made new though the map has its landmark
  double missed = 0.0;     ///< of a landmark, but left out
  double clutter = 0.0;    ///< of no landmark, but given to one or made new
};

/// What a filter says of its last update; a value that does not apply stays NaN or zero.
struct ScanReport {
  double ess = 0.0;  ///< effective number of particles after weighing, before resampling
  /// Whether this update resampled: at its end, so that the particles of the next one have other
  /// ancestors, or (marginal filters) before it weighed, so that its own have.
  bool resampled = false;
  /// log p(scan | past scans) of the matched detections; with unknown association also log p0
  /// (EQUATIONS 17) for each detection that matches nothing, so that all particles count as many
  /// factors.
  double log_likelihood = 0.0;
  double nis = 0.0;           ///< normalised innovation squared, sum over matched detections
  std::uint32_t nis_dof = 0;  ///< its degrees of freedom
  std::uint32_t numerical_faults =
      0;  ///< factorisations that failed and were answered by a fallback
  AssociationCounts association = {};
  double map_size = 0.0;  ///< landmarks in the map; mean over the weighted particles
  /// [1/rad^2] what all detections since the start are taken to tell of the heading of the whole,
  /// which nobody can observe (EQUATIONS (15.11)); NaN of a filter that does not say.
  double rotation_information = std::numeric_limits<double>::quiet_NaN();
};

/// Where a filter writes its particles; an empty span means that nobody wants that column.
struct ParticleColumns {
  std::span<double> pose;        ///< {particle, 3} row by row [m, m, rad]
  std::span<double> log_weight;  ///< {particle}, normalised
  std::span<std::uint32_t>
      ancestor;  ///< {particle}, index of the parent among the particles one scan ago
};

/// One landmark as the filter reports it: identity of the world with known association, else order
/// of initialisation.
struct LandmarkEstimate {
  Eigen::Vector2d mean;        ///< [m]
  Eigen::Matrix2d covariance;  ///< [m^2]
};

/// Pose and map as one Gaussian: rows x, y, heading, then x and y of each landmark [m, m, rad, m,
/// m, ...].
struct JointEstimate {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  std::uint32_t numerical_faults = 0;  ///< as ScanReport's, on the way to this estimate
};

/// The interface of engine and filters: estimation only, no threads, no files, no clock, no global
/// generator. The engine calls start(); then for every step predict(), and update() where the step
/// ends with a scan. A filter may throw; the run then is stored as failed with the step and the
/// exception's text.
class SlamFilter {
 public:
  virtual ~SlamFilter() = default;
  /// Forgets everything: the vehicle stands at `start`, no landmarks. Must leave nothing of an
  /// earlier run.
  virtual void start(const Pose& start) = 0;
  /// The vehicle drove `control` for `duration` [s].
  virtual void predict(const StepContext& context, const Control& control, double duration) = 0;
  /// The sensor saw `scan` (may be empty).
  virtual void update(const StepContext& context, Scan scan) = 0;
  /// After update(): before resampling (EQUATIONS 4). Between scans: the predicted belief.
  virtual PoseEstimate estimate() const = 0;
  /// Of the last update().
  virtual const ScanReport& report() const = 0;
  /// The particles of the last update(), after weighing and drawing, before resampling. A Kalman
  /// filter has none.
  virtual void particles(const ParticleColumns& columns) const { (void)columns; }
  /// The map after the last update(), at most `landmarks.size()` of them; nullopt = never seen.
  virtual void map(std::span<std::optional<LandmarkEstimate>> landmarks) const = 0;
  /// After update(): the belief about the pose and the first `landmarks` landmarks of map()
  /// together, NaN where never seen. Nothing of a filter that holds no such belief.
  virtual std::optional<JointEstimate> joint(std::size_t landmarks) const {
    (void)landmarks;
    return std::nullopt;
  }
};

}  // namespace montecarta::engine
