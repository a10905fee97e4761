// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/judged_study.hpp"

#include "analysis/run/nees.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/posix_file.hpp"
#include "experiments/judging/anchored_runs.hpp"
#include "experiments/judging/difference_bound.hpp"
#include "experiments/judging/imported_plan.hpp"
#include "experiments/judging/likely_mistakes.hpp"
#include "experiments/judging/scan_clock.hpp"
#include "experiments/judging/unusable_rows.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <span>
#include <system_error>
#include <utility>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// Throws StudyError if a file has another state than the first one, or innovations and the first
/// one not.
void require_alike(const StateRows& rows, const fs::path& path, const StateRows& first,
                   const fs::path& first_path) {
  if (rows.shape != first.shape) {
    throw StudyError("{}: another state than in {} (one study judges one state): judge them apart",
                     path, first_path);
  }
  if (rows.time.empty() || rows.nis.empty() == first.nis.empty()) return;
  throw StudyError("{}: {} (in {} it is otherwise): give it in all files or in none", path,
                   rows.nis.empty() ? "no nis" : "has nis", first_path);
}

/// The estimates of one file, with the scan and the truth of each row.
struct MatchedRows {
  StateRows rows;
  std::vector<std::size_t> scans;                ///< {row}
  std::vector<std::optional<TrueState>> truths;  ///< {row} nullopt: the estimate is left out
  /// [s] Last time with a truth; infinite if the truth is known at the times of estimates only.
  double truth_end = std::numeric_limits<double>::infinity();
};

Pose pose_in(const Eigen::VectorXd& state) { return {state(0), state(1), wrap(state(2))}; }

/// Writes the elements of a matrix, row by row, to its scan.
void put_rows(const Eigen::MatrixXd& matrix, std::size_t scan, std::span<double> column) {
  auto out =
      column.begin() + static_cast<std::ptrdiff_t>(scan * static_cast<std::size_t>(matrix.size()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) *out++ = matrix(i, j);
  }
}

constexpr double kUnknownCost = std::numeric_limits<double>::quiet_NaN();

/// Marks a run as complete, or as failed if it ends although other runs and its truth go on. If
/// runs have clocks of their own, only a run without estimates is known to have failed.
void end_run(const MatchedRows& run, const ScanClock& clock, std::size_t cell, RunRecord& record) {
  const std::size_t next = run.scans.empty() ? 0 : run.scans.back() + 1;
  const auto goes_on = [&] {
    const auto missed = clock.missed_after(run.rows.time.back(), cell);
    return missed && *missed <= run.truth_end;
  };
  const bool is_failed = run.scans.empty() || goes_on();
  if (!is_failed) return record.mark_complete(kUnknownCost);
  const std::string reason =
      run.scans.empty() ? "no estimates"
                        : formatted("estimates end at {} s", to_text(run.rows.time.back()));
  record.mark_failed(static_cast<std::uint32_t>(next), reason, kUnknownCost);
}

/// Writes the NEES of a row under every convention of the state, if the file has columns for them.
void put_conventions(const MatchedRows& run, std::size_t row, RunRecord& record) {
  const StateShape& shape = run.rows.shape;
  for (const ErrorConvention convention : conventions_of(shape.kind)) {
    const auto column = record.layout().find(nees_column(convention));
    if (!column) return;
    const Eigen::VectorXd error =
        error_of(shape, convention, run.rows.state[row], run.truths[row]->state);
    const analysis::Nees nees = analysis::imported_nees(error, run.rows.covariance[row]);
    record.column<double>(*column)[run.scans[row]] =
        analysis::on_full_scale(nees, shape.dimension());
  }
}

/// Writes the pose of a row, moved by the truth's motion from the row's own time to `truth`, which
/// is the truth of the scan: so its error stays that at its own time.
void put_pose(const MatchedRows& run, std::size_t row, const Pose& truth,
              ErrorConvention convention, RunRecord& record) {
  const auto column = [&](const char* name) {
    return record.column<double>(*record.layout().find(name));
  };
  const Pose own = pose_in(run.truths[row]->state);
  Pose mean = pose_in(run.rows.state[row]);
  mean.x += truth.x - own.x;
  mean.y += truth.y - own.y;
  if (truth.heading != own.heading) mean.heading = wrap(mean.heading + truth.heading - own.heading);
  const std::size_t s = run.scans[row];
  put_rows(Eigen::Vector3d(mean.x, mean.y, mean.heading), s, column("pose_mean"));
  put_rows(covariance_in_map(convention, run.rows.state[row], run.rows.covariance[row]), s,
           column("pose_covariance"));
}

