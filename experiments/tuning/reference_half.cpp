// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/reference_half.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace montecarta::experiments {
namespace {

std::size_t half_of(std::size_t scans) { return scans / 2; }

/// Number of steps until scan number `scans` - 1 has been taken.
std::size_t steps_until(const Itinerary& itinerary, std::size_t scans) {
  return scans == 0 ? 0 : itinerary.scan_step[scans - 1] + 1;
}

/// The fixes of the reference in one half: until the last scan of the first half, or after it.
ReferencePath fixes_in(const Itinerary& itinerary, DriveHalf half) {
  constexpr double kExact = 1e-6;  // [m, rad] deviation that stands for none
  const ReferencePath& all = *reference_to_tune_by(itinerary);
  const std::size_t steps = steps_until(itinerary, half_of(itinerary.scans()));
  const double middle = steps == 0 ? 0.0 : itinerary.step_time[steps - 1];
  ReferencePath part{.name = all.name, .time = {}, .position = {}, .heading = {}};
  for (std::size_t f = 0; f < all.time.size(); ++f) {
    if ((all.time[f] <= middle) != (half == DriveHalf::first)) continue;
    part.time.push_back(all.time[f]);
    part.position.push_back(all.position[f]);
    if (!all.heading.empty()) part.heading.push_back(all.heading[f]);
    part.covariance.push_back(all.covariance.empty()
                                  ? Eigen::Matrix3d(kExact * kExact * Eigen::Matrix3d::Identity())
                                  : all.covariance[f]);
  }
  return part;
}

ErrorBlock block_of(const PathAtFixes& fixes) {
  return fixes.headings().empty() ? ErrorBlock::position : ErrorBlock::pose;
}

void write_moments(const PoseMoments& moments, std::size_t row, MomentRows& rows) {
  const std::array<double, 3> mean{moments.mean.x, moments.mean.y, moments.mean.heading};
  std::ranges::copy(mean, rows.mean.begin() + static_cast<std::ptrdiff_t>(3 * row));
  std::ranges::copy(moments.covariance.reshaped(),
                    rows.covariance.begin() + static_cast<std::ptrdiff_t>(9 * row));
}

MomentRows empty_moments(std::size_t rows) {
  return {std::vector<double>(3 * rows), std::vector<double>(9 * rows)};
}

/// [m] Root of the mean squared distance of the fixes from their centre.
double spread_of(const std::vector<Eigen::Vector2d>& positions) {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& position : positions) centre += position;
  centre /= static_cast<double>(positions.size());
  double sum = 0.0;
  for (const Eigen::Vector2d& position : positions) sum += (position - centre).squaredNorm();
  return std::sqrt(sum / static_cast<double>(positions.size()));
}

/// Returns whether the median of the NEES of a block says that errors are more than ten times as
/// large as claimed.
bool are_far_larger(const ReferenceHalf& half, const RunRows& estimates, ErrorBlock block) {
  const FixErrors errors = errors_at_fixes(half.fixes(), {}, estimates, 0, block);
  if (errors.nees.empty()) return false;
  const double usual = chi_squared_quantile(0.5, static_cast<double>(dimension_of(block)));
  return median_of(errors.nees) > kGrossDeviations * kGrossDeviations * usual;
}

}  // namespace

const ReferencePath* reference_to_tune_by(const Itinerary& itinerary) {
  const std::vector<ReferencePath>& all = itinerary.references;
  if (all.empty()) return nullptr;
  const auto found =
      std::ranges::find_if(all, [](const ReferencePath& path) { return !path.covariance.empty(); });
  return found == all.end() ? &all.front() : &*found;
}

ReferenceHalf::ReferenceHalf(const Itinerary& itinerary, const Drive& drive, DriveHalf half)
    : ReferenceHalf(itinerary, drive, half,
                    half == DriveHalf::first ? half_of(itinerary.scans()) : itinerary.scans()) {}

