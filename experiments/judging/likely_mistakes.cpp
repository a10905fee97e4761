// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/likely_mistakes.hpp"

#include "analysis/run/nees.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/judging/angle_units.hpp"
#include "experiments/judging/time_units.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace montecarta::experiments {
namespace {

/// Least ratio of variances of which the larger or the smaller one may be a mark.
constexpr double kFarApart = 1e4;
/// Marks of "unknown" are at least this large: 9999, 1e6, the largest double.
constexpr double kLeastHuge = 9999.0;
/// Marks of "fixed" are at most this large, and powers of ten: 1e-6, 1e-9.
constexpr double kMostTiny = 1e-6;

bool is_power_of_ten(double value) {
  const double exponent = std::round(std::log10(value));
  return std::abs(value / std::pow(10.0, exponent) - 1.0) < 1e-9;
}

bool is_huge(const Eigen::VectorXd& variances, Eigen::Index i) {
  if (variances(i) < kLeastHuge) return false;
  return std::ranges::any_of(
      variances, [&](double other) { return other > 0.0 && other <= variances(i) / kFarApart; });
}

/// The variances of what is no pose may have units so different that a small one says nothing,
/// unless it is a power of ten.
bool is_tiny(const Eigen::VectorXd& variances, Eigen::Index i, StateKind kind) {
  if (!(variances(i) > 0.0 && variances(i) <= kMostTiny)) return false;
  const bool is_of_pose = kind != StateKind::vector && i < kPoseComponents;
  if (!is_of_pose && !is_power_of_ten(variances(i))) return false;
  return std::ranges::any_of(variances, [&](double other) {
    return other >= variances(i) * kFarApart && other < kLeastHuge;
  });
}

/// Whether a row equals the truth of the same time, number by number.
bool is_copy(const StateRows& rows, std::size_t row, const StateRows& truth) {
  const auto same = std::ranges::lower_bound(truth.time, rows.time[row]);
  if (same == truth.time.end() || *same != rows.time[row]) return false;
  return truth.state[static_cast<std::size_t>(same - truth.time.begin())] == rows.state[row];
}

std::size_t nearest_row(const StateRows& truth, double time) {
  const auto after = std::ranges::lower_bound(truth.time, time);
  const auto k = static_cast<std::size_t>(after - truth.time.begin());
  if (k == 0) return 0;
  return k < truth.time.size() && truth.time[k] - time < time - truth.time[k - 1] ? k : k - 1;
}

/// The pose in space of numbers whose quaternion is w, x, y, z.
Eigen::VectorXd from_w_first(const Eigen::VectorXd& pose) {
  const Eigen::Vector4d q = pose.segment<4>(kQuaternionPlace);
  Eigen::VectorXd turned = pose;
  turned.segment<4>(kQuaternionPlace) << q(1), q(2), q(3), q(0);
  return turned;
}

std::string place_of_line(const std::filesystem::path& path, std::size_t line) {
  return formatted("{}:{}", path, line);
}

std::string of_rows(std::uint64_t some, std::uint64_t all) {
  return formatted("{} of {} rows", some, all);
}

/// Columns beside a pose in space that look like parts of a velocity and are not turned with it.
std::string unturned_velocities(const StateShape& shape) {
  if (shape.kind != StateKind::pose_in_space || has_velocity(shape)) return "";
  std::vector<std::string> found;
  for (std::size_t k = kPoseWidth; k < shape.width(); ++k) {
    const std::string& column = shape.columns[k];
    if (column.starts_with("v") || column.ends_with("_mps")) found.push_back(column);
  }
  return joined(found, ",");
}

/// The components of a state without some.
std::string remaining(const StateShape& shape, const std::vector<std::string>& names) {
  std::vector<std::string> others;
  std::ranges::copy_if(shape.components, std::back_inserter(others),
                       [&](const auto& name) { return std::ranges::count(names, name) == 0; });
  return joined(others, ",");
}

}  // namespace

LikelyMistakes::LikelyMistakes(std::span<const std::string> cells, ErrorConvention convention,
                               bool compares_starts, bool is_pair)
    : convention_(convention), compares_starts_(compares_starts), is_pair_(is_pair) {
  for (const std::string& label : cells) cells_.emplace_back().label = label;
}

LikelyMistakes::Misfit LikelyMistakes::misfit(const StateRows& rows, std::size_t row,
                                              const Eigen::VectorXd& mean,
                                              const Eigen::VectorXd& truth) const {
  const double cosine = mean.segment<4>(kQuaternionPlace).dot(truth.segment<4>(kQuaternionPlace));
  const Eigen::VectorXd error = error_of(rows.shape, convention_, mean, truth);
  const analysis::Nees nees = analysis::imported_nees(error, rows.covariance[row]);
  return {2.0 * std::acos(std::min(std::abs(cosine), 1.0)),
          nees.rank > 0 ? nees.value / nees.rank : 0.0};
}