/// The record of one run of one estimator, with the errors of the `judged` components. Scans
/// without an estimate stay NaN, and are missing.
RunRecord record_of(const RecordLayout& layout, const MatchedRows& run,
                    const std::vector<Pose>& scan_truths, ErrorConvention convention,
                    const std::vector<Eigen::Index>& judged) {
  RunRecord record(layout);
  const StateRows& rows = run.rows;
  const auto column = [&](const char* name) { return record.column<double>(*layout.find(name)); };
  const auto faults = record.column<std::uint32_t>(*layout.find("numerical_faults"));
  for (std::size_t row = 0; row < rows.time.size(); ++row) {
    const std::size_t s = run.scans[row];
    if (!rows.nis.empty()) {
      column("nis")[s] = rows.nis[row];
      record.column<std::uint32_t>(*layout.find("nis_dof"))[s] = rows.nis_dof[row];
    }
    if (!run.truths[row]) continue;
    const Eigen::VectorXd error =
        error_of(rows.shape, convention, rows.state[row], run.truths[row]->state)(judged);
    const Eigen::MatrixXd covariance = rows.covariance[row](judged, judged);
    put_rows(error, s, column("error"));
    put_rows(covariance, s, column("error_covariance"));
    faults[s] = analysis::imported_nees(error, covariance).is_usable() ? 0 : 1;
    if (layout.find("pose_mean")) put_pose(run, row, scan_truths[s], convention, record);
    put_conventions(run, row, record);
  }
  return record;
}

/// {scan} The truth of a run: that of the first estimator with an estimate there; NaN if none has
/// one.
std::vector<Pose> truths_of_scans(const std::vector<MatchedRows>& cells, std::size_t scans) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  std::vector<Pose> truths(scans, Pose{kUnknown, kUnknown, kUnknown});
  for (const MatchedRows& cell : cells) {
    for (std::size_t row = 0; row < cell.scans.size(); ++row) {
      Pose& truth = truths[cell.scans[row]];
      if (cell.truths[row] && std::isnan(truth.x)) truth = pose_in(cell.truths[row]->state);
    }
  }
  return truths;
}

/// Throws StudyError if the tolerance does not tell the rows of a file apart.
void require_tolerance(const fs::path& path, std::span<const double> times,
                       const TimeMatch& match) {
  const double least = least_spacing(times);
  if (2.0 * match.tolerance < least) return;
  throw StudyError(
      "--tolerance {}: rows of {} are {} s apart (half of that cannot tell neighbours apart): use "
      "{}a smaller --tolerance",
      to_text(match.tolerance), path, to_text(least),
      match.interpolate ? "" : "--interpolate, or ");
}

/// The clock of all files, and the file with the most rows, which has the state and innovations of
/// all others.
struct Overview {
  fs::path path;
  StateRows rows;
  ScanClock clock;
};

/// The first estimate is left out if it is the anchor of its truth.
Overview overview_of(const EstimateSource& source, const JudgingOptions& options) {
  std::vector<TimesOfRuns> times(source.cells().size());
  std::pair<std::size_t, std::size_t> longest;
  std::size_t most = 0;
  for (std::size_t c = 0; c < source.cells().size(); ++c) {
    for (std::size_t run = 0; run < source.runs().size(); ++run) {
      times[c].push_back(source.times(c, run));
      require_tolerance(source.place(c, run), times[c].back(), options.match);
      if (options.anchor && !times[c].back().empty())
        times[c].back().erase(times[c].back().begin());
      if (times[c].back().size() <= most) continue;
      longest = {c, run};
      most = times[c].back().size();
    }
  }
  const auto [c, run] = longest;
  StateRows rows = source.estimates(c, run);
  if (most > 0) {
    return {source.place(c, run), std::move(rows), ScanClock(times, options.match.tolerance)};
  }
  throw StudyError(
      "{}: {} one row for each time", source.place(c, run),
      options.anchor ? "at most one row, also in all other files (the first is the anchor, and "
                       "nothing is left to judge): write"
      : !options.windows.empty()
          ? "no increment over --windows, nor in any other file (neighbouring rows are farther "
            "apart, or the drive is shorter): choose other windows, or write"
          : "no rows behind the header, nor in any other file (nothing to judge): write");
}

/// Whether there are states with truths, and not innovations alone.
bool has_states(const Overview& all) { return all.rows.shape.dimension() > 0; }