ReferenceHalf::ReferenceHalf(const Itinerary& itinerary, const Drive& drive, DriveHalf half,
                             std::size_t scans)
    : scans_(scans),
      steps_(steps_until(itinerary, scans)),
      fixes_(fixes_in(itinerary, half), std::span(itinerary.step_time).first(steps_),
             itinerary.start, drive.prior.value_or(Prior()).pose.covariance),
      is_needed_(steps_) {
  for (const PathAtFixes::FixPlace& place : fixes_.places()) {
    is_needed_[place.next] = true;
    if (place.next > 0) is_needed_[place.next - 1] = true;
  }
}

std::optional<RunRows> ReferenceHalf::estimates_on(const DrivePart& part,
                                                   SlamFilter& filter) const {
  RunRows rows;
  rows.path.spread = empty_moments(steps_);
  const auto after_scan = [&](std::size_t /*scan*/, const SlamFilter& now, bool /*is_given*/) {
    rows.ess.push_back(now.report().ess);
  };
  const auto after_step = [&](std::size_t step, const SlamFilter& now) {
    if (!is_needed_[step]) return;
    const PoseEstimate estimate = now.estimate();
    write_moments(estimate.spread, step, rows.path.spread);
    if (!estimate.mixture) return;
    if (rows.path.mixture.mean.empty()) rows.path.mixture = empty_moments(steps_);
    write_moments(*estimate.mixture, step, rows.path.mixture);
  };
  if (!run_filter(part, filter, after_scan, after_step)) return std::nullopt;
  return rows;
}

std::vector<double> ReferenceHalf::log_scores(const RunRows& estimates) const {
  const ErrorBlock block = block_of(fixes_);
  const FixErrors errors = errors_at_fixes(fixes_, {}, estimates, 0, block);
  const double constant =
      static_cast<double>(dimension_of(block)) * std::log(2.0 * std::numbers::pi);
  std::vector<double> scores;
  for (std::size_t f = 0; f < errors.nees.size(); ++f)
    scores.push_back((errors.nees[f] + errors.log_determinant[f] + constant) / 2.0);
  return scores;
}

DriveScores ReferenceHalf::drive_scores(const Itinerary& itinerary, const RunRows& estimates,
                                        std::size_t particles) const {
  return analysis::drive_scores(fixes_, std::span(itinerary.scan_step).first(scans_), estimates,
                                particles, kUsualLevel);
}

void refuse_strange_reference(const ReferenceHalf& half, const RunRows& estimates,
                              const std::string& place) {
  const PathAtFixes& fixes = half.fixes();
  if (fixes.times().empty()) return;
  const std::vector<Pose> poses = fixes.interpolate(estimates.path.mean());
  std::vector<double> distances, turns;
  for (std::size_t f = 0; f < poses.size(); ++f) {
    distances.push_back((Eigen::Vector2d(poses[f].x, poses[f].y) - fixes.positions()[f]).norm());
    if (!fixes.headings().empty())
      turns.push_back(std::abs(wrap(poses[f].heading - fixes.headings()[f])));
  }
  const double apart = median_of(distances), spread = spread_of(fixes.positions());
  if (apart > spread / 2.0 && are_far_larger(half, estimates, ErrorBlock::position)) {
    throw StudyError(
        "{}: reference {} is {} m from the estimate (the median; its fixes lie {} m about their "
        "centre, and no noise explains that): correct unit, frame or times of the reference, or "
        "the start",
        place, fixes.name(), readable(apart), readable(spread));
  }
  if (turns.empty() || median_of(turns) < std::numbers::pi / 4.0) return;
  if (!are_far_larger(half, estimates, ErrorBlock::heading)) return;
  throw StudyError(
      "{}: the headings of reference {} are {} deg from the estimate (the median; no noise "
      "explains that): give radians, counter-clockwise from the x axis, or leave the headings out",
      place, fixes.name(), readable(median_of(turns) * 180.0 / std::numbers::pi));
}

}  // namespace montecarta::experiments
