// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/judged_study.hpp"

#include "analysis/run/nees.hpp"
#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/posix_file.hpp"
#include "experiments/files/files.hpp"
#include "experiments/judging/innovation_rows.hpp"
#include "experiments/judging/likely_mistakes.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// Checks that all files have the same kind of state and the same times, because averages over runs
/// are taken at each time. A run may end before the others.
void require_alike(const StateRows& rows, const fs::path& path, const StateRows& first,
                   const fs::path& first_path, double tolerance) {
  if (rows.shape != first.shape) {
    throw StudyError(path.string() + ": another state than in " + first_path.string() +
                     " (one study judges one state): judge them apart");
  }
  if (rows.time.empty()) return;
  if (rows.nis.empty() != first.nis.empty()) {
    throw StudyError(path.string() + ": " + (rows.nis.empty() ? "no nis" : "has nis") + " (in " +
                     first_path.string() + " it is otherwise): give it in all files or in none");
  }
  if (rows.time.size() > first.time.size()) {
    throw StudyError(path.string() + ": " + std::to_string(rows.time.size()) + " rows, " +
                     first_path.string() + " has " + std::to_string(first.time.size()) +
                     " with as many lines: give all files one layout");
  }
  for (std::size_t s = 0; s < rows.time.size(); ++s) {
    if (std::abs(rows.time[s] - first.time[s]) <= tolerance) continue;
    throw StudyError(path.string() + ": row " + std::to_string(s + 1) + " has time " +
                     to_text(rows.time[s]) + " s (" + first_path.string() + " has " +
                     to_text(first.time[s]) +
                     " s there, and averages over runs are taken at each "
                     "time): give all runs the same times, counted from their start");
  }
}

Pose pose_in(const Eigen::VectorXd& state) { return {state(0), state(1), wrap(state(2))}; }

/// Writes the elements of a matrix, row by row, to its scan.
void put_rows(const Eigen::MatrixXd& matrix, std::size_t scan, std::span<double> column) {
  auto out =
      column.begin() + static_cast<std::ptrdiff_t>(scan * static_cast<std::size_t>(matrix.size()));
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) *out++ = matrix(i, j);
  }
}

/// Marks a run as complete, or as failed if it ends before the others.
void end_run(const StateRows& rows, std::size_t scans, RunRecord& record) {
  constexpr double kUnknownCost = std::numeric_limits<double>::quiet_NaN();
  if (rows.time.size() == scans) {
    record.mark_complete(kUnknownCost);
    return;
  }
  const std::string reason =
      rows.time.empty() ? "no estimates" : "estimates end at " + to_text(rows.time.back()) + " s";
  record.mark_failed(static_cast<std::uint32_t>(rows.time.size()), reason, kUnknownCost);
}

/// Writes the NEES under every convention of the state, if the file has columns for them.
void put_conventions(const StateRows& rows, const std::vector<Eigen::VectorXd>& truths,
                     RunRecord& record) {
  for (const ErrorConvention convention : conventions_of(rows.shape.kind)) {
    const auto column = record.layout().find(nees_column(convention));
    if (!column) return;
    const auto nees = record.column<double>(*column);
    for (std::size_t s = 0; s < rows.time.size(); ++s) {
      const Eigen::VectorXd error = error_of(rows.shape, convention, rows.state[s], truths[s]);
      nees[s] = analysis::on_full_scale(analysis::imported_nees(error, rows.covariance[s]),
                                        rows.shape.dimension());
    }
  }
}

/// The record of one run of one estimator.
RunRecord record_of(const RecordLayout& layout, const StateRows& rows,
                    const std::vector<Eigen::VectorXd>& truths, ErrorConvention convention) {
  RunRecord record(layout);
  const auto column = [&](const char* name) { return record.column<double>(*layout.find(name)); };
  const auto faults = record.column<std::uint32_t>(*layout.find("numerical_faults"));
  for (std::size_t s = 0; s < rows.time.size(); ++s) {
    const Eigen::VectorXd error = error_of(rows.shape, convention, rows.state[s], truths[s]);
    put_rows(error, s, column("error"));
    put_rows(rows.covariance[s], s, column("error_covariance"));
    faults[s] = analysis::imported_nees(error, rows.covariance[s]).is_usable() ? 0 : 1;
    if (rows.shape.kind != StateKind::pose) continue;
    const Pose mean = pose_in(rows.state[s]);
    put_rows(Eigen::Vector3d(mean.x, mean.y, mean.heading), s, column("pose_mean"));
    put_rows(covariance_in_map(convention, rows.state[s], rows.covariance[s]), s,
             column("pose_covariance"));
  }
  if (!rows.nis.empty()) {
    std::ranges::copy(rows.nis, column("nis").begin());
    std::ranges::copy(rows.nis_dof, record.column<std::uint32_t>(*layout.find("nis_dof")).begin());
  }
  put_conventions(rows, truths, record);
  end_run(rows, truths.size(), record);
  return record;
}

