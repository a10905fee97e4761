// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/truth_path.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/judging/scan_clock.hpp"
#include "experiments/text/words.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::experiments {
namespace {

/// Interpolates from state `a` (`share` = 0) to state `b` (`share` = 1).
Eigen::VectorXd between(const StateShape& shape, const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                        double share) {
  Eigen::VectorXd state = a + share * (b - a);
  for (Eigen::Index k = 0; k < state.size(); ++k) {
    if (is_angle(shape, k)) state(k) = wrap(a(k) + share * wrap(b(k) - a(k)));
  }
  if (shape.kind == StateKind::pose_in_space) {
    state.segment<4>(kQuaternionPlace) = quaternion_in(a).slerp(share, quaternion_in(b)).coeffs();
  }
  return state;
}

/// What estimates are compared with, in words.
std::string name_of_other(bool is_pair) { return is_pair ? "second estimate" : "truth"; }

/// File and line of a row, the line if it is known.
std::string place_of_row(const std::filesystem::path& path, const StateRows& rows,
                         std::size_t row) {
  if (row >= rows.line.size()) return path.string();
  return formatted("{}:{}", path, rows.line[row]);
}

/// What to do about an estimate without a truth at its time.
std::string remedy_of_time(bool is_inside, bool is_pair) {
  const std::string others =
      is_pair ? "both estimators the same times" : "truths at the times of the estimates";
  const std::string outside =
      is_pair ? "what only one estimator has" : "estimates outside of the truth";
  return (is_inside ? formatted("give {}, or use --interpolate, ", others)
                    : formatted("leave out {}, which --interpolate does, ", outside)) +
         "or use a larger --tolerance if times have few digits";
}

/// [s] Times that differ by less are the same, whatever the tolerance is.
constexpr double kSameTime = 1e-6;
/// Gaps of the truth that are this many times as long as usual are no path.
constexpr double kUsualGaps = 10.0;

}  // namespace

TruthPath::TruthPath(StateRows rows, std::filesystem::path path, const TimeMatch& match)
    : rows_(std::move(rows)),
      path_(std::move(path)),
      match_(match),
      usual_gap_(kUsualGaps * usual_spacing(rows_.time)),
      longest_gap_(match.longest_gap.value_or(usual_gap_)) {}

TrueState TruthPath::in_row(std::size_t row) const {
  if (rows_.covariance.empty()) return {rows_.state[row]};
  return {rows_.state[row], rows_.covariance[row]};
}

double TruthPath::end() const { return rows_.time.back() + match_.tolerance; }

/// The row of the truth nearest to `time`. Throws StudyError if it is farther away than the
/// tolerance.
std::size_t TruthPath::row_near(double time, const std::string& estimate) const {
  const auto after = std::ranges::lower_bound(rows_.time, time);
  auto row = static_cast<std::size_t>(after - rows_.time.begin());
  if (row == rows_.time.size() ||
      (row > 0 && time - rows_.time[row - 1] < rows_.time[row] - time)) {
    --row;
  }
  const double mismatch = std::abs(rows_.time[row] - time);
  if (mismatch <= match_.tolerance) return row;
  const bool is_inside = rows_.time.front() < time && time < rows_.time.back();
  throw StudyError(
      "{} has no {} in {} (the nearest is that of {} s, {} s away, --tolerance is {} s): {}",
      estimate, name_of_other(match_.is_pair), path_, to_text(rows_.time[row]), to_text(mismatch),
      to_text(match_.tolerance), remedy_of_time(is_inside, match_.is_pair));
}

/// The truth between the two rows around `time`; nullopt, counted in `use`, if there are none or
/// the gap between them is too long.
std::optional<TrueState> TruthPath::interpolated(double time, const std::string& estimate,
                                                 TruthUse& use) const {
  const auto after = std::ranges::lower_bound(rows_.time, time);
  const auto right = static_cast<std::size_t>(after - rows_.time.begin());
  const bool has_left = right > 0, has_right = right < rows_.time.size();
  if (has_right && rows_.time[right] - time <= kSameTime) return in_row(right);
  if (has_left && time - rows_.time[right - 1] <= kSameTime) return in_row(right - 1);
  if (!has_left || !has_right) {
    if (use.outside++ == 0) use.first_outside = estimate;
    return std::nullopt;
  }
  const double from = rows_.time[right - 1], to = rows_.time[right];
  if (to - from > longest_gap_) {
    if (use.in_gaps++ == 0) {
      use.first_gap = formatted("{} has no row from {} to {} s", path_, to_text(from), to_text(to));
    }
    return std::nullopt;
  }
  if (to - from > usual_gap_) use.longest_crossed = std::max(use.longest_crossed, to - from);
  const double share = (time - from) / (to - from);
  TrueState found{between(rows_.shape, rows_.state[right - 1], rows_.state[right], share)};
  if (rows_.covariance.empty()) return found;
  use.interpolates_covariance = true;
  found.covariance = (1.0 - share) * rows_.covariance[right - 1] + share * rows_.covariance[right];
  return found;
}