void LikelyMistakes::compare_quaternions(const StateRows& rows, std::size_t row,
                                         const StateRows& truth, OfCell& cell) const {
  const Eigen::VectorXd& mean = rows.state[row];
  const Eigen::VectorXd& true_one = truth.state[nearest_row(truth, rows.time[row])];
  const auto add = [&](Misfit& sum, const Eigen::VectorXd& estimate, const Eigen::VectorXd& of) {
    const Misfit one = misfit(rows, row, estimate, of);
    sum.angle += one.angle;
    sum.nees += one.nees;
  };
  add(cell.as_stated, mean, true_one);
  add(cell.w_first[0], from_w_first(mean), true_one);
  add(cell.w_first[1], mean, from_w_first(true_one));
}

void LikelyMistakes::add_truth(const StateRows& truth, const std::filesystem::path& path) {
  require_radians(truth, path);
  truth_path_ = path;
  if (on_angles_.empty()) on_angles_ = note_on_angles(truth, path);
  if (truth.left_out > 0 && left_out_ == 0) first_left_out_ = path.string();
  left_out_ += truth.left_out;
}

void LikelyMistakes::mark(const StateRows& rows, std::size_t row, const std::filesystem::path& path,
                          OfCell& cell) {
  const Eigen::VectorXd variances = rows.covariance[row].diagonal();
  for (Eigen::Index i = 0; i < variances.size(); ++i) {
    const double value = variances(i);
    const std::array<bool, kSigns> found = {value < 0.0, value == 0.0, is_huge(variances, i),
                                            is_tiny(variances, i, rows.shape.kind)};
    for (std::size_t sign = 0; sign < kSigns; ++sign) {
      if (!found[sign]) continue;
      Marked& marked = cell.marked[static_cast<std::size_t>(i)][sign];
      if (marked.rows++ == 0) {
        marked.value = value;
        marked.first = place_of_line(path, rows.line[row]);
      }
      marked.varies = marked.varies || value != marked.value;
    }
  }
}

void LikelyMistakes::add(std::size_t cell, const StateRows& rows, const std::filesystem::path& path,
                         const StateRows& truth) {
  require_seconds(rows, path);
  require_same_time_unit(rows, path, truth, truth_path_);
  require_seconds(truth, truth_path_);
  require_radians(rows, path);
  if (on_angles_.empty()) on_angles_ = note_on_angles(rows, path);
  if (on_times_.empty()) on_times_ = note_on_times(rows, path);
  if (rows.left_out > 0 && left_out_ == 0) first_left_out_ = path.string();
  left_out_ += rows.left_out;
  OfCell& of_cell = cells_[cell];
  of_cell.shape = rows.shape;
  of_cell.marked.resize(rows.shape.dimension());
  of_cell.rows += rows.time.size();
  const std::uint64_t copies_before = of_cell.later_copies;
  for (std::size_t row = 0; row < rows.time.size(); ++row) {
    const std::size_t line = rows.line[row];
    mark(rows, row, path, of_cell);
    if (rows.shape.kind == StateKind::pose_in_space) {
      compare_quaternions(rows, row, truth, of_cell);
    }
    if (row == 0 && compares_starts_) compare_starts(rows, path, truth, of_cell);
    if (!is_copy(rows, row, truth)) continue;
    if (of_cell.copies++ == 0) of_cell.first_copy = place_of_line(path, line);
    if (row == 0) continue;  // it may be known exactly
    ++of_cell.later_copies;
    if (rows.covariance[row].isZero(0.0) && of_cell.blanks++ == 0)
      of_cell.first_blank = place_of_line(path, line);
  }
  const std::uint64_t copies = of_cell.later_copies - copies_before;
  of_cell.has_copied_run = of_cell.has_copied_run || 2 * copies > rows.time.size();
}

/// Counts a run whose first position is a hundred deviations or more from the truth.
void LikelyMistakes::compare_starts(const StateRows& rows, const std::filesystem::path& path,
                                    const StateRows& truth, OfCell& cell) {
  if (rows.shape.kind == StateKind::vector) return;
  constexpr double kFarDeviations = 100.0, kFarDistance = 0.01;  // [m]
  ++cell.runs;
  const Eigen::VectorXd& start = truth.state[nearest_row(truth, rows.time.front())];
  const double distance = (rows.state.front().head<2>() - start.head<2>()).norm();
  double variance = 0.0;  // the first that is claimed, for a start that is known exactly
  for (std::size_t row = 0; row < rows.time.size() && !(variance > 0.0); ++row) {
    variance = rows.covariance[row].diagonal().head<2>().sum();
  }
  if (!(variance > 0.0)) return;
  if (!(distance > kFarDistance && distance > kFarDeviations * std::sqrt(variance))) return;
  if (cell.apart++ > 0) return;
  cell.distance = distance;
  cell.first_apart = place_of_line(path, rows.line.front());
}

