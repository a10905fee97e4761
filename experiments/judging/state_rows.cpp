// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/state_rows.hpp"

#include "analysis/metrics/nees.hpp"
#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"
#include "experiments/files/csv_rows.hpp"
#include "experiments/files/files.hpp"
#include "experiments/judging/state_columns.hpp"
#include "experiments/text/words.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

namespace montecarta::experiments {
namespace {

/// Printed with three digits a quaternion is as long as this.
constexpr double kQuaternionPlaceSlack = 2e-3;
constexpr Eigen::Index kQuaternionPlace = 3;  // behind x, y, z

/// Adds the time [s] of the next row.
void take_time(double time, const std::string& place, std::vector<double>& times) {
  if (!times.empty() && time <= times.back()) {
    throw StudyError(place + ": time " + to_text(time) +
                     " s is not later than that of the row before (rows go forward in time): sort "
                     "them, one row for each time");
  }
  times.push_back(time);
}

/// Makes the quaternion at the end of the state of a pose in space one of length 1.
void normalise_quaternion(Eigen::VectorXd& state, const std::string& place) {
  const double length = state.tail<4>().norm();
  if (std::abs(length - 1.0) > kQuaternionPlaceSlack) {
    throw StudyError(place + ": the quaternion has length " + to_text(length) +
                     " (of a rotation it is 1): write qx, qy, qz, qw of a unit quaternion");
  }
  state.tail<4>() /= length;
}

Eigen::VectorXd state_in(const CsvRows& rows, const std::vector<std::size_t>& fields,
                         const StateShape& shape) {
  Eigen::VectorXd state(static_cast<Eigen::Index>(fields.size()));
  for (std::size_t k = 0; k < fields.size(); ++k) {
    state(static_cast<Eigen::Index>(k)) = rows.number(fields[k], "number");
  }
  if (shape.kind == StateKind::pose_in_space) normalise_quaternion(state, rows.place());
  return state;
}

Eigen::MatrixXd covariance_in(const CsvRows& rows, const EstimateFields& fields) {
  const auto d = static_cast<Eigen::Index>(fields.shape.dimension());
  Eigen::MatrixXd P(d, d);
  for (Eigen::Index i = 0; i < d; ++i) {
    for (Eigen::Index j = 0; j < d; ++j) {
      P(i, j) = rows.number(fields.covariance[static_cast<std::size_t>(i * d + j)], "number");
    }
  }
  return P;
}

void take_innovation(const CsvRows& rows, const EstimateFields& fields, StateRows& all) {
  if (!fields.nis) return;
  const double nis = rows.number(*fields.nis, "number");
  all.nis_dof.push_back(checked_dof(nis, rows.number(*fields.nis_dof, "number"), rows.place()));
  all.nis.push_back(nis);
}

bool is_angle(const StateShape& shape, Eigen::Index k) {
  return shape.kind != StateKind::pose_in_space &&
         shape.units[static_cast<std::size_t>(k)] == "rad";
}

/// Between two states, `share` of the way.
Eigen::VectorXd between(const StateShape& shape, const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                        double share) {
  Eigen::VectorXd state = a + share * (b - a);
  for (Eigen::Index k = 0; k < state.size(); ++k) {
    if (is_angle(shape, k)) state(k) = wrap(a(k) + share * wrap(b(k) - a(k)));
  }
  if (shape.kind == StateKind::pose_in_space) {
    const Eigen::Quaterniond from(Eigen::Vector4d(a.segment<4>(kQuaternionPlace)));
    const Eigen::Quaterniond to(Eigen::Vector4d(b.segment<4>(kQuaternionPlace)));
    state.segment<4>(kQuaternionPlace) = from.slerp(share, to).coeffs();
  }
  return state;
}

namespace fs = std::filesystem;

/// Squares and components of one row.
struct RowOfInnovations {
  double nis = 0.0;
  std::uint32_t dof = 0;
};

/// Which estimate a row belongs to.
std::size_t place_in(const StateRows& rows, double time, double tolerance, const CsvRows& file,
                     const fs::path& estimates) {
  const auto after = std::ranges::lower_bound(rows.time, time);
  auto k = static_cast<std::size_t>(after - rows.time.begin());
  if (k == rows.time.size() || (k > 0 && time - rows.time[k - 1] < rows.time[k] - time)) --k;
  if (std::abs(rows.time[k] - time) <= tolerance) return k;
  throw StudyError(file.place() + ": no estimate in " + estimates.string() + " is of time " +
                   to_text(time) + " s (the nearest is of " + to_text(rows.time[k]) +
                   " s): give innovations the times of the estimates after them, or leave out "
                   "those of scans that have none");
}

/// From the innovation itself, where the file has no NIS.
RowOfInnovations squares_of(const CsvRows& file, const EstimateFields& fields) {
  const auto d = static_cast<Eigen::Index>(fields.shape.dimension());
  Eigen::VectorXd innovation(d);
  Eigen::MatrixXd S(d, d);
  for (Eigen::Index i = 0; i < d; ++i) {
    const auto row = static_cast<std::size_t>(i);
    innovation(i) = file.number(fields.state[row], "number");
    for (Eigen::Index j = 0; j < d; ++j) {
      const auto element = static_cast<std::size_t>(i * d + j);
      S(i, j) = file.number(fields.covariance[element], "number");
    }
  }
  const analysis::Nees sample = analysis::imported_nees(innovation, S);
  return {sample.value, static_cast<std::uint32_t>(sample.is_usable() ? sample.rank : d)};
}

}  // namespace

std::uint32_t checked_dof(double nis, double dof, const std::string& place) {
  constexpr double kMostComponents = 1e6;
  if (nis >= 0.0 && dof >= 0.0 && dof <= kMostComponents && dof == std::floor(dof)) {
    return static_cast<std::uint32_t>(dof);
  }
  throw StudyError(place + ": nis " + to_text(nis) + " with nis_dof " + to_text(dof) +
                   " (a sum of squares, and how many components it has): write 0 and 0 where "
                   "nothing was observed");
}

StateRows read_estimates(const std::filesystem::path& path) {
  CsvRows file(path);
  const EstimateFields fields = estimate_fields(file.columns(), file.place());
  StateRows rows{fields.shape, {}, {}, {}, {}, {}};
  while (file.next()) {
    take_time(file.number(0, "time"), file.place(), rows.time);
    rows.state.push_back(state_in(file, fields.state, fields.shape));
    rows.covariance.push_back(covariance_in(file, fields));
    take_innovation(file, fields, rows);
  }
  return rows;
}

std::size_t rows_in(const std::filesystem::path& path) {
  const std::string text = text_file(path);
  std::size_t lines = 0;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t length = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, length);
    rest.remove_prefix(std::min(length + 1, rest.size()));
    if (!trimmed(line.substr(0, line.find('#'))).empty()) ++lines;
  }
  return lines - std::min<std::size_t>(lines, 1);  // the header
}

