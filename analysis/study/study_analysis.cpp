// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/study_analysis.hpp"

#include "analysis/run/criteria_of.hpp"
#include "analysis/run/imported_state.hpp"
#include "analysis/run/run_reader.hpp"
#include "analysis/run/study_facts.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/study/cell_sums.hpp"
#include "analysis/study/efficiency.hpp"
#include "analysis/study/stored_sums.hpp"
#include "analysis/verdict/gate_scale.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace montecarta::analysis {
namespace {

/// Returns whether a file is unfinished work, which after a power cut may have a fingerprint
/// without its run.
bool is_work_in_progress(const std::filesystem::path& path) {
  return path.filename().string().find(".part") != std::string::npos;
}

/// Throws StudyError if run index `i`, which is marked as not needed, cannot be: the study has no
/// interim analyses, the run lies before the first of them, or the run was made.
void expect_planned(const ResultFile& file, const StoredCell& cell, std::size_t i) {
  file.expect_whole(cell, i);
  if (study_facts_of(file).stops_early && i >= kFirstRound) return;
  throw StudyError(
      "{}: cell '{}', run {}: damaged (marked as not needed, but the study plans no such end "
      "there): take a copy that is whole, or run the study again",
      file.path(), cell.label, file.runs()[i]);
}

/// Counts the interim analyses that were planned and made, by the runs that were made.
void count_analyses(const ResultFile& file, CellAnalysis& cell) {
  const auto planned = study_facts_of(file).runs_at_analyses;
  const std::uint64_t made = cell.runs.size() + cell.failures.size();
  cell.analyses_planned = planned.size();
  cell.analyses_made = static_cast<std::size_t>(
      std::ranges::count_if(planned, [&](std::uint64_t runs) { return runs <= made; }));
}

/// Indices in the file of the complete runs among the first `runs`. Counts them, and lists their
/// numbers, in `cell`.
std::vector<std::size_t> complete_runs(const ResultFile& file, const StoredCell& stored,
                                       std::size_t runs, CellAnalysis& cell) {
  const auto status = file.status(stored);
  const auto reasons = file.failure_reasons(stored);
  const auto steps = file.failure_steps(stored);
  std::vector<std::size_t> complete;
  for (std::size_t i = 0; i < std::min(runs, status.size()); ++i) {
    if (status[i] == RunStatus::complete) complete.push_back(i);
    if (status[i] == RunStatus::missing) {
      ++cell.missing;
      if (!is_work_in_progress(file.path())) file.expect_whole(stored, i);
    }
    if (status[i] == RunStatus::not_needed) {
      ++cell.not_needed;
      expect_planned(file, stored, i);
    }
    if (status[i] == RunStatus::failed) {
      file.expect_whole(stored, i);
      cell.failures.push_back({file.runs()[i], steps[i], reasons[i]});
    }
  }
  for (const std::size_t i : complete) cell.runs.push_back(file.runs()[i]);
  count_analyses(file, cell);
  return complete;
}

/// The scale of the gate that the innovations of a cell passed; nullopt if there was none. Throws
/// StudyError if its limits are damaged.
std::optional<GateScale> gate_of(const ResultFile& file, const StoredCell& cell) {
  const std::string limits = setting_of(cell.settings, "gate_limits");
  auto gate = gate_scale_of(limits);
  if (gate || limits.empty()) return gate;
  throw StudyError(
      "{}: cell '{}': damaged (gate_limits has no rows with a limit): judge the innovations again",
      file.path(), cell.label);
}

/// A cell whose runs are to be added up.
struct CellTask {
  CellTask(const ResultFile& file, const StoredCell& stored, std::size_t runs)
      : stored_cell(&stored), reader(file, stored) {
    cell.label = stored.label;
    cell.filter = stored.filter;
    cell.long_name = stored.long_name;
    cell.particles = stored.particles;
    cell.settings = stored.settings;
    if (auto gate = gate_of(file, stored)) cell.findings.put(std::move(*gate));
    if (!file.has_sums()) complete = complete_runs(file, stored, runs, cell);
  }

