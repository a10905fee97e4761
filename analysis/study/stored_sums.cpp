// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/study/stored_sums.hpp"

#include "analysis/run/cramer_rao.hpp"
#include "analysis/run/criteria_of.hpp"
#include "analysis/statistics/sums.hpp"
#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/threads/in_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace montecarta::analysis {
namespace {

/// Version of the words. It must be raised when their meaning changes but their layout does not.
constexpr std::uint64_t kVersion = 2;

static_assert(kRunsBesideSums >= kBoundRuns, "the paths of the Cramer-Rao bound are stored");

using ReasonWords = std::array<std::uint64_t, kFailureReasonBytes / sizeof(std::uint64_t)>;

/// Data that are stored for each run of a group.
struct RunsOfGroup {
  struct Failure {
    std::uint32_t step = 0;
    ReasonWords reason{};
    static constexpr auto members() { return std::tuple(&Failure::step, &Failure::reason); }
  };
  std::vector<RunStatus> status;
  std::vector<std::uint64_t> fingerprint;
  std::vector<Failure> failures;  ///< {failed run} step and reason of the failure
  static constexpr auto members() {
    using Runs = RunsOfGroup;
    return std::tuple(&Runs::status, &Runs::fingerprint, &Runs::failures);
  }
};

std::uint64_t layout_of(const CellSums& sums) {
  std::string text = sums.layout();
  SumLayout<RunsOfGroup>::add(text);
  Fingerprint layout;
  layout.add(std::as_bytes(std::span(&kVersion, 1)));
  layout.add(std::as_bytes(std::span(text)));
  return layout.value();
}

RunsOfGroup runs_of(const ResultFile& rows, const StoredCell& cell) {
  RunsOfGroup runs{rows.status(cell), rows.fingerprints(cell), {}};
  const std::vector<std::string> reasons = rows.failure_reasons(cell);
  const std::vector<std::uint32_t> steps = rows.failure_steps(cell);
  for (std::size_t i = 0; i < runs.status.size(); ++i) {
    if (runs.status[i] == RunStatus::complete) continue;
    rows.expect_whole(cell, i);
    expect(runs.status[i] == RunStatus::failed, "a group of runs that are not all made");
    RunsOfGroup::Failure& failure = runs.failures.emplace_back();
    failure.step = steps[i];
    std::memcpy(failure.reason.data(), reasons[i].data(),
                std::min(reasons[i].size(), sizeof(ReasonWords)));
  }
  return runs;
}

std::string text_of(const ReasonWords& words) {
  std::array<char, sizeof(ReasonWords) + 1> text{};
  std::memcpy(text.data(), words.data(), sizeof(ReasonWords));
  return text.data();
}

std::vector<std::size_t> complete_indices(const std::vector<RunStatus>& status) {
  std::vector<std::size_t> complete;
  for (std::size_t i = 0; i < status.size(); ++i) {
    if (status[i] == RunStatus::complete) complete.push_back(i);
  }
  return complete;
}

}  // namespace

std::uint64_t runs_in(const ResultFile& file) {
  const auto& sums = file.description().sums;
  return sums ? sums->last_run - sums->first_run : file.runs().size();
}

double bytes_of_sums(std::uint64_t runs, std::size_t scans) {
  // These are measured: a file grows by 38 words for each run of EKF-SLAM and by 47 for one of
  // FastSLAM. They are the scores that apply to the run, a word each, and the numbers that verdict,
  // NEES and lineages keep for it.
  constexpr double kWordsOfRun = 40.0, kWordsOfScan = 48.0;
  const auto n = static_cast<double>(runs), s = static_cast<double>(scans);
  const double groups = std::ceil(n / static_cast<double>(kRunsOfAGroup));
  return 8.0 * (kWordsOfRun * n + kWordsOfScan * groups * s);
}

std::vector<NewGroup> sums_to_store(const ResultFile& rows, const Parallel& parallel) {
  const RunCriteria criteria = criteria_of(rows, kStoredLevel);
  const std::size_t n = rows.cells().size();
  std::vector<RunsOfGroup> runs;
  std::vector<RunReader> readers;
  std::vector<std::vector<std::size_t>> complete;
  std::vector<std::vector<std::uint64_t>> numbers(n);
  for (std::size_t c = 0; c < n; ++c) {
    runs.push_back(runs_of(rows, rows.cells()[c]));
    readers.emplace_back(rows, rows.cells()[c]);
    complete.push_back(complete_indices(runs[c].status));
    for (const std::size_t i : complete[c]) numbers[c].push_back(rows.runs()[i]);
  }
  std::vector<CellRuns> cells;
  for (std::size_t c = 0; c < n; ++c) cells.push_back({&readers[c], complete[c], numbers[c]});
  const std::vector<CellSums> sums = sums_of(cells, criteria, parallel);
  std::vector<NewGroup> groups(n);
  parallel.for_each(n, [&](std::size_t c) {
    const bool is_first = rows.runs().front() == 0;
    SumWriter words(is_first ? SumWriter::FirstRuns::keep : SumWriter::FirstRuns::leave_out);
    words.put(runs[c]);
    sums[c].write(words);
    groups[c].sums = packed(words.take());
    groups[c].cpu_seconds = rows.cpu_seconds(rows.cells()[c]);
    groups[c].head = {.first_run = rows.runs().front(),
                      .runs = rows.runs().size(),
                      .complete = complete[c].size(),
                      .failed = runs[c].failures.size(),
                      .layout = layout_of(sums[c]),
                      .words = groups[c].sums.size()};
  });
  return groups;
}