StateRows read_truth(const std::filesystem::path& path, const StateShape& shape) {
  CsvRows file(path);
  const std::vector<std::size_t> fields = truth_fields(file.columns(), shape, file.place());
  StateRows rows{shape, {}, {}, {}, {}, {}};
  while (file.next()) {
    take_time(file.number(0, "time"), file.place(), rows.time);
    rows.state.push_back(state_in(file, fields, shape));
  }
  if (!rows.time.empty()) return rows;
  throw StudyError(path.string() +
                   ": no rows behind the header (a truth of no time): write one row for each time");
}

Eigen::VectorXd truth_at(const StateRows& truth, double time, const TimeMatch& match,
                         const std::filesystem::path& estimate,
                         const std::filesystem::path& truths) {
  const auto after = std::ranges::lower_bound(truth.time, time);
  const auto right = static_cast<std::size_t>(after - truth.time.begin());
  const bool has_left = right > 0, has_right = right < truth.time.size();
  const double to_left = has_left ? time - truth.time[right - 1] : INFINITY;
  const double to_right = has_right ? truth.time[right] - time : INFINITY;
  if (std::min(to_left, to_right) <= match.tolerance) {
    return truth.state[to_right <= to_left ? right : right - 1];
  }
  if (match.interpolate && has_left && has_right) {
    return between(truth.shape, truth.state[right - 1], truth.state[right],
                   to_left / (to_left + to_right));
  }
  throw StudyError(estimate.string() + ": time " + to_text(time) + " s has no truth in " +
                   truths.string() + " (the nearest is " + to_text(std::min(to_left, to_right)) +
                   " s away, --tolerance is " + to_text(match.tolerance) + " s): " +
                   (has_left && has_right
                        ? "give truths at the times of the estimates, or say --interpolate, or a "
                          "larger --tolerance where times have few digits"
                        : "leave out what lies outside of the truth, or say a larger --tolerance "
                          "where times have few digits"));
}

std::optional<fs::path> innovations_beside(const fs::path& estimates) {
  const std::string wanted = "estimate";
  std::string name = estimates.filename().string();
  const std::size_t at = name.rfind(wanted);
  if (at == std::string::npos) return std::nullopt;
  name.replace(at, wanted.size(), "innovation");
  fs::path beside = estimates.parent_path() / fs::path(name).replace_extension(".csv");
  std::error_code ignored;
  if (!fs::is_regular_file(beside, ignored)) return std::nullopt;
  return beside;
}

void read_innovations(const fs::path& path, const fs::path& estimates, double tolerance,
                      StateRows& rows) {
  if (!rows.nis.empty()) {
    throw StudyError(path.string() + ": innovations, and " + estimates.string() +
                     " has nis too (which one is it?): remove one");
  }
  CsvRows file(path);
  const InnovationFields fields = innovation_fields(file.columns(), file.place());
  std::vector<double> nis(rows.time.size());
  std::vector<std::uint32_t> dof(rows.time.size());
  double before = -INFINITY;
  while (file.next()) {
    const double time = file.number(0, "time");
    if (time < before) {
      throw StudyError(file.place() + ": time " + to_text(time) +
                       " s is before that of the row above (rows go forward in time): sort them");
    }
    before = time;
    RowOfInnovations row;
    if (fields.whole) {
      row = squares_of(file, *fields.whole);
    } else {
      row.nis = file.number(fields.nis, "number");
      row.dof = checked_dof(row.nis, file.number(fields.nis_dof, "number"), file.place());
    }
    if (rows.time.empty()) continue;
    const std::size_t k = place_in(rows, time, tolerance, file, estimates);
    nis[k] += row.nis;
    dof[k] += row.dof;
  }
  rows.nis = std::move(nis);
  rows.nis_dof = std::move(dof);
}

}  // namespace montecarta::experiments
