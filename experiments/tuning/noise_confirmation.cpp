// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/tuning/noise_confirmation.hpp"

#include "analysis/run/nees.hpp"
#include "analysis/statistics/conformal.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/spread.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "analysis/verdict/innovations.hpp"
#include "engine/core/judgement.hpp"
#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/tuning/filter_on_drive.hpp"
#include "experiments/tuning/noise_factors.hpp"
#include "experiments/tuning/reference_half.hpp"
#include "experiments/tuning/scores.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

namespace montecarta::experiments {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Stretches of the second halves, whose scores count as independent.
constexpr std::size_t kStretchesToConfirm = 20;
/// The same of errors at fixes, which last longer than innovations.
constexpr std::size_t kStretchesOfFixes = 10;

/// The cells of a confirming study.
enum CellToConfirm : std::size_t { as_it_was, tuned };

/// NEES of the pose on the scale of three components; infinite if it is unusable.
double nees_of(const PoseEstimate& estimate, const Pose& truth) {
  const PoseMoments& judged = judged_moments(estimate);
  const Nees sample = nees<3>(boxminus(judged.mean, truth), judged.covariance);
  if (!sample.is_usable()) return kInfinity;
  return sample.rank == 0 ? 0.0 : on_full_scale(sample, 3);
}

/// What one run says of one cell.
struct ConfirmedRun {
  bool is_whole = false;  ///< false if the filter failed
  double score = kNaN;    ///< mean log score; NaN if there is none
  double nees_at_end = kInfinity, largest_nees = kInfinity;
};

/// `first` is the number of the first scan that is judged.
ConfirmedRun confirmed_run(const StudyPlan& plan, std::uint64_t run, const Drive& drive,
                           const Cell& cell, std::size_t first) {
  const Itinerary& itinerary = plan.drives->itinerary_of(run);
  ScoreSum score;
  double last = 0.0, largest = 0.0;
  const std::unique_ptr<SlamFilter> filter = cell.make_filter();
  const bool is_whole = run_filter({plan, run, drive, itinerary.scans()}, *filter,
                                   [&](std::size_t scan, const SlamFilter& now, bool /*is_given*/) {
                                     if (scan < first) return;
                                     const PoseEstimate estimate = now.estimate();
                                     const Pose& truth = drive.truth[itinerary.scan_step[scan]];
                                     const double one = pose_score(estimate, truth);
                                     if (!std::isnan(one)) score.add(one);
                                     last = nees_of(estimate, truth);
                                     largest = std::max(largest, last);
                                   });
  if (!is_whole) return {};
  return {true, score.mean(), last, largest};
}

/// The mean of the differences, which are worth at most `effective` independent ones.
ScoreDifference mean_difference(const std::vector<double>& differences,
                                double effective = kInfinity) {
  SummaryOf sums;
  for (const double difference : differences) {
    if (!std::isnan(difference)) sums.add(difference);
  }
  const Summary summary = sums.result();
  const double n = std::min(static_cast<double>(summary.n), std::max(effective, 1.0));
  const double half = t_of_samples(n) * summary.sd / std::sqrt(n);
  return {summary.mean, {summary.mean - half, summary.mean + half}};
}

/// Scores of one cell in stretches of the second half of one drive.
struct ScoredHalf {
  std::array<ScoreSum, kStretchesToConfirm> scores;
  bool is_whole = false;
};

/// Innovations of one cell in the second half of one drive.
struct SecondHalf : ScoredHalf {
  std::vector<double> times, nis;
  std::vector<std::uint32_t> dof;
};

/// Errors of one cell at the fixes of the second half of one drive.
struct SecondFixes : ScoredHalf {
  DriveScores drive;
};

SecondFixes second_fixes(const StudyPlan& plan, std::uint64_t run, const Drive& drive,
                         const Cell& cell) {
  const Itinerary& itinerary = plan.drives->itinerary_of(run);
  const ReferenceHalf half(itinerary, drive, DriveHalf::second);
  SecondFixes found;
  const auto estimates = half.estimates_on({plan, run, drive, half.scans()}, *cell.make_filter());
  found.is_whole = estimates.has_value();
  if (!estimates) return found;
  const std::vector<double> scores = half.log_scores(*estimates);
  for (std::size_t f = 0; f < scores.size(); ++f)
    found.scores[f * kStretchesOfFixes / scores.size()].add(scores[f]);
  found.drive = half.drive_scores(itinerary, *estimates, cell.particles);
  return found;
}

SecondHalf second_half(const StudyPlan& plan, std::uint64_t run, const Drive& drive,
                       const Cell& cell, const InnovationScore& score) {
  const Itinerary& itinerary = plan.drives->itinerary_of(run);
  const std::size_t scans = itinerary.scans(), half = scans / 2;
  SecondHalf found;
  const std::unique_ptr<SlamFilter> filter = cell.make_filter();
  found.is_whole =
      run_filter({plan, run, drive, scans}, *filter,
                 [&](std::size_t scan, const SlamFilter& now, bool /*is_given*/) {
                   if (scan < half) return;
                   const ScanReport& report = now.report();
                   found.scores[(scan - half) * kStretchesToConfirm / (scans - half)].add(
                       score(report, drive.scan(scan)));
                   found.times.push_back(itinerary.step_time[itinerary.scan_step[scan]]);
                   found.nis.push_back(report.nis);
                   found.dof.push_back(report.nis_dof);
                 });
  return found;
}

/// Number of runs, or of drives, in which the filter of one cell failed.
template <class Findings>
std::uint64_t failed_in(const std::vector<std::array<Findings, 2>>& runs, CellToConfirm cell) {
  const auto n = std::ranges::count_if(runs, [&](const auto& run) { return !run[cell].is_whole; });
  return static_cast<std::uint64_t>(n);
}

/// Differences of the mean scores of each stretch.
void add_differences(const ScoredHalf& before, const ScoredHalf& after,
                     std::vector<double>& differences) {
  for (std::size_t k = 0; k < kStretchesToConfirm; ++k) {
    const ScoreSum &old_score = before.scores[k], &new_score = after.scores[k];
    const bool is_there = before.is_whole && after.is_whole && new_score.n > 0.0;
    differences.push_back(is_there ? old_score.mean() - new_score.mean() : kNaN);
  }
}

/// Takes the verdict on the innovations of all second halves in which the filter did not fail.
/// Whiteness and size are judged together (STATISTICS 9).
void judge_innovations(std::vector<SecondHalf> halves, double within,
                       TuningConfirmation& confirmation) {
  constexpr double kLevelOfEach = 1.0 - (1.0 - kUsualLevel) / 2.0;
  std::erase_if(halves, [](const SecondHalf& half) { return !half.is_whole; });
  std::size_t scans = 0, longest = 0;
  for (std::size_t run = 0; run < halves.size(); ++run) {
    if (halves[run].times.size() > scans) longest = run;
    scans = std::max(scans, halves[run].times.size());
  }
  const std::vector<double> times = halves.empty() ? std::vector<double>() : halves[longest].times;
  InnovationSums sums(scans);
  for (std::size_t run = 0; run < halves.size(); ++run) {
    SecondHalf& half = halves[run];
    half.nis.resize(scans);
    half.dof.resize(scans);
    half.times.resize(scans);
    sums.add(run, half.times, half.nis, half.dof);
  }
  if (sums.empty()) {
    confirmation.verdict = "not judged, since there are none";
    return;
  }
  const Innovations found = sums.result(times, kLevelOfEach, within);
  confirmation.answer =
      found.whiteness() == Whiteness::not_white && found.verdict.answer == Answer::consistent
          ? Answer::inconsistent
          : found.verdict.answer;
  confirmation.verdict = formatted("{}, with a NIS of {} per component, where 1 is right",
                                   whiteness_in_words(found), readable(found.ratio));
}

}  // namespace