/// The estimates that define the times of the study.
struct LongestRun {
  fs::path path;
  StateRows rows;
};

StateRows read_with_innovations(const fs::path& path, double tolerance, EqualTimes equal_times) {
  StateRows rows = read_estimates(path, equal_times);
  if (const auto beside = innovations_beside(path)) {
    read_innovations(*beside, path, tolerance, rows);
  }
  return rows;
}

/// Reads only the file with the most lines; the others are read when their runs are written.
LongestRun longest_of(const JudgedFiles& files, double tolerance, EqualTimes equal_times) {
  fs::path longest;
  std::size_t most = 0;
  for (const EstimatorFiles& cell : files.cells) {
    for (const fs::path& path : cell.of_run) {
      const std::size_t rows = rows_in(path, equal_times);
      if (!longest.empty() && rows <= most) continue;
      longest = path;
      most = rows;
    }
  }
  StateRows rows = read_with_innovations(longest, tolerance, equal_times);
  if (!rows.time.empty()) return {longest, std::move(rows)};
  throw StudyError(longest.string() +
                   ": no rows behind the header, nor in any other file (nothing to judge): write "
                   "one row for each time");
}

/// Counts innovations with an angle beyond pi, which a wrapped difference of angles never has.
class UnwrappedInnovations {
 public:
  void add(const StateRows& rows) {
    if (count_ == 0) first_ = rows.first_unwrapped;
    count_ += rows.unwrapped_innovations;
  }
  std::vector<std::string> notes() const {
    if (count_ == 0) return {};
    return {"innovations with an angle beyond pi: " + std::to_string(count_) + ", the first in " +
            first_ + " (they are judged as they are): wrap differences of angles to -pi to pi"};
  }

 private:
  std::uint64_t count_ = 0;
  std::string first_;
};

std::vector<std::string> write_runs(const JudgedFiles& files, const JudgingOptions& options,
                                    const LongestRun& longest, const StudyPlan& plan,
                                    ResultWriter& writer) {
  const std::vector<RecordLayout> layouts = layouts_of(plan, Detail::usual);
  UnwrappedInnovations unwrapped;
  LikelyMistakes mistakes(files, *options.convention);
  for (std::size_t run = 0; run < files.runs.size(); ++run) {
    const StateRows truth = read_truth(files.truth[run], longest.rows.shape, options.equal_times);
    mistakes.add_truth(truth, files.truth[run]);
    for (std::size_t c = 0; c < files.cells.size(); ++c) {
      const fs::path& path = files.cells[c].of_run[run];
      const StateRows rows =
          read_with_innovations(path, options.match.tolerance, options.equal_times);
      unwrapped.add(rows);
      mistakes.add(c, rows, path, truth);
      require_alike(rows, path, longest.rows, longest.path, options.match.tolerance);
      std::vector<Eigen::VectorXd> truths;
      for (const double time : longest.rows.time)
        truths.push_back(truth_at(truth, time, options.match, path, files.truth[run]));
      if (c == 0 && plan.drives->itinerary().has_truth) {
        Drive drive;
        std::ranges::transform(truths, std::back_inserter(drive.truth), pose_in);
        writer.write_truth(run, drive);
      }
      writer.write(c, run, record_of(layouts[c], rows, truths, *options.convention));
    }
  }
  std::vector<std::string> notes = unwrapped.notes();
  std::ranges::copy(mistakes.notes(), std::back_inserter(notes));
  return notes;
}

/// The convention that the user gave, or the only one that the state may have. Throws StudyError if
/// none was given and there are several.
ErrorConvention stated_error(const LongestRun& longest, std::optional<ErrorConvention> said) {
  const auto known = conventions_of(longest.rows.shape.kind);
  const std::string likeness = likeness_to_pose(longest.rows.shape);
  if (!said && known.size() == 1 && likeness.empty()) return known.front();
  if (!said && known.size() == 1) {
    throw StudyError("judge: --error is missing (" + longest.path.string() +
                     " is judged as a vector, mean - truth: " + likeness +
                     "): give --error world if it is a vector");
  }
  if (!said) {
    throw StudyError(
        "judge: --error is missing (the verdict depends on the error that the covariance "
        "describes): give --error world, body or right-invariant, which montecarta judge --help "
        "explains");
  }
  if (std::ranges::find(known, *said) != known.end()) return *said;
  throw StudyError("--error " + name_of(*said) + ": not of a vector (" + longest.path.string() +
                   " has no pose, and only poses have frames" +
                   (likeness.empty() ? "" : "; " + likeness) +
                   "): name the columns of the pose, or judge the error mean - truth of the vector "
                   "by --error world");
}