/// Counts innovations with an angle beyond pi, which a wrapped difference of angles never has.
class UnwrappedInnovations {
 public:
  void add(const StateRows& rows) {
    if (count_ == 0) first_ = rows.first_unwrapped;
    count_ += rows.unwrapped_innovations;
  }
  std::vector<std::string> notes() const {
    if (count_ == 0) return {};
    return {
        formatted("innovations with an angle beyond pi: {}, the first in {} (they are judged as "
                  "they are): wrap differences of angles to -pi to pi",
                  count_, first_)};
  }

 private:
  std::uint64_t count_ = 0;
  std::string first_;
};

/// Notes on runs whose clocks differ, and on scans without an estimate.
std::vector<std::string> notes_on_times(const Overview& all, std::uint64_t missing) {
  std::vector<std::string> notes;
  if (!all.clock.is_common()) {
    notes.push_back(
        formatted("runs have clocks of their own: row k of each is judged with row k of the "
                  "others, at the times of {}, and a run with fewer rows is not counted as failed",
                  all.path));
  }
  if (missing > 0) {
    notes.push_back(
        formatted("{} {} missing (a scan of other runs without an estimate): each run is judged by "
                  "the scans that it has",
                  missing, missing == 1 ? "sample is" : "samples are"));
  }
  return notes;
}

/// Number of scans of a run without an estimate, before its end.
std::uint64_t missing_in(const MatchedRows& run, const ScanClock& clock) {
  if (run.scans.empty()) return 0;
  const std::size_t end = clock.is_common() ? run.scans.back() + 1 : run.scans.size();
  return end - run.scans.size();
}

/// The innovations of all runs, none of which may be those of an earlier one.
class SeenInnovations {
 public:
  /// Throws StudyError if an earlier run of the estimator `cell` has the same NIS.
  void refuse_repeat(std::size_t cell, const StateRows& rows, const fs::path& path) {
    std::vector<double> numbers;
    for (std::size_t row = 0; row < rows.nis.size(); ++row) {
      if (rows.nis_dof[row] > 0 && std::isfinite(rows.nis[row])) numbers.push_back(rows.nis[row]);
    }
    if (numbers.size() < 2) return;
    const auto [earlier, is_new] = seen_.try_emplace({cell, std::move(numbers)}, path);
    if (is_new) return;
    throw StudyError(
        "{}: has the innovations of {}, number by number (runs must be independent): give each run "
        "once",
        path, earlier->second);
  }

 private:
  std::map<std::pair<std::size_t, std::vector<double>>, fs::path> seen_;
};

/// Writes innovations alone, which have no truth. Returns notes. Throws StudyError if a run has the
/// innovations of an earlier one.
std::vector<std::string> write_innovations(const EstimateSource& source, const Overview& all,
                                           const StudyPlan& plan, ResultWriter& writer) {
  const std::vector<RecordLayout> layouts = layouts_of(plan, Detail::usual);
  UnwrappedInnovations unwrapped;
  SeenInnovations seen;
  for (std::size_t run = 0; run < source.runs().size(); ++run) {
    for (std::size_t c = 0; c < source.cells().size(); ++c) {
      StateRows rows = source.estimates(c, run);
      unwrapped.add(rows);
      seen.refuse_repeat(c, rows, source.place(c, run));
      std::vector<std::size_t> scans = all.clock.scans_of(rows.time);
      const std::size_t n = rows.time.size();
      const MatchedRows matched{std::move(rows), std::move(scans),
                                std::vector<std::optional<TrueState>>(n)};
      RunRecord record = record_of(layouts[c], matched, {}, ErrorConvention::world, {});
      record.mark_complete(kUnknownCost);
      writer.write(c, run, record);
    }
  }
  std::vector<std::string> notes = source.notes();
  for (std::string& note : unwrapped.notes()) notes.push_back(std::move(note));
  return notes;
}

/// What is said of all runs.
struct RunNotes {
  const JudgingOptions* options;
  AnchoredRuns* anchored = nullptr;  ///< nullptr: truths are not moved
  UnwrappedInnovations unwrapped = {};
  SeenInnovations seen = {};
  LikelyMistakes mistakes;
  TruthUse use = {};
  std::string uncorrelated = {};            ///< which covariances the first such file does not have
  std::vector<UnusableRows> unusable = {};  ///< {cell}
  std::uint64_t missing = 0;