Study confirming_study(const Study& study, const CellSpec& cell, const TunedNoise& noise,
                       std::uint64_t seed) {
  return study_of_cells(
      study,
      {cell, with_noise(cell, {noise.motion.value, noise.sensor.value}, cell.label + "_tuned")},
      study.settings.count("study", "runs"), seed);
}

TuningConfirmation confirm_on_runs(const Study& study, const StudyPlan& plan,
                                   const Parallel& parallel) {
  std::vector<std::array<ConfirmedRun, 2>> runs(plan.runs);
  parallel.for_each(runs.size(), [&](std::size_t run) {
    Drive drive;
    plan.drives->generate(run, drive);
    const std::size_t first = first_judged_scan(study, plan.drives->itinerary_of(run));
    for (std::size_t cell = 0; cell < 2; ++cell)
      runs[run][cell] = confirmed_run(plan, run, drive, plan.cells[cell], first);
  });
  std::vector<double> gains, at_end, of_path;
  for (const auto& run : runs) {
    gains.push_back(run[as_it_was].score - run[tuned].score);
    at_end.push_back(run[tuned].nees_at_end);
    of_path.push_back(run[tuned].largest_nees);
  }
  const double quantile = chi_squared_quantile(kUsualLevel, 3.0);
  return {.runs = plan.runs,
          .seed = plan.seed,
          .failed_before = failed_in(runs, as_it_was),
          .failed_after = failed_in(runs, tuned),
          .gain = mean_difference(gains),
          .covering_at_end = conformal_bound(at_end, kUsualLevel) / quantile,
          .covering_path = conformal_bound(of_path, kUsualLevel) / quantile};
}