/// A source of drives that has only the times of the estimates.
class ImportedDrives final : public DriveSource {
 public:
  explicit ImportedDrives(const StateRows& rows) {
    itinerary_.step_time = rows.time;
    itinerary_.scan_step.resize(rows.time.size());
    std::iota(itinerary_.scan_step.begin(), itinerary_.scan_step.end(), 0U);
    itinerary_.has_truth = rows.shape.kind == StateKind::pose;
  }
  const Itinerary& itinerary() const override { return itinerary_; }
  void generate(std::uint64_t /*run*/, Drive& /*drive*/) const override {
    expect(false, "the drive of an imported estimate was asked for");
  }

 private:
  Itinerary itinerary_;
};

/// SHA-256 of the contents of all files, in their order, and of the innovations beside each.
std::string contents_of(const std::vector<std::filesystem::path>& files) {
  std::string all;
  for (const std::filesystem::path& file : files) {
    all += sha256(whole_file(file)) + "\n";
    if (const auto beside = innovations_beside(file)) all += sha256(whole_file(*beside)) + "\n";
  }
  return sha256(all);
}

TextPairs import_settings(const StateRows& first, const JudgingOptions& options) {
  return {{"state", name_of(first.shape.kind)},
          {"error", name_of(*options.convention)},
          {"components", joined(first.shape.components)},
          {"units", joined(first.shape.units)}};
}

std::string import_text(const JudgedFiles& files, const TextPairs& settings) {
  std::string text = std::string(kImportedSection) + "\n";
  const auto add = [&](const std::string& name, const std::string& value) {
    text += name + " = " + value + "\n";
  };
  for (const auto& [name, value] : settings) add(name, value);
  add("runs", std::to_string(files.runs.front()) + ":" + std::to_string(files.runs.back() + 1));
  if (!files.names.empty()) add("names of runs", joined(files.names));
  add("truth_sha256", contents_of(files.truth));
  for (const EstimatorFiles& cell : files.cells)
    add("sha256 of " + cell.cell, contents_of(cell.of_run));
  return text;
}

Cell imported_cell(const EstimatorFiles& files, const StateRows& first, const TextPairs& settings) {
  Cell cell;
  cell.label = files.cell;
  cell.filter = "imported";
  cell.long_name = files.cell + " (imported)";
  cell.imported = ImportedError{.components = first.shape.dimension(),
                                .has_innovations = !first.nis.empty(),
                                .has_conventions = conventions_of(first.shape.kind).size() > 1,
                                .has_pose = first.shape.kind == StateKind::pose};
  cell.settings = settings;
  return cell;
}

/// The plan that defines the layout of the result file; it cannot be run. `first` has the state and
/// the times of all estimates. The text of the plan contains the SHA-256 of all files, so that
/// results of the same estimates, judged with the same options, have the same study_sha256.
StudyPlan imported_plan(const JudgedFiles& files, const StateRows& first,
                        const JudgingOptions& options) {
  const TextPairs settings = import_settings(first, options);
  StudyPlan plan;
  plan.name = options.output.stem().string();
  plan.title = "Imported estimates: " + plan.name;
  plan.first_run = files.runs.front();
  plan.last_run = plan.runs = files.runs.back() + 1;
  plan.columns = {.ancestry = false, .scans_only = true};
  plan.drives = std::make_shared<ImportedDrives>(first);
  plan.scenario = {{"kind", "imported"},
                   {"tolerance", to_text(options.match.tolerance)},
                   {"interpolate", options.match.interpolate ? "yes" : "no"}};
  if (options.equal_times != EqualTimes::refuse) {
    plan.scenario.emplace_back("keep",
                               options.equal_times == EqualTimes::keep_first ? "first" : "last");
  }
  TextPairs all = settings;
  all.insert(all.end(), plan.scenario.begin() + 1, plan.scenario.end());
  plan.resolved_text = import_text(files, all);
  if (options.within) plan.resolved_text += "[study]\nwithin = " + to_text(*options.within) + "\n";
  for (const EstimatorFiles& cell : files.cells)
    plan.cells.push_back(imported_cell(cell, first, settings));
  return plan;
}

}  // namespace

std::vector<std::string> judge_files(const JudgedFiles& files, const JudgingOptions& given) {
  const LongestRun longest = longest_of(files, given.match.tolerance, given.equal_times);
  JudgingOptions options = given;
  options.convention = stated_error(longest, given.convention);
  const StudyPlan plan = imported_plan(files, longest.rows, options);
  ResultWriter writer =
      ResultWriter::create(options.output, plan, options.provenance, options.existing);
  try {
    std::vector<std::string> notes = write_runs(files, options, longest, plan, writer);
    writer.finish();
    return notes;
  } catch (...) {
    std::error_code ignored;
    fs::remove(writer.unfinished(), ignored);
    throw;
  }
}

}  // namespace montecarta::experiments