/// Adds how far the truth is from a straight line at the time of a position: s of the way between
/// rows at distance h, s (1 - s) h^2 / 2 times its acceleration, by the velocities before and
/// after.
void TruthPath::add_bend(const StateRows& estimates, std::size_t row, TruthUse& use) const {
  if (rows_.shape.kind == StateKind::vector || estimates.covariance.empty()) return;
  const Eigen::Index n = rows_.shape.kind == StateKind::pose ? 2 : 3;
  const double time = estimates.time[row];
  const auto after = std::ranges::lower_bound(rows_.time, time);
  const auto right = static_cast<std::size_t>(after - rows_.time.begin());
  if (right < 2 || right + 1 >= rows_.time.size()) return;
  const auto spacing = [&](std::size_t k) { return rows_.time[k] - rows_.time[k - 1]; };
  const auto velocity = [&](std::size_t k) {
    return Eigen::VectorXd((rows_.state[k] - rows_.state[k - 1]).head(n) / spacing(k));
  };
  const double apart = 0.5 * spacing(right - 1) + spacing(right) + 0.5 * spacing(right + 1);
  const Eigen::VectorXd acceleration = (velocity(right + 1) - velocity(right - 1)) / apart;
  const double before = time - rows_.time[right - 1], behind = rows_.time[right] - time;
  use.bend_squares += (0.5 * before * behind * acceleration).squaredNorm();
  use.claimed_squares += std::max(0.0, estimates.covariance[row].diagonal().head(n).sum());
  ++use.interpolated_positions;
}

std::vector<std::optional<TrueState>> TruthPath::at(const StateRows& estimates,
                                                    const std::filesystem::path& path,
                                                    TruthUse& use) const {
  require_common_time(estimates, path);
  std::vector<std::optional<TrueState>> found;
  std::optional<std::size_t> used;
  for (std::size_t k = 0; k < estimates.time.size(); ++k) {
    const double time = estimates.time[k];
    const std::string estimate =
        formatted("{}: time {} s", place_of_row(path, estimates, k), to_text(time));
    if (match_.interpolate) {
      found.push_back(interpolated(time, estimate, use));
      if (found.back()) add_bend(estimates, k, use);
      continue;
    }
    const std::size_t row = row_near(time, estimate);
    if (used == row) {
      throw StudyError(
          "{} and the time before have the same row of the {} ({}, {} s): use --interpolate, or a "
          "smaller --tolerance",
          estimate, name_of_other(match_.is_pair), place_of_row(path_, rows_, row),
          to_text(rows_.time[row]));
    }
    used = row;
    const double mismatch = std::abs(rows_.time[row] - time);
    if (mismatch > use.largest_mismatch) {
      use.largest_mismatch = mismatch;
      use.of_mismatch = estimate;
    }
    found.emplace_back(in_row(row));
  }
  const bool has_any = std::ranges::any_of(found, [](const auto& one) { return one.has_value(); });
  if (!has_any && !found.empty()) refuse_times(estimates, path);
  return found;
}

/// Throws StudyError if all estimates are before the truth, or all behind it.
void TruthPath::require_common_time(const StateRows& estimates,
                                    const std::filesystem::path& path) const {
  if (estimates.time.empty()) return;
  const bool is_apart = estimates.time.back() < rows_.time.front() - match_.tolerance ||
                        estimates.time.front() > rows_.time.back() + match_.tolerance;
  if (is_apart) refuse_times(estimates, path);
}

void TruthPath::refuse_times(const StateRows& estimates, const std::filesystem::path& path) const {
  throw StudyError(
      "{}: no estimate has a {} in {} ({} to {} s here, {} to {} s there): give both the same "
      "clock",
      path, name_of_other(match_.is_pair), path_, to_text(estimates.time.front()),
      to_text(estimates.time.back()), to_text(rows_.time.front()), to_text(rows_.time.back()));
}

/// A note on a truth that is no straight line between its rows; empty if it nearly is.
std::string TruthUse::note_on_bend(const std::string& other) const {
  constexpr double kLeastShare = 0.02;  // of the claimed squares, which it adds to the errors
  if (!(bend_squares > kLeastShare * claimed_squares)) return "";
  const auto n = static_cast<double>(interpolated_positions);
  return formatted(
      "the {} bends by {} m between its rows (root mean square; {} m are claimed for positions): "
      "straight lines between them err so much, and this counts as the estimate's error: give it "
      "at the times of the estimates, or more densely",
      other, compact(std::sqrt(bend_squares / n)), compact(std::sqrt(claimed_squares / n)));
}

std::vector<std::string> TruthUse::notes(bool is_pair) const {
  const std::string other = name_of_other(is_pair);
  std::vector<std::string> all;
  if (largest_mismatch > kSameTime) {
    all.push_back(
        formatted("{}s were taken up to {} s beside their estimates ({}): --interpolate takes them "
                  "at their times",
                  other, to_text(largest_mismatch), of_mismatch));
  }
  if (in_gaps > 0) {
    all.push_back(
        formatted("{} estimates lie in gaps of the {} and are missing ({}): --longest-gap SECONDS "
                  "sets what is interpolated",
                  in_gaps, other, first_gap));
  }
  if (longest_crossed > 0.0) {
    all.push_back(
        formatted("the {} was interpolated across a gap of {} s, far longer than usual: its own "
                  "error there counts as the estimate's",
                  other, to_text(longest_crossed)));
  }
  if (const std::string bend = note_on_bend(other); !bend.empty()) all.push_back(bend);
  if (interpolates_covariance) {
    all.push_back(formatted(
        "between its rows the errors of the {} were taken as those of its neighbours (they change "
        "little from row to row): if they are independent, give it at the times of the estimates",
        other));
  }
  if (outside > 0) {
    all.push_back(
        formatted("{} estimates lie before or after the {} and are missing, the first in {}",
                  outside, other, first_outside));
  }
  return all;
}

}  // namespace montecarta::experiments
