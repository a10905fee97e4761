// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/drive.hpp"
#include "engine/core/pose.hpp"
#include "engine/core/prior.hpp"
#include "engine/errors.hpp"
#include "engine/namespaces.hpp"
#include "engine/random/stream.hpp"
#include "engine/threads/parallel.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace montecarta::engine {

/// A request to stop the workers. It is for filters that wait for something outside the process;
/// other filters end their step soon enough.
class StopFlag {
 public:
  virtual ~StopFlag() = default;
  virtual bool is_set() const = 0;
};

/// The context of one step of a filter: its place in the study, random streams, and threads.
class StepContext {
 public:
  /// `parallel` and `stop` must outlive the run, since a filter may keep the context until the next
  /// start().
  StepContext(std::uint64_t seed, std::uint64_t run, std::uint32_t step, const Parallel& parallel,
              const StopFlag* stop = nullptr)
      : seed_(seed), run_(run), step_(step), parallel_(&parallel), stop_(stop) {}

  /// The context of a filter before its first step: one thread.
  static StepContext before_all_steps() { return {0, 0, 0, Parallel::serial()}; }

  std::uint64_t run() const { return run_; }
  std::uint32_t step() const { return step_; }
  /// The random stream of (study seed, run, step, purpose, index), the same at any time and on any
  /// thread.
  RngStream stream(Draw purpose, std::uint32_t index) const {
    return RngStream(identity(purpose, index));
  }
  StreamIdentity identity(Draw purpose, std::uint32_t index) const {
    return {seed_, run_, step_, index, purpose};
  }
  /// The flag that stops the run, valid for the whole run; nullptr if nothing can stop it. If it is
  /// set, an exception from the filter is not a result, and the run is dropped.
  const StopFlag* stop() const { return stop_; }
  /// Calls body(i) for i in [0, count), perhaps in parallel; body(i) may only write its own data.
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

/// The estimate of a filter (EQUATIONS 19).
struct PoseEstimate {
  PoseMoments spread;  ///< spread of weighted particles; Gaussian of a Kalman filter
  std::optional<PoseMoments>
      mixture;  ///< spread plus each particle's own covariance, before sampling
};

/// Results of associating the detections of a scan, counted by the simulator's identities. A
/// landmark of a map has the identity of the detection that initialised it. Counts of a particle
/// filter are means over its weighted particles. Ignored clutter and unidentified detections are in
/// none of the five.
struct AssociationCounts {
  double correct = 0.0;  ///< detections matched with their landmark, or that initialised a new one
  double wrong = 0.0;    ///< detections matched with another landmark
  double new_again = 0.0;  ///< detections that initialised a landmark that the map has already
  double missed = 0.0;     ///< detections of landmarks that were ignored
  double clutter = 0.0;    ///< clutter that was matched or initialised a landmark
};

/// The report of a filter on its last update. A value that does not apply stays NaN or zero.
struct ScanReport {
  double ess = 0.0;  ///< effective number of particles after weighting, before resampling
  /// True if this update resampled: at its end, so that the particles of the next one have other
  /// ancestors, or, in marginal filters, before weighting, so that its own particles have.
  bool resampled = false;
  /// log p(scan | past scans) of the matched detections. With unknown association it includes log
  /// p0 (EQUATIONS 17) for each detection without a match, so that all particles have as many
  /// factors. A fix of the position is a factor too.
  double log_likelihood = 0.0;
  double nis = 0.0;           ///< normalised innovation squared, sum over matched detections
  std::uint32_t nis_dof = 0;  ///< degrees of freedom of nis
  std::uint32_t numerical_faults =
      0;  ///< number of failed factorisations that were handled by a fallback
  AssociationCounts association = {};
  double map_size = 0.0;  ///< number of landmarks; mean over the weighted particles
  /// The values of Capabilities::own_columns, in a member of the filter.
  std::span<const double> own = {};
};

/// The columns to which a filter writes its particles; those with an empty span are not requested.
struct ParticleColumns {
  std::span<double> pose;             ///< {particle, 3} row by row [m, m, rad]
  std::span<double> log_weight;       ///< {particle}, normalised
  std::span<std::uint32_t> ancestor;  ///< {particle} index of the parent one scan earlier
};

/// Pose and map as one Gaussian: rows x, y, heading, then x and y of each landmark [m, m, rad, m,
/// m, ...].
struct JointEstimate {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  std::uint32_t numerical_faults = 0;  ///< those of this estimate (ScanReport)
};

/// The interface between engine and filters. Filters only estimate: they have no threads, files,
/// clock or global generator. The engine calls start(), then predict() for every step, and update()
/// if the step ends with a scan. If a filter throws, the run is stored as failed with the step and
/// the text of the exception.
class SlamFilter {
 public:
  virtual ~SlamFilter() = default;
  /// Starts a run at pose `start` without landmarks. Nothing of an earlier run may remain.
  virtual void start(const Pose& start) = 0;
  /// Starts a run with this knowledge of the pose and of the map, in place of start(). If the map
  /// is known, the filter never initialises a landmark. Called only if the filter declares that it
  /// takes a prior.
  virtual void start_from(const StepContext& context, const Prior& prior) {
    (void)context, (void)prior;
    expect(false, "a filter that takes no prior is started from one");
  }
  /// Predicts by `control`, held for `duration` [s].
  virtual void predict(const StepContext& context, const Control& control, double duration) = 0;
  /// Takes a fix of the position at the instant of the next update(), which uses it before its
  /// scan. Called only if the filter declares that it takes fixes.
  virtual void take_fix(const PositionFix& fix) {
    (void)fix;
    expect(false, "a filter that takes no fixes of the position is given one");
  }
  /// Updates with `scan`, which may be empty.
  virtual void update(const StepContext& context, Scan scan) = 0;
  /// Returns the estimate before resampling after update() (EQUATIONS 4), else the predicted one.
  virtual PoseEstimate estimate() const = 0;
  /// Report of the last update().
  virtual const ScanReport& report() const = 0;
  /// Writes the particles of the last update(), weighted and drawn but not yet resampled. A Kalman
  /// filter has none.
  virtual void particles(const ParticleColumns& columns) const { (void)columns; }
  /// Writes the first landmarks of the map after the last update(); nullopt if never observed.
  virtual void map(std::span<std::optional<LandmarkEstimate>> landmarks) const = 0;
  /// Joint estimate of the pose and the first `landmarks` landmarks of map() after update(), NaN if
  /// never observed; nullopt if the filter has no joint estimate.
  virtual std::optional<JointEstimate> joint(std::size_t landmarks) const {
    (void)landmarks;
    return std::nullopt;
  }
};

/// A number of every scan that only some filters report. The filter declares it here and reports
/// its value in ScanReport::own.
struct OwnColumn {
  std::string name;   ///< name in the file, which no row of records/columns.cpp has
  std::string group;  ///< group of record.columns that stores it; "pose" is always stored
  std::string units;  ///< UDUNITS style: "m", "rad", "1"
  std::string long_name;
};

/// The estimates of a filter besides the spread of its pose. The filter declares them; a study
/// stores the columns of a mixture, a joint estimate or the filter's own if they are there.
struct Capabilities {
  bool particles = false;
  bool mixture = false;                     ///< estimate() has a mixture before sampling
  bool joint = false;                       ///< joint() has an estimate
  bool map = true;                          ///< map() has landmarks
  std::vector<OwnColumn> own_columns = {};  ///< own columns, in the order of ScanReport::own
};

}  // namespace montecarta::engine