  /// The sums that are stored in the file.
  CellSums read_sums(const ResultFile& file, const RunCriteria& criteria,
                     const Parallel& parallel) {
    StoredSums found = read_stored_sums(file, *stored_cell, criteria, parallel);
    cell.runs = std::move(found.complete);
    cell.failures = std::move(found.failures);
    count_analyses(file, cell);
    return std::move(found.sums);
  }

  /// Fills the cell from its sums. They are released afterwards, because they hold the errors of
  /// many runs.
  void put(CellSums sums) {
    sums.put(cell);
    for (const NeesResult& nees : cell.nees) {
      expect(std::ranges::count(kErrorBlocks, nees.block) == 1 &&
                 std::ranges::count(kMoments, nees.moments) == 1,
             "a NEES of no known error");
    }
    cell.verdict.runs = cell.complete + cell.failures.size();
    cell.verdict.failed = cell.failures.size();
  }

  CellAnalysis cell;
  const StoredCell* stored_cell;
  RunReader reader;
  std::vector<std::size_t> complete;
};

std::vector<CellSums> sums_of_tasks(const ResultFile& file, std::span<CellTask> tasks,
                                    const RunCriteria& criteria, const Parallel& parallel) {
  std::vector<CellSums> sums;
  if (file.has_sums()) {
    for (CellTask& task : tasks) sums.push_back(task.read_sums(file, criteria, parallel));
    return sums;
  }
  std::vector<CellRuns> runs;
  for (const CellTask& task : tasks) {
    runs.push_back({&task.reader, task.complete, task.cell.runs});
  }
  return sums_of(runs, criteria, parallel);
}

/// Throws StudyError unless the sums that the file may have are at this level, and hold the first
/// runs of the study, by which verdicts judge how errors of a run are correlated.
void expect_usable_sums(const ResultFile& file, double level) {
  if (!file.has_sums()) return;
  if (level != kStoredLevel) {
    throw StudyError(
        "{}: level {} (the file has sums instead of runs, made for the level {}): use that level, "
        "or run the study again without sums in record.columns",
        file.path(), compact(level), compact(kStoredLevel));
  }
  if (file.description().sums->first_run > 0) {
    throw StudyError(file.path().string() +
                     ": has sums of later runs alone (the study's first runs are needed for its "
                     "verdict): merge it with the other shards first");
  }
}

void expect_scans(const ResultFile& file) {
  if (!file.scan_times().empty()) return;
  throw StudyError(file.path().string() +
                   ": no scans (metrics are taken at scans): choose "
                   "another file");
}

/// Begins the analysis with the facts that the file states.
StudyAnalysis begin(const ResultFile& file, double level, std::optional<double> within) {
  StudyAnalysis study;
  study.file = file.path().filename().string();
  study.study_name = file.study_name();
  study.title = file.title();
  study.study_sha256 = file.study_sha256();
  study.seed = file.seed();
  study.study_runs = file.study_runs();
  study.runs_here = runs_in(file);
  study.level = level;
  StudyFacts facts = study_facts_of(file);
  study.within = within.value_or(facts.within);
  study.runs_at_analyses = std::move(facts.runs_at_analyses);
  study.judged = judged_scans_of(file);
  study.times.assign(file.scan_times().begin() + static_cast<std::ptrdiff_t>(study.judged.first),
                     file.scan_times().end());
  for (const std::uint32_t scan : judged_joint_scans(file)) {
    study.joint_times.push_back(study.times[scan]);
  }
  study.duration = study.times.empty() ? 0.0 : study.times.back();
  study.has_truth = file.has_errors();
  study.rows_are_scans = file.times().size() == file.scan_times().size();
  study.own_drives = file.description().drives.size();
  const auto odometry =
      std::ranges::find(file.scenario(), engine::kOdometryFact, &TextPairs::value_type::first);
  if (odometry != file.scenario().end()) study.odometry = odometry->second;
  if (!file.cells().empty()) study.imported = imported_state(file.cells().front());
  if (study.imported.is_imported()) study.study_runs = study.runs_here;  // numbers may start at 1
  study.beacons = file.landmarks().size();
  return study;
}

/// {reference} The judged references. Each drive has a list of references in the same order; in
/// some drives a reference may have no fixes.
std::vector<JudgedReference> judged_references(const RunCriteria& criteria) {
  std::vector<JudgedReference> all;
  const auto add = [](JudgedReference& reference, const PathAtFixes& fixes) {
    reference.name = fixes.name();
    reference.fixes += fixes.times().size();
    reference.drives += fixes.times().empty() ? 0 : 1;
    reference.has_heading = reference.has_heading || !fixes.headings().empty();
    reference.has_errors = reference.has_errors || fixes.has_errors();
    reference.in_gaps += fixes.in_gaps();
    reference.outside += fixes.outside();
    reference.has_start = reference.has_start || fixes.has_start();
  };
  for (std::size_t r = 0; r < criteria.references.size(); ++r) {
    JudgedReference& reference = all.emplace_back();
    for (const DriveCriteria& drive : criteria.drives) add(reference, drive.references[r]);
    if (!criteria.drives.empty()) continue;
    add(reference, criteria.references[r]);
    reference.times = criteria.references[r].times();
  }
  return all;
}

}  // namespace