  std::vector<std::string> all(const EstimateSource& source, const Overview& overview) const {
    std::vector<std::string> notes = source.notes();
    if (!uncorrelated.empty()) notes.push_back(uncorrelated);
    for (const auto& some :
         {unwrapped.notes(), notes_on_times(overview, missing), use.notes(options->match.is_pair),
          anchored == nullptr ? std::vector<std::string>() : anchored->notes(source.cells()),
          mistakes.notes()}) {
      notes.insert(notes.end(), some.begin(), some.end());
    }
    for (std::size_t c = 0; c < unusable.size(); ++c) {
      const std::vector<std::string> some = unusable[c].notes(source.cells()[c]);
      notes.insert(notes.end(), some.begin(), some.end());
    }
    return notes;
  }
};

/// Removes the first estimate of a run.
template <class Truths>
void remove_first(StateRows& rows, Truths& truths) {
  const auto remove_from = [](auto& list) {
    if (!list.empty()) list.erase(list.begin());
  };
  remove_from(rows.time);
  remove_from(rows.state);
  remove_from(rows.covariance);
  remove_from(rows.nis);
  remove_from(rows.nis_dof);
  remove_from(rows.line);
  remove_from(truths);
}

/// The truths {row} of a run, moved onto its anchor if there is one, which `rows` lose. The
/// covariances of their own errors are added to those of `rows`.
std::vector<std::optional<TrueState>> truths_for(std::size_t cell, StateRows& rows,
                                                 const fs::path& path, const TruthPath& truth,
                                                 RunNotes& notes) {
  auto truths = truth.at(rows, path, notes.use);
  if (notes.anchored != nullptr) {
    notes.anchored->move(cell, rows, path, truths);
    remove_first(rows, truths);
  }
  for (std::size_t row = 0; row < truths.size(); ++row) {
    if (!truths[row] || truths[row]->covariance.size() == 0) continue;
    if (!is_covariance(rows.covariance[row])) continue;  // which is a fault of the estimate
    const Eigen::MatrixXd& other = truths[row]->covariance;
    if (!is_covariance(other)) {  // of the second estimator of a pair
      rows.covariance[row] = other;
      continue;
    }
    rows.covariance[row] = notes.options->pair.empty()
                               ? Eigen::MatrixXd(rows.covariance[row] + other)
                               : largest_covariance_of_difference(rows.covariance[row], other);
  }
  return truths;
}

/// The truth of errors, which are those from zero.
StateRows zeros_at(const StateRows& errors) {
  StateRows zeros{.shape = errors.shape, .time = errors.time, .state = errors.state};
  for (Eigen::VectorXd& zero : zeros.state) zero.setZero();
  zeros.line = errors.line;
  return zeros;
}

/// {cell} The estimates of a run with their scans and truths.
std::vector<MatchedRows> matched_run(const EstimateSource& source, std::size_t run,
                                     const Overview& all, RunNotes& notes) {
  std::vector<MatchedRows> cells;
  StateRows truth_rows;
  std::optional<TruthPath> truth;
  for (std::size_t c = 0; c < source.cells().size(); ++c) {
    const fs::path path = source.place(c, run);
    StateRows rows = source.estimates(c, run);
    notes.unwrapped.add(rows);
    if (notes.uncorrelated.empty() && !rows.uncorrelated.empty()) {
      notes.uncorrelated = path.string() + ": no covariance " + rows.uncorrelated +
                           " is given, and counts as 0: if there is one, the verdict may call it "
                           "an unreported correlation";
    }
    if (notes.options->are_innovations) notes.seen.refuse_repeat(c, rows, path);
    require_alike(rows, path, all.rows, all.path);
    if (!truth || !source.has_common_truths()) {
      truth_rows = source.has_errors() ? zeros_at(rows) : source.truth(c, run, all.rows.shape);
      notes.mistakes.add_truth(truth_rows, source.truth_place(c, run));
      truth.emplace(truth_rows, source.truth_place(c, run), notes.options->match);
    }
    // The errors of increments are computed, and no file has them.
    if (notes.options->windows.empty()) notes.mistakes.add(c, rows, path, truth_rows);
    auto truths = truths_for(c, rows, path, *truth, notes);
    std::vector<std::size_t> scans = all.clock.scans_of(rows.time);
    cells.push_back({std::move(rows), std::move(scans), std::move(truths)});
    if (source.has_common_truths()) cells.back().truth_end = truth->end();
    if (!notes.options->have_own_scans()) notes.missing += missing_in(cells.back(), all.clock);
  }
  return cells;
}

