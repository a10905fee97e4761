// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/noise_landscape.hpp"

#include "analysis/statistics/conformal.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "engine/core/judgement.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "experiments/tuning/filter_on_drive.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace montecarta::experiments {
namespace {

/// Fewest parts into which recorded drives are divided. Errors of the pose last longer than
/// innovations, and neighbouring stretches must hardly depend on each other.
constexpr std::uint64_t kStretches = 20, kStretchesOfErrors = 10;

std::size_t parts_of_a_run(TuningScore score, std::uint64_t runs) {
  if (score == TuningScore::truth) return 1;
  const auto parts = score == TuningScore::reference ? kStretchesOfErrors : kStretches;
  return (parts + runs - 1) / runs;
}

/// Fewest scans that a run must have for each scan of a prediction interval, or a stretch of a
/// drive.
constexpr std::size_t kFewestScans = 2;
/// Fewest fixes of a reference in a stretch of a drive.
constexpr std::size_t kFewestFixes = 2;

std::uint64_t runs_to_learn_from(const Study& study, const StudyPlan& plan, TuningScore score) {
  if (score != TuningScore::truth) return std::max<std::uint64_t>(plan.drives->own_drives(), 1);
  const std::uint64_t fewest = fewest_for_bound(kUsualLevel);
  if (plan.runs >= fewest) return plan.runs;
  throw StudyError(
      "{}: runs = {} (too few to choose noise by): give {} or more, e.g. --set study.runs=200",
      study.settings.place("study", "runs"), plan.runs, fewest);
}

}  // namespace

double factor_at(int place) { return std::pow(2.0, static_cast<double>(place) / kOctave); }

NoiseFactors factors_at(const LatticePoint& point) {
  return {factor_at(point.motion), factor_at(point.sensor)};
}

NoiseLandscape::NoiseLandscape(const Study& study, const CellSpec& cell, TuningScore score,
                               const Parallel& parallel)
    : study_(study_of_cells(study, {cell}, study.settings.count("study", "runs"),
                            study.settings.count("study", "seed"))),
      cell_(cell),
      parallel_(parallel),
      plan_(make_plan(study_)),
      score_(score),
      runs_(runs_to_learn_from(study, plan_, score)),
      parts_of_run_(parts_of_a_run(score, runs_)) {
  find_intervals(study);
  if (score_ == TuningScore::reference) take_references();
}

void NoiseLandscape::find_intervals(const Study& study) {
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (std::uint64_t run = 0; run < runs_; ++run)
    fewest = std::min(fewest, scans_of(run) - first_scan_of(run));
  for (std::size_t k = 0; k < kPredictionIntervals.size(); ++k) {
    if (fewest >= kFewestScans * kPredictionIntervals[k] * parts_of_run_) intervals_.push_back(k);
  }
  if (!intervals_.empty()) return;
  throw StudyError(
      "{}: {} scans (too few to choose noise by): take a longer drive, with at least {} {}",
      study.settings.place("study", "name"), fewest, kFewestScans * parts_of_run_,
      has_truth() ? "scans" : "scans in its first half");
}

void NoiseLandscape::take_references() {
  for (std::uint64_t run = 0; run < runs_; ++run) {
    Drive drive;
    plan_.drives->generate(run, drive);
    const ReferenceHalf& half =
        references_.emplace_back(plan_.drives->itinerary_of(run), drive, DriveHalf::first);
    const std::string place = formatted("{}: drive {}", cell_.place, run + 1);
    const std::size_t n = half.fixes().times().size();
    if (n < kFewestFixes * parts_of_run_) {
      throw StudyError(
          "{}: {} fixes of reference {} in its first half (too few to choose noise by): take a "
          "reference with {} or more there, or add --by innovations",
          place, n, half.fixes().name(), kFewestFixes * parts_of_run_);
    }
    const Cell& cell = plan_.cells.front();
    const auto estimates = estimates_of(cell, run);
    if (!estimates) continue;
    refuse_strange_reference(half, *estimates, place);
    const DriveScores scores =
        half.drive_scores(plan_.drives->itinerary_of(run), *estimates, cell.particles);
    fixes_ += scores.fixes;
    outliers_ += scores.outliers;
  }
}

std::size_t NoiseLandscape::scans_of(std::uint64_t run) const {
  const std::size_t scans = plan_.drives->itinerary_of(run).scans();
  return has_truth() ? scans : scans / 2;
}

std::size_t NoiseLandscape::first_scan_of(std::uint64_t run) const {
  return first_judged_scan(study_, plan_.drives->itinerary_of(run));
}

void NoiseLandscape::compute(std::span<const LatticePoint> points, std::uint64_t runs) {
  std::vector<ScoredPoint*> lacking;
  std::vector<CellSpec> cells;
  for (const LatticePoint& where : points) {
    ScoredPoint& point = points_[where];
    if (point.runs(parts_of_run_) >= runs) continue;
    if (std::ranges::count(lacking, &point) > 0) continue;
    lacking.push_back(&point);
    cells.push_back(with_noise(cell_, factors_at(where), cell_.label));
  }
  if (cells.empty()) return;
  study_.cells = std::move(cells);
  const StudyPlan plan = make_plan(study_);
  std::vector<Work> work;
  for (std::size_t k = 0; k < lacking.size(); ++k) {
    work.push_back({lacking[k], lacking[k]->runs(parts_of_run_), &plan.cells[k],
                    InnovationScore(study_, study_.cells[k])});
    lacking[k]->parts.resize(runs * parts_of_run_);
    lacking[k]->has_failed.resize(runs * kPredictionIntervals.size());
  }
  compute(work, runs);
}