namespace {

/// Calls find(run, drive, cell) for both cells on each recorded drive.
template <class Findings, class Find>
std::vector<std::array<Findings, 2>> of_both_cells(const StudyPlan& plan, const Parallel& parallel,
                                                   const Find& find) {
  std::vector<std::array<Findings, 2>> halves(std::max<std::size_t>(plan.drives->own_drives(), 1));
  parallel.for_each(halves.size(), [&](std::size_t run) {
    Drive drive;
    plan.drives->generate(run, drive);
    for (std::size_t cell = 0; cell < 2; ++cell) halves[run][cell] = find(run, drive, cell);
  });
  return halves;
}

}  // namespace

TuningConfirmation confirm_by_innovations(const Study& study, const StudyPlan& plan,
                                          const Parallel& parallel) {
  auto halves = of_both_cells<SecondHalf>(
      plan, parallel, [&](std::size_t run, const Drive& drive, std::size_t cell) {
        return second_half(plan, run, drive, plan.cells[cell],
                           InnovationScore(study, study.cells[cell]));
      });
  const std::uint64_t before = failed_in(halves, as_it_was), after = failed_in(halves, tuned);
  std::vector<double> gains;
  std::vector<SecondHalf> of_tuned;
  for (auto& half : halves) {
    add_differences(half[as_it_was], half[tuned], gains);
    of_tuned.push_back(std::move(half[tuned]));
  }
  TuningConfirmation confirmation{.runs = halves.size(),
                                  .failed_before = before,
                                  .failed_after = after,
                                  .gain = mean_difference(gains),
                                  .covering_at_end = kNaN,
                                  .covering_path = kNaN};
  judge_innovations(std::move(of_tuned), study.settings.number("study", "within"), confirmation);
  return confirmation;
}

TuningConfirmation confirm_by_reference(const Study& study, const StudyPlan& plan,
                                        const Parallel& parallel) {
  const auto halves = of_both_cells<SecondFixes>(
      plan, parallel, [&](std::size_t run, const Drive& drive, std::size_t cell) {
        return second_fixes(plan, run, drive, plan.cells[cell]);
      });
  std::vector<double> gains;
  std::vector<DriveScores> of_tuned;
  for (const auto& half : halves) {
    add_differences(half[as_it_was], half[tuned], gains);
    if (half[tuned].is_whole) of_tuned.push_back(half[tuned].drive);
  }
  const double within = study.settings.number("study", "within");
  const DriveConsistency found = halves.size() == 1
                                     ? judge_drive(of_tuned, kUsualLevel, within)
                                     : judge_own_drives(of_tuned, kUsualLevel, within);
  const double effective = found.mean.leads().effective_samples;
  return {.runs = halves.size(),
          .failed_before = failed_in(halves, as_it_was),
          .failed_after = failed_in(halves, tuned),
          .gain = mean_difference(gains, effective),
          .answer = found.answer,
          .verdict = in_words(found),
          .covering_at_end = kNaN,
          .covering_path = kNaN,
          .fixes = found.mean.fixes,
          .effective = effective};
}

}  // namespace montecarta::experiments