namespace {

struct ReadGroup {
  RunsOfGroup runs;
  CellSums sums;
};

/// Throws StudyError unless the runs of the sums are those that the head of the group lists.
void expect_group(const SumGroup& group, const ReadGroup& read) {
  const auto count = [&](RunStatus status) {
    return static_cast<std::uint64_t>(std::ranges::count(read.runs.status, status));
  };
  SumReader::expect(
      read.runs.status.size() == group.runs && count(RunStatus::complete) == group.complete &&
      count(RunStatus::failed) == group.failed && read.runs.failures.size() == group.failed &&
      read.sums.scores().runs() == group.complete);
}

/// Throws StudyError unless the words of a group are those of these sums.
void expect_layout(const SumGroup& group, const CellSums& sums) {
  if (group.layout == layout_of(sums)) return;
  throw StudyError(
      "its sums have another layout than those of this program: analyse it with "
      "the montecarta that made it ('montecarta info' tells), or run the study "
      "again");
}

ReadGroup read_group(const ResultFile& file, const SumGroup& group, const RunCriteria& criteria) {
  ReadGroup read{{}, CellSums(criteria)};
  expect_layout(group, read.sums);
  const Words words = unpacked(file.sums(group));
  SumReader reader(words);
  reader.get(read.runs);
  read.sums.read(reader);
  reader.expect_end();
  expect_group(group, read);
  return read;
}

/// Returns what `work` returns. Errors begin with the file and the cell.
template <class Work>
auto at_cell(const ResultFile& file, const StoredCell& cell, const Work& work) {
  try {
    return work();
  } catch (const StudyError& error) {
    throw StudyError("{}: cell '{}': {}", file.path(), cell.label, error.what());
  }
}

void take_runs(const SumGroup& group, const RunsOfGroup& runs, StoredSums& all) {
  std::size_t failed = 0;
  for (std::size_t i = 0; i < runs.status.size(); ++i) {
    const std::uint64_t run = group.first_run + i;
    if (runs.status[i] == RunStatus::complete) {
      all.complete.push_back(run);
    } else {
      const RunsOfGroup::Failure& failure = runs.failures[failed++];
      all.failures.push_back({run, failure.step, text_of(failure.reason)});
    }
  }
}

}  // namespace

std::vector<std::uint64_t> fingerprints_in_sums(const ResultFile& file, const StoredCell& cell) {
  std::vector<std::uint64_t> all;
  const RunCriteria criteria = criteria_of(file, kStoredLevel);
  return at_cell(file, cell, [&] {
    for (const SumGroup& group : file.sum_groups(cell)) {
      expect_layout(group, CellSums(criteria));
      const Words words = unpacked(file.sums(group));
      SumReader reader(words);
      RunsOfGroup runs;
      reader.get(runs);
      SumReader::expect(runs.fingerprint.size() == group.runs);
      append(all, runs.fingerprint);
    }
    return all;
  });
}

StoredSums read_stored_sums(const ResultFile& file, const StoredCell& cell,
                            const RunCriteria& criteria, const Parallel& parallel) {
  const std::vector<SumGroup> groups = file.sum_groups(cell);
  StoredSums all{{}, {}, CellSums(criteria)};
  at_cell(file, cell, [&] {
    for_each_in_order(
        parallel, groups.size(),
        [&](std::size_t g) { return read_group(file, groups[g], criteria); },
        [&](std::size_t g, ReadGroup&& group) {
          take_runs(groups[g], group.runs, all);
          all.sums.merge(std::move(group.sums));
        });
  });
  const std::vector<double> all_seconds = file.cpu_seconds_in_sums(cell);
  std::vector<double> seconds;
  for (const std::uint64_t run : all.complete)
    seconds.push_back(all_seconds[run - groups.front().first_run]);
  all.sums.put_cpu_seconds(std::move(seconds));
  return all;
}

}  // namespace montecarta::analysis
