// SPDX-License-Identifier: BSD-3-Clause
// The Cramer-Rao bound of the study, and how near cells come to it.
#include "analysis/metrics/cramer_rao.hpp"

#include "analysis/metrics/cell_analysis.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "filters/models/ackermann.hpp"
#include "filters/models/eigen_jacobians.hpp"
#include "filters/models/vehicle_settings.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <complex>

namespace montecarta::analysis {
namespace {

/// Settings of a scenario by name; notes whether all that must be there is.
class Facts {
 public:
  explicit Facts(const TextPairs& pairs) : pairs_(&pairs) {}

  std::optional<std::string> optional_text(const std::string& name) const {
    const auto found =
        std::ranges::find_if(*pairs_, [&](const auto& p) { return p.first == name; });
    return found == pairs_->end() ? std::nullopt : std::optional(found->second);
  }
  std::optional<double> optional_number(const std::string& name) const {
    const std::optional<std::string> written = optional_text(name);
    if (!written) return std::nullopt;
    double value = 0.0;
    const auto end = written->data() + written->size();
    if (std::from_chars(written->data(), end, value).ptr != end) return std::nullopt;
    return value;
  }
  std::string text(const std::string& name) { return needed(optional_text(name)); }
  double number(const std::string& name) { return needed(optional_number(name)); }
  double si(const std::string& name) { return in_si(name, number(name)); }
  bool complete() const { return complete_; }

 private:
  template <class Value>
  Value needed(const std::optional<Value>& value) {
    complete_ = complete_ && value.has_value();
    return value.value_or(Value());
  }