void NoiseLandscape::compute(const std::vector<Work>& work, std::uint64_t runs) const {
  const std::uint64_t first = std::ranges::min_element(work, {}, &Work::first_run)->first_run;
  parallel_.for_each(runs - first, [&](std::size_t i) {
    const std::uint64_t run = first + i;
    Drive drive;
    plan_.drives->generate(run, drive);
    parallel_.for_each(work.size() * intervals_.size(), [&](std::size_t task) {
      const Work& here = work[task / intervals_.size()];
      if (run >= here.first_run) score(here, run, drive, intervals_[task % intervals_.size()]);
    });
  });
}

void NoiseLandscape::score(const Work& work, std::uint64_t run, const Drive& drive,
                           std::size_t interval) const {
  const DrivePart part{plan_, run, drive, scans_of(run), kPredictionIntervals[interval]};
  const bool is_whole = score_ == TuningScore::reference ? score_fixes(work, part, interval)
                                                         : score_scans(work, part, interval);
  work.point->has_failed[run * kPredictionIntervals.size() + interval] = is_whole ? 0 : 1;
}

ScoreSum& NoiseLandscape::scores_at(const Work& work, std::uint64_t run, std::size_t part,
                                    std::size_t interval) const {
  return work.point->parts[run * parts_of_run_ + part][interval];
}

bool NoiseLandscape::score_scans(const Work& work, const DrivePart& part,
                                 std::size_t interval) const {
  const Itinerary& itinerary = plan_.drives->itinerary_of(part.run);
  const std::size_t first = first_scan_of(part.run);
  const std::unique_ptr<SlamFilter> filter = work.cell->make_filter();
  return run_filter(part, *filter, [&](std::size_t scan, const SlamFilter& now, bool is_given) {
    if (scan < first || (!has_truth() && !is_given)) return;
    const double score =
        has_truth() ? pose_score(now.estimate(), part.drive.truth[itinerary.scan_step[scan]])
                    : work.innovation_score(now.report(), part.drive.scan(scan));
    if (std::isnan(score)) return;
    scores_at(work, part.run, scan * parts_of_run_ / part.scans, interval).add(score);
  });
}

bool NoiseLandscape::score_fixes(const Work& work, const DrivePart& part,
                                 std::size_t interval) const {
  const ReferenceHalf& half = references_[part.run];
  const auto estimates = half.estimates_on(part, *work.cell->make_filter());
  if (!estimates) return false;
  const std::vector<double> scores = half.log_scores(*estimates);
  for (std::size_t f = 0; f < scores.size(); ++f)
    scores_at(work, part.run, f * parts_of_run_ / scores.size(), interval).add(scores[f]);
  return true;
}

std::optional<RunRows> NoiseLandscape::estimates_of(const Cell& cell, std::uint64_t run) const {
  Drive drive;
  plan_.drives->generate(run, drive);
  return references_[run].estimates_on({plan_, run, drive, scans_of(run)}, *cell.make_filter());
}

double NoiseLandscape::effective_samples(const LatticePoint& point) const {
  if (score_ != TuningScore::reference) return static_cast<double>(parts());
  Study study = study_;
  study.cells = {with_noise(cell_, factors_at(point), cell_.label)};
  const StudyPlan plan = make_plan(study);
  std::vector<DriveScores> scores;
  for (std::uint64_t run = 0; run < runs_; ++run) {
    const Cell& cell = plan.cells.front();
    if (const auto estimates = estimates_of(cell, run)) {
      scores.push_back(references_[run].drive_scores(plan_.drives->itinerary_of(run), *estimates,
                                                     cell.particles));
    }
  }
  return judge_own_drives(scores, kUsualLevel, kUsualMargin).mean.leads().effective_samples;
}

double NoiseLandscape::mean(const LatticePoint& where, std::uint64_t runs,
                            const Intervals& intervals) const {
  const ScoredPoint& point = points_.at(where);
  ScoreSum all;
  for (const std::size_t interval : intervals) {
    for (std::size_t part = 0; part < runs * parts_of_run_; ++part)
      all.add(point.parts[part][interval]);
  }
  const bool is_scored = all.n > 0.0 && !has_failed(where, runs, intervals);
  return is_scored ? all.mean() : std::numeric_limits<double>::infinity();
}

bool NoiseLandscape::has_failed(const LatticePoint& where, std::uint64_t runs,
                                const Intervals& intervals) const {
  const std::vector<std::uint8_t>& failures = points_.at(where).has_failed;
  for (const std::size_t interval : intervals) {
    for (std::uint64_t run = 0; run < runs; ++run) {
      if (failures[run * kPredictionIntervals.size() + interval] != 0) return true;
    }
  }
  return false;
}

std::vector<double> NoiseLandscape::shares(const LatticePoint& where,
                                           const Intervals& intervals) const {
  std::vector<double> shares;
  double n = 0.0;
  for (const PartScores& part : points_.at(where).parts) {
    ScoreSum all;
    for (const std::size_t interval : intervals) all.add(part[interval]);
    shares.push_back(all.sum);
    n += all.n;
  }
  for (double& share : shares) share *= static_cast<double>(parts()) / n;
  return shares;
}

}  // namespace montecarta::experiments