/// Adds a sentence for each sign that components have.
void LikelyMistakes::add_marks(const OfCell& cell, std::vector<std::string>& notes) {
  const std::array<const char*, kSigns> reasons = {
      "no variance is negative: is it a mark of what is not estimated?",
      "such components are in no test; is it a mark of what is not estimated?",
      "much larger than the others: is it a mark of what is not estimated?",
      "much smaller than the others: is it a mark of what is not estimated?"};
  for (std::size_t sign = 0; sign < kSigns; ++sign) {
    const bool must_be_constant = sign == huge || sign == tiny;
    std::vector<std::string> names;
    const Marked* first = nullptr;
    for (std::size_t k = 0; k < cell.marked.size(); ++k) {
      const Marked& marked = cell.marked[k][sign];
      if (marked.rows == 0 || (must_be_constant && marked.varies)) continue;
      if (sign != negative && 2 * marked.rows < cell.rows) continue;
      names.push_back(cell.shape.components[k]);
      if (first == nullptr || marked.rows > first->rows) first = &marked;
    }
    if (names.empty() || (sign != negative && names.size() == cell.marked.size())) {
      continue;
    }
    const std::string others = remaining(cell.shape, names);
    notes.push_back(
        formatted("{}: {} {} the variance {} in {}, the first in {} ({}): {}", cell.label,
                  joined(names), names.size() == 1 ? "has" : "have", to_text(first->value),
                  of_rows(first->rows, cell.rows), first->first, reasons[sign],
                  others.empty() ? "write variances of the errors"
                                 : "for a verdict on the others, add --components " + others));
  }
}

/// Adds sentences on rows that equal the truth.
void LikelyMistakes::add_copies(const OfCell& cell, const std::string& other,
                                std::vector<std::string>& notes) {
  if (cell.blanks > 0) {
    notes.push_back(
        formatted("{}: error and covariance are all 0 in {}, the first in {} (such rows are in no "
                  "test): if nothing was estimated there, leave them out, or write NaN in arrays",
                  cell.label, of_rows(cell.blanks, cell.rows), cell.first_blank));
  }
  if (cell.later_copies > cell.blanks &&
      (cell.has_copied_run || 10 * cell.later_copies > cell.rows)) {
    notes.push_back(formatted(
        "{}: the estimates equal the {}, number by number, in {}, the first in {}{}", cell.label,
        other, of_rows(cell.copies, cell.rows), cell.first_copy,
        other == "truth" ? ": are they a copy of it?" : ": is one file a copy of the other?"));
  }
}

void LikelyMistakes::add_notes(const OfCell& cell, std::vector<std::string>& notes) const {
  const std::string other = is_pair_ ? "second estimates" : "truth";
  add_marks(cell, notes);
  for (std::size_t k = 0; k < cell.w_first.size(); ++k) {
    constexpr double kMuchNearer = 0.2;
    const Misfit &stated = cell.as_stated, &swapped = cell.w_first[k];
    if (!(swapped.angle < kMuchNearer * stated.angle)) continue;
    const auto mean = [&](double sum) { return compact(sum / static_cast<double>(cell.rows)); };
    notes.push_back(
        formatted("{}: the quaternions of the {} may be written with w first, under the header "
                  "qx,qy,qz,qw (then rotations would be {} rad from the {} on average, with a NEES "
                  "ratio of {}, and are {} rad): write x, y, z, w",
                  cell.label, k == 0 ? "estimates" : other, mean(swapped.angle), other,
                  mean(swapped.nees), mean(stated.angle)));
  }
  if (const std::string velocities = unturned_velocities(cell.shape); !velocities.empty()) {
    notes.push_back(
        formatted("{}: {} may be parts of a velocity, and are judged as differences of numbers: "
                  "name it vx_mps,vy_mps,vz_mps if it is in the map",
                  cell.label, velocities));
  }
  if (2 * cell.apart > cell.runs) {
    notes.push_back(
        formatted("{}: {} of {} {} far from the truth for the deviations that they claim ({} m in "
                  "{}): if the frames differ, see --anchor",
                  cell.label, cell.apart, cell.runs, cell.runs == 1 ? "run begins" : "runs begin",
                  compact(cell.distance), cell.first_apart));
  }
  add_copies(cell, other, notes);
}

std::vector<std::string> LikelyMistakes::notes() const {
  std::vector<std::string> notes;
  std::ranges::copy_if(std::vector{on_times_, on_angles_}, std::back_inserter(notes),
                       [](const std::string& note) { return !note.empty(); });
  if (left_out_ > 0) {
    notes.push_back(
        formatted("{} {} left out by --keep, the first in {} (another row has the same time)",
                  left_out_, left_out_ == 1 ? "row is" : "rows are", first_left_out_));
  }
  for (const OfCell& cell : cells_) add_notes(cell, notes);
  return notes;
}

}  // namespace montecarta::experiments