  const TextPairs* pairs_;
  bool complete_ = true;
};

/// The sensor with its mount, which files omit where it is usual; nullopt if it is unknown.
std::optional<Sensor> sensor_of(const Facts& facts) {
  const auto usual = [&](const char* key) {
    return in_si(key, facts.optional_number(key).value_or(0.0));
  };
  return sensor_named(facts.optional_text("sensor").value_or(name_of(Sensor())),
                      {.forward = usual("mount_forward"),
                       .left = usual("mount_left"),
                       .turn = wrap(usual("mount_turn_deg"))});
}

Eigen::Vector2d sigma_of(Facts& facts, const Sensor& sensor) {
  Eigen::Vector2d sigma = Eigen::Vector2d::Ones();
  Eigen::Index i = 0;
  for (const Quantity quantity : components_of(sensor)) {
    sigma(i++) = facts.si(component_of(quantity).sigma.key);
  }
  return sigma;
}

}  // namespace

std::optional<SimulatedWorld> simulated_world_of(const ResultFile& file) {
  Facts facts(file.scenario());
  if (facts.text("kind") != "simulated" || !file.has_truth()) return std::nullopt;
  const std::optional<Vehicle> vehicle = vehicle_named(
      facts.text("vehicle"), [&](const auto& key) { return std::optional(facts.text(key)); },
      [&](const auto& key) { return std::optional(facts.number(key)); });
  if (!vehicle) return std::nullopt;
  const std::optional<ControlNoise> control_noise =
      control_noise_of(*vehicle, [&](const auto& key) { return facts.optional_number(key); });
  if (!control_noise) return std::nullopt;
  const std::optional<Sensor> sensor = sensor_of(facts);
  if (!sensor) return std::nullopt;
  SimulatedWorld world{
      .vehicle = *vehicle,
      .control_noise = *control_noise,
      .sigma_observation = sigma_of(facts, *sensor),
      .detected = 1.0 - facts.number("miss_probability"),
      .view = FieldOfView(facts.number("max_range"), facts.si("field_of_view_deg"),
                          sensor->mounting, facts.optional_number("min_range").value_or(0.0)),
      .same_path = facts.text("noise") != "matched",
      .sensor = *sensor};
  if (!facts.complete()) return std::nullopt;
  return world;
}

namespace {

/// [m] Initial standard deviation of a landmark that one detection does not fix: large enough to
/// add no information, and small enough to add no rounding errors.
constexpr double kUnknown = 1000.0;

void mirror_lower(Eigen::Matrix3d& P) { P.triangularView<Eigen::StrictlyUpper>() = P.transpose(); }

}  // namespace

JointBound::JointBound(std::size_t landmarks, const Vehicle& vehicle,
                       const ControlNoise& control_noise,
                       const Eigen::Vector2d& observation_variance, const Sensor& sensor)
    : vehicle_(vehicle),
      control_noise_(control_noise),
      observation_variance_(observation_variance),
      sensor_(sensor),
      row_(landmarks, 0) {
  const auto rows = 3 + 2 * static_cast<Eigen::Index>(landmarks);
  joint_.setZero(rows, rows);
}

/// P' = Fx P Fx' + Fu Q Fu'. The map waits for finish_motion(): Fx of several steps is again
/// [1 0 a; 0 1 b; 0 0 1] with a and b their sums.
Pose JointBound::move(const Pose& pose, const Control& control, double duration) {
  const auto step = linearised_move(pose, control, duration, vehicle_);
  const Eigen::Matrix3d F = pose_jacobian(step.jacobians);
  const auto sigma = deviations_of(control_noise_, control, vehicle_);
  ControlJacobian noise = control_jacobian(step.jacobians);
  for (Eigen::Index i = 0; i < noise.cols(); ++i)
    noise.col(i) *= sigma[static_cast<std::size_t>(i)];
  pose_ = F * pose_ * F.transpose() + noise * noise.transpose();
  mirror_lower(pose_);
  pending_x_heading_ += step.jacobians.x_heading;
  pending_y_heading_ += step.jacobians.y_heading;
  return step.pose;
}

void JointBound::finish_motion() {
  auto cross = joint_.block(3, 0, size_ - 3, 3);
  cross.col(0) += pending_x_heading_ * cross.col(2);
  cross.col(1) += pending_y_heading_ * cross.col(2);
  joint_.topLeftCorner<3, 3>() = pose_;
  pending_x_heading_ = pending_y_heading_ = 0.0;
}

bool JointBound::scan(const Pose& pose, std::span<const Seen> landmarks) {
  finish_motion();
  if (!fixes_landmark(sensor_)) {
    for (const Seen& landmark : landmarks) {
      if (row_of(landmark.identity) == 0) append_unknown(landmark);
    }
  }
  std::vector<Seen> known;
  for (const Seen& landmark : landmarks) {
    if (row_of(landmark.identity) != 0) known.push_back(landmark);
  }
  if (!known.empty() && !correct(pose, known)) return false;
  for (const Seen& landmark : landmarks) {
    if (row_of(landmark.identity) == 0) append(pose, landmark);
  }
  return pose_.allFinite();
}

Eigen::VectorXd JointBound::column(Eigen::Index j) const {
  Eigen::VectorXd column(size_);
  column.head(j) = joint_.row(j).head(j).transpose();
  column.tail(size_ - j) = joint_.col(j).segment(j, size_ - j);
  return column;
}

/// P <- P - P H' S^-1 H P for all observations of a scan at once, with S = L L' and W = P H' L^-T.
bool JointBound::correct(const Pose& pose, std::span<const Seen> landmarks) {
  const auto m = 2 * static_cast<Eigen::Index>(landmarks.size());
  Eigen::MatrixXd gain(size_, m);  // P H'
  Eigen::MatrixXd S(m, m);
  std::vector<LinearisedDetection> observations;
  for (const Seen& landmark : landmarks) {
    const auto i = 2 * static_cast<Eigen::Index>(observations.size());
    const auto observation = linearised_detection(sensor_, pose, landmark.point);
    if (!observation) return false;
    observations.push_back(*observation);
    const Eigen::Index row = row_of(landmark.identity);
    const Matrix23& Hx = observation->by_pose;
    const Eigen::Matrix2d& Hf = observation->by_landmark;
    gain.middleCols<2>(i).noalias() = joint_.block(0, 0, size_, 3) * Hx.transpose();
    gain.middleCols<2>(i) += column(row) * Hf.col(0).transpose();
    gain.middleCols<2>(i) += column(row + 1) * Hf.col(1).transpose();
  }
  for (std::size_t k = 0; k < observations.size(); ++k) {
    const auto i = 2 * static_cast<Eigen::Index>(k);
    S.middleRows<2>(i) =
        observations[k].by_pose * gain.topRows<3>() +
        observations[k].by_landmark * gain.middleRows<2>(row_of(landmarks[k].identity));
    S.diagonal().segment<2>(i) += observation_variance_;
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(S);
  if (factor.info() != Eigen::Success) return false;
  factor.matrixU().solveInPlace<Eigen::OnTheRight>(gain);
  joint_.topLeftCorner(size_, size_).selfadjointView<Eigen::Lower>().rankUpdate(gain, -1.0);
  pose_ = joint_.topLeftCorner<3, 3>();
  mirror_lower(pose_);
  joint_.topLeftCorner<3, 3>() = pose_;
  return true;
}

void JointBound::append(const Pose& pose, const Seen& landmark) {
  const auto seen = linearised_detection(sensor_, pose, landmark.point);
  const auto placed = placed_landmark(sensor_, pose, seen->value);
  const Matrix23& Gx = placed->by_pose;
  const Eigen::Matrix2d& Gz = placed->by_detection;
  row_of(landmark.identity) = size_;
  joint_.block(size_, 0, 2, size_).noalias() = Gx * joint_.block(0, 0, size_, 3).transpose();
  joint_.block<2, 2>(size_, size_) =
      Gx * pose_ * Gx.transpose() + Gz * observation_variance_.asDiagonal() * Gz.transpose();
  size_ += 2;
}

void JointBound::append_unknown(const Seen& landmark) {
  row_of(landmark.identity) = size_;
  joint_.block(size_, 0, 2, size_).setZero();
  joint_.block<2, 2>(size_, size_) = kUnknown * kUnknown * Eigen::Matrix2d::Identity();
  size_ += 2;
}

double JointBound::mean_map_variance() const {
  double sum = 0.0, count = 0.0;
  for (Eigen::Index row = 3; row < size_; row += 2) {
    const double x = joint_(row, row), y = joint_(row + 1, row + 1);
    if (x + y > 0.01 * kUnknown * kUnknown) continue;  // seen along one line
    sum += x;
    sum += y;
    count += 1.0;
  }
  return count == 0.0 ? kNaN : sum / count;
}

namespace {

using Complex = std::complex<double>;

/// The step, in the vehicle's frame, that leads from one pose to another if it is taken `steps`
/// times: turned about as it goes, it advances by the sum of exp(i k turn).
BodyStep<double> equal_steps(const Pose& from, const Pose& to, std::size_t steps) {
  const Eigen::Vector3d change = boxminus(to, from);
  const double turn = change(2) / static_cast<double>(steps);
  Complex advance = 0.0;
  for (std::size_t k = 0; k < steps; ++k) {
    advance += std::polar(1.0, turn * static_cast<double>(k));
  }
  const Complex step = std::polar(1.0, -from.heading) * Complex(change(0), change(1)) / advance;
  return {step.real(), step.imag(), turn};
}

void move_along(const TruePath& path, std::size_t row, const Vehicle& vehicle, JointBound& bound) {
  Pose pose = row == 0 ? path.start : path.rows[row - 1];
  const BodyStep<double> step = equal_steps(pose, path.rows[row], path.steps[row]);
  const Control control = control_of(step, path.durations[row], vehicle);
  for (std::size_t k = 0; k < path.steps[row]; ++k) {
    pose = bound.move(pose, control, path.durations[row]);
  }
}

std::vector<JointBound::Seen> seen_from(const Pose& pose, const SimulatedWorld& world,
                                        std::span<const Eigen::Vector2d> landmarks) {
  std::vector<JointBound::Seen> seen;
  world.view.look(pose, landmarks, [&](const InView& one) {
    if (one.range < kLeastDistance) return;  // nothing with a derivative
    const Eigen::Vector2d& at = landmarks[one.landmark];
    seen.push_back({one.landmark, {at.x(), at.y()}});
  });
  return seen;
}

/// Rows with the control steps between them: each step one row, or each scan.
TruePath steps_of(const ResultFile& file) {
  TruePath path{file.description().start, {}, {}, {}, {}, file.scan_rows()};
  const std::vector<double>& times = file.times();
  const bool scans_only = times.size() == file.scan_times().size();
  const std::vector<std::uint32_t>& scan_steps = file.description().scan_steps;
  for (std::size_t r = 0; r < times.size(); ++r) {
    const std::size_t steps = !scans_only ? 1
                              : r == 0    ? scan_steps[0] + 1
                                          : scan_steps[r] - scan_steps[r - 1];
    path.steps.push_back(steps);
    path.durations.push_back((times[r] - (r == 0 ? 0.0 : times[r - 1])) /
                             static_cast<double>(steps));
  }
  return path;
}

void read_rows(const ResultFile& file, std::size_t run, TruePath& path) {
  path.landmarks = file.landmarks_of(run);
  std::vector<double> truth(3 * file.times().size());
  file.read_truth(run, truth);
  for (std::size_t r = 0; r < file.times().size(); ++r) {
    path.rows.push_back({truth[3 * r], truth[3 * r + 1], truth[3 * r + 2]});
  }
}

/// The first runs that have a path, as many as are wanted.
std::vector<std::size_t> first_runs(const ResultFile& file, std::size_t wanted) {
  std::vector<bool> complete(file.runs().size());
  for (const StoredCell& cell : file.cells()) {
    const std::vector<RunStatus> status = file.status(cell);
    for (std::size_t i = 0; i < status.size(); ++i) {
      if (status[i] == RunStatus::complete) complete[i] = true;
    }
  }
  std::vector<std::size_t> runs;
  for (std::size_t i = 0; i < complete.size() && runs.size() < wanted; ++i) {
    if (complete[i]) runs.push_back(i);
  }
  return runs;
}

void add(const std::vector<double>& values, std::vector<double>& sums) {
  sums.resize(values.size());
  for (std::size_t s = 0; s < sums.size(); ++s) sums[s] += values[s];
}

/// The root of the mean of squares, in the order of the runs.
CramerRaoBound root_mean(const std::vector<CramerRaoBound>& squares) {
  CramerRaoBound bound;
  bound.runs = squares.size();
  bound.map = 0.0;
  for (const CramerRaoBound& one : squares) {
    if (!one.missing.empty()) return one;
    add(one.position, bound.position);
    add(one.heading, bound.heading);
    bound.map += one.map;
  }
  const auto finish = [&](double& sum) { sum = std::sqrt(sum / static_cast<double>(bound.runs)); };
  std::ranges::for_each(bound.position, finish);
  std::ranges::for_each(bound.heading, finish);
  finish(bound.map);
  return bound;
}

CramerRaoBound none_for(const std::string& reason) {
  CramerRaoBound bound;
  bound.missing = reason;
  return bound;
}

double mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return sum / static_cast<double>(values.size());
}

}  // namespace

CramerRaoBound squared_bound(const SimulatedWorld& world, const TruePath& path) {
  // A detection that may be missed brings its information times the chance that it is there.
  const Eigen::Vector2d observation_variance = world.sigma_observation.cwiseAbs2() / world.detected;
  JointBound joint(path.landmarks.size(), world.vehicle, world.control_noise, observation_variance,
                   world.sensor);
  CramerRaoBound bound;
  std::size_t row = 0;
  for (const std::uint32_t scan_row : path.scan_rows) {
    for (; row <= scan_row; ++row) move_along(path, row, world.vehicle, joint);
    const Pose& pose = path.rows[scan_row];
    if (world.detected > 0.0 && !joint.scan(pose, seen_from(pose, world, path.landmarks))) {
      return none_for("the noise is too small to compute with");
    }
    bound.position.push_back(joint.pose()(0, 0) + joint.pose()(1, 1));
    bound.heading.push_back(joint.pose()(2, 2));
  }
  bound.map = joint.mean_map_variance();
  bound.runs = 1;
  return bound;
}

BoundOfStudy::BoundOfStudy(const ResultFile& file) : world_(simulated_world_of(file)) {
  if (!world_) {
    missing_ = "the file does not describe a simulated vehicle and its sensor";
  } else if (!(world_->sigma_observation.minCoeff() > 0.0)) {
    missing_ = "the sensor has no noise";
  } else {
    const bool same = world_->same_path && !file.has_own_landmarks();
    for (const std::size_t run : first_runs(file, same ? 1 : kBoundRuns)) {
      read_rows(file, run, paths_.emplace_back(steps_of(file)));
    }
    if (paths_.empty()) missing_ = "no run is complete";
  }
  squares_.resize(paths_.size());
}

CramerRaoBound BoundOfStudy::result() const {
  if (!missing_.empty()) return none_for(missing_);
  CramerRaoBound bound = root_mean(squares_);
  bound.is_bound = world_->same_path;
  return bound;
}

Efficiency efficiency_of(const CellAnalysis& cell, const CramerRaoBound& bound) {
  if (bound.empty() || !bound.is_bound || cell.complete == 0) return {};
  return {.position = std::sqrt(mean_square(bound.position) / cell.over_runs("position_mse").mean),
          .heading = std::sqrt(mean_square(bound.heading) / cell.over_runs("heading_mse").mean),
          .map = bound.map / std::sqrt(mean_square(cell.scores.column("landmark_rms")))};
}

namespace {

const std::vector<ResultNumber<Efficiency>> kEfficiencies = {
    {"position_efficiency", "1", &Efficiency::position},
    {"heading_efficiency", "1", &Efficiency::heading},
    {"map_efficiency", "1", &Efficiency::map}};

/// One row for each scan: the Cramer-Rao bound of position and heading.
Frame bound_frame(const StudyAnalysis& study) {
  if (study.bound.empty()) return {};
  return {{{"time", "s", study.times},
           {"position_bound", "m", study.bound.position},
           {"heading_bound", "rad", study.bound.heading}}};
}

}  // namespace

std::vector<std::string> bound_notes(const CramerRaoBound& bound) {
  if (bound.empty()) return {prose("bound", "missing", {{"reason", bound.missing}})};
  const std::string runs = std::to_string(bound.runs);
  if (!bound.is_bound) return {prose("bound", "reference", {{"runs", runs}})};
  const std::string paths = bound.runs == 1 ? prose("bound", "one path")
                                            : prose("bound", "many worlds", {{"runs", runs}});
  return {prose("bound", "efficiency", {{"paths", paths}})};
}

Metric bound_metric() {
  return {.add_numbers = numbers_by(kEfficiencies), .files = {{"bound.csv", bound_frame}}};
}

}  // namespace montecarta::analysis