bool StudyAnalysis::has_failures() const {
  return std::ranges::any_of(cells, [](const CellAnalysis& c) { return !c.failures.empty(); });
}

std::string StudyAnalysis::scans_text() const {
  const std::string scans = std::to_string(judged.first + times.size()) + " scans";
  if (judged.first > 0) {
    return formatted("{} each, judged from {} s on ({} scans)", scans, exact_text(judged.from),
                     times.size());
  }
  return own_drives > 0 ? "up to " + scans : scans + " each";
}

namespace {

/// Calls `work`, which may use the sums of a file. Numbers of sums that contradict each other are
/// found where they are used, and would look like a mistake of ours.
template <class Work>
auto with_sums_of(const ResultFile& file, const Work& work) {
  try {
    return work();
  } catch (const StudyError&) {
    throw;
  } catch (const RunError&) {
    throw;
  } catch (const std::exception&) {
    if (!file.has_sums()) throw;
    throw StudyError(file.path().string() +
                     ": its sums contradict each other (damage, or another program wrote them): "
                     "take a copy that is whole, or run the study again");
  }
}

StudyAnalysis analysis_of(const ResultFile& file, double level, const Parallel& parallel,
                          std::optional<double> within) {
  nees_bounds(1, 1, level);  // throws if the level is wrong, before the work begins
  StudyAnalysis study = begin(file, level, within);
  expect_scans(file);
  expect_usable_sums(file, level);
  const RunCriteria criteria = criteria_of(file, level, study.within);
  study.references = judged_references(criteria);
  std::vector<CellTask> tasks;
  for (const StoredCell& cell : file.cells()) tasks.emplace_back(file, cell, file.runs().size());
  std::vector<CellSums> sums = sums_of_tasks(file, tasks, criteria, parallel);
  BoundOfStudy bound(file);
  parallel.for_each(tasks.size() + bound.paths(), [&](std::size_t k) {
    if (k < tasks.size()) {
      tasks[k].put(std::move(sums[k]));
    } else {
      bound.follow(k - tasks.size());
    }
  });
  for (CellTask& task : tasks) study.cells.push_back(std::move(task.cell));
  study.bound = bound.result();
  for (CellAnalysis& cell : study.cells) {
    cell.findings.put(efficiency_of(cell, study.bound));
  }
  return study;
}

}  // namespace

StudyAnalysis analyze(const ResultFile& file, double level, const Parallel& parallel,
                      std::optional<double> within) {
  return with_sums_of(file, [&] { return analysis_of(file, level, parallel, within); });
}

CellAnalysis analyze_cell(const ResultFile& file, const StoredCell& cell, double level,
                          std::size_t runs, const Parallel& parallel,
                          std::optional<double> within) {
  expect_scans(file);
  expect_usable_sums(file, level);
  const RunCriteria criteria =
      criteria_of(file, level, within.value_or(study_facts_of(file).within));
  return with_sums_of(file, [&] {
    CellTask task(file, cell, runs);
    task.put(std::move(sums_of_tasks(file, std::span(&task, 1), criteria, parallel).front()));
    return std::move(task.cell);
  });
}

}  // namespace montecarta::analysis