/// Adds the rows of a run whose judged covariance is none, which `record` counts as faults.
void add_unusable(const MatchedRows& run, const fs::path& path,
                  const std::vector<Eigen::Index>& judged, RunRecord& record,
                  UnusableRows& unusable) {
  const auto faults = record.column<std::uint32_t>(*record.layout().find("numerical_faults"));
  for (std::size_t row = 0; row < run.scans.size(); ++row) {
    if (faults[run.scans[row]] == 0) continue;
    unusable.add(run.rows.covariance[row](judged, judged),
                 path.string() + ":" + std::to_string(run.rows.line[row]));
  }
}

/// Whether estimates that begin far from their truth are likely seen from another frame.
bool compares_starts(const JudgingOptions& options) {
  return !options.anchor && options.pair.empty() && !options.adds_truth_covariance &&
         *options.convention != ErrorConvention::right_invariant;
}

/// Surveys the anchors of all runs, if truths are moved.
std::optional<AnchoredRuns> anchored_runs(const EstimateSource& source,
                                          const JudgingOptions& options, const Overview& all) {
  if (!options.anchor || !has_states(all)) return std::nullopt;
  AnchoredRuns anchored(*options.anchor, *options.convention, source.cells().size());
  LikelyMistakes units(source.cells(), *options.convention, false, false);  // refuses wrong ones
  for (std::size_t run = 0; run < source.runs().size(); ++run) {
    for (std::size_t c = 0; c < source.cells().size(); ++c) {
      const fs::path path = source.place(c, run);
      const StateRows rows = source.estimates(c, run);
      require_alike(rows, path, all.rows, all.path);
      const StateRows truth_rows = source.truth(c, run, rows.shape);
      units.add_truth(truth_rows, source.truth_place(c, run));
      units.add(c, rows, path, truth_rows);
      const TruthPath truth(truth_rows, source.truth_place(c, run), options.match);
      TruthUse ignored;  // which is said when the run is judged
      anchored.survey(c, rows, path, truth.at(rows, path, ignored));
    }
  }
  return anchored;
}

std::vector<std::string> write_runs(const EstimateSource& source, const JudgingOptions& options,
                                    const Overview& all, const StudyPlan& plan,
                                    AnchoredRuns* anchored, ResultWriter& writer) {
  if (!has_states(all)) return write_innovations(source, all, plan, writer);
  const std::vector<RecordLayout> layouts = layouts_of(plan, Detail::usual);
  const auto judged = judged_components(all.rows.shape, options.components);
  RunNotes notes{.options = &options,
                 .anchored = anchored,
                 .mistakes = LikelyMistakes(source.cells(), *options.convention,
                                            compares_starts(options), options.match.is_pair)};
  notes.unusable.resize(source.cells().size());
  for (std::size_t run = 0; run < source.runs().size(); ++run) {
    const auto cells = matched_run(source, run, all, notes);
    std::vector<Pose> scan_truths;
    if (plan.drives->itinerary().has_truth) {
      Drive drive;
      drive.truth = scan_truths = truths_of_scans(cells, all.clock.times().size());
      writer.write_truth(run, drive);
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      RunRecord record = record_of(layouts[c], cells[c], scan_truths, *options.convention, judged);
      add_unusable(cells[c], source.place(c, run), judged, record, notes.unusable[c]);
      if (options.have_own_scans()) {
        record.mark_complete(kUnknownCost);
      } else {
        end_run(cells[c], all.clock, c, record);
      }
      writer.write(c, run, record);
    }
  }
  return notes.all(source, all);
}

}  // namespace

std::vector<std::string> judge_estimates(const EstimateSource& source,
                                         const JudgingOptions& given) {
  const Overview all = overview_of(source, given);
  JudgingOptions options = given;
  options.convention = source.has_errors() || !has_states(all)
                           ? ErrorConvention::world
                           : stated_error(all.rows.shape, all.path, given.convention);
  std::optional<AnchoredRuns> anchored = anchored_runs(source, options, all);
  if (anchored) options.bounds_anchored = anchored->are_bounded();
  const StudyPlan plan = imported_plan(source, all.rows, all.clock.times(), options);
  ResultWriter writer =
      ResultWriter::create(options.output, plan, options.provenance, options.existing);
  try {
    std::vector<std::string> notes =
        write_runs(source, options, all, plan, anchored ? &*anchored : nullptr, writer);
    writer.finish();
    return notes;
  } catch (...) {
    std::error_code ignored;
    fs::remove(writer.unfinished(), ignored);
    throw;
  }
}

}  // namespace montecarta::experiments
