// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/archive_check.hpp"

#include "analysis/study/cell_sums.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/benchmark/archive_entry.hpp"
#include "experiments/benchmark/benchmark_study.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/files/passing_folder.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <iterator>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kUsualBlocks = 10;

struct BlockOfEntry {
  const ArchiveEntry* entry;
  std::uint64_t block;
};

std::vector<ArchiveEntry> entries_named(const std::vector<std::string>& operands) {
  if (operands.empty()) return read_entries(shipped_archive());
  std::vector<ArchiveEntry> entries;
  for (const std::string& name : operands) {
    std::vector<ArchiveEntry> some;
    if (!fs::is_directory(name)) {
      some.push_back(read_entry(name));
    } else {
      some = read_entries_of_world(name);
      if (some.empty()) some = read_entries(name);
    }
    if (some.empty())
      throw StudyError("{}: holds no entry (WORLD/LABEL.json): name another folder", name);
    std::ranges::move(some, std::back_inserter(entries));
  }
  return entries;
}

std::string name_of(const ArchiveEntry& entry) {
  return formatted("{}/{}", entry.world, entry.label);
}

/// The blocks of all entries, in a random order that `seed` determines.
std::vector<BlockOfEntry> shuffled_blocks(const std::vector<ArchiveEntry>& entries,
                                          std::uint64_t seed) {
  std::vector<BlockOfEntry> all;
  for (const ArchiveEntry& entry : entries) {
    for (std::uint64_t block = 0; block < entry.blocks.size(); ++block)
      all.push_back({&entry, block});
  }
  const auto order = [&](const BlockOfEntry& one) {
    const std::string key = formatted("{} {}", name_of(*one.entry), one.block);
    Fingerprint hash;
    hash.add(std::as_bytes(std::span(&seed, 1)));
    hash.add(std::as_bytes(std::span(key)));
    return hash.value();
  };
  std::ranges::sort(all, {}, order);
  return all;
}

/// Says why the study of an entry is not that of its world here; empty if it is.
std::string difference_of_study(const ArchiveEntry& entry) {
  const std::string text = resolved_text(benchmark_study(entry.world, entry.cell, entry.runs));
  if (sha256(text) == entry.study_sha256 && drives_sha256(text) == entry.drives_sha256) return "";
  return name_of(entry) +
         ": is not of the study that its world, cell and runs give here (another world, version "
         "or cell made it): make it again with 'montecarta benchmark'";
}

/// {score}{run} The scores of a file with rows of one cell.
ArchivedScores scores_of_rows(const ResultFile& file, const Parallel& parallel) {
  const StoredCell& cell = file.cells().front();
  const std::vector<RunStatus> status = file.status(cell);
  ArchivedScores all;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::vector<double> complete =
        first_values(file, cell, *find_score(kArchivedScores.at(k)), status.size(), parallel);
    auto next = complete.begin();
    for (const RunStatus each : status)
      all[k].push_back(each == RunStatus::complete ? archived(*next++) : kNaN);
  }
  return all;
}

bool are_equal(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Computes archived results again.
class ArchiveChecker {
 public:
  explicit ArchiveChecker(const Arguments& arguments)
      : arguments_(arguments), parallel_(parallel_of(arguments)) {}

  /// Says what differs from a block; empty if it is reproduced.
  std::string difference(const BlockOfEntry& one) {
    const ArchiveEntry& entry = *one.entry;
    const std::uint64_t first = one.block * kRunsOfArchivedBlock;
    const std::uint64_t last = std::min(first + kRunsOfArchivedBlock, entry.runs);
    const ResultFile rows(run(entry, first, last));
    const std::string runs = formatted("{}, runs {} to {}: ", name_of(entry), first, last - 1);
    const auto of_runs = rows.fingerprints(rows.cells().front());
    if (block_fingerprint(of_runs) != entry.blocks[one.block]) return runs + "estimates differ";
    const ArchivedScores scores = scores_of_rows(rows, parallel_);
    for (std::size_t k = 0; k < scores.size(); ++k) {
      const auto archived = std::span(entry.scores[k]).subspan(first, last - first);
      if (!std::ranges::equal(scores[k], archived, are_equal))
        return formatted("{}{} differs", runs, kArchivedScores.at(k));
    }
    return "";
  }

  /// Says what differs from an entry when all of its runs are computed again.
  std::string difference(const ArchiveEntry& entry) {
    const Study study = benchmark_study(entry.world, entry.cell, entry.runs);
    const StudyPlan plan = make_plan(study, std::nullopt, programs_of(study, arguments_));
    const RunOptions options = options_to_next_file();
    expect_all_runs(run_summed_study(plan, options));
    ArchiveEntry again = entry_of(ResultFile(options.output), entry.world, entry.cell, parallel_);
    again.made_by = entry.made_by;
    again.cpu_seconds = entry.cpu_seconds;
    return text_of(again) == text_of(entry) ? "" : name_of(entry) + ": its verdict or runs differ";
  }

 private:
  RunOptions options_to_next_file() {
    RunOptions options;
    options.output = folder_.path() / formatted("{}.h5", ++files_);
    options.parallel = parallel_;
    options.progress = ProgressStyle::none;
    options.quiet = true;
    return options;
  }

  static void expect_all_runs(const RunOutcome& outcome) {
    if (outcome.counts.missing > 0) throw RunError("verify: interrupted: call it again");
  }

  /// Runs a part of the study of an entry. Returns the file.
  fs::path run(const ArchiveEntry& entry, std::uint64_t first, std::uint64_t last) {
    const Study study = benchmark_study(entry.world, entry.cell, entry.runs);
    StudyPlan plan = make_plan(study, std::nullopt, programs_of(study, arguments_));
    plan.first_run = first;
    plan.last_run = last;
    const RunOptions options = options_to_next_file();
    expect_all_runs(run_study(plan, options));
    return options.output;
  }

  const Arguments& arguments_;
  Parallel parallel_;
  PassingFolder folder_;
  int files_ = 0;
};

/// Prints a difference, if there is one, and returns whether there is.
bool print_difference(const std::string& difference) {
  if (!difference.empty()) std::cout << wrapped(difference, output_width(), 2);
  return !difference.empty();
}

/// Prints the entries that are not of their studies, and returns the others.
std::vector<ArchiveEntry> of_their_studies(std::vector<ArchiveEntry> entries) {
  std::erase_if(entries, [](const ArchiveEntry& entry) {
    return print_difference(difference_of_study(entry));
  });
  return entries;
}

}  // namespace

int verify_archive(const Arguments& arguments, std::uint64_t seed) {
  const std::vector<ArchiveEntry> all = entries_named(arguments.operands());
  const std::vector<ArchiveEntry> entries = of_their_studies(all);
  std::vector<BlockOfEntry> blocks = shuffled_blocks(entries, seed);
  const std::uint64_t sample = arguments.count("sample", 1, UINT64_MAX).value_or(kUsualBlocks);
  const std::size_t stored = blocks.size();
  blocks.resize(std::min<std::size_t>(sample, stored));
  ArchiveChecker checker(arguments);
  std::size_t differ = 0;
  if (arguments.has("whole")) {
    for (const ArchiveEntry& entry : entries) differ += print_difference(checker.difference(entry));
    std::cout << entries.size() - differ << " of " << all.size()
              << " entries are reproduced, with all runs and the verdict\n";
  } else {
    for (const BlockOfEntry& block : blocks) differ += print_difference(checker.difference(block));
    std::cout << wrapped(formatted("{} of {} blocks of {} runs are reproduced byte for byte, out "
                                   "of the {} blocks of {} entries (sample {})",
                                   blocks.size() - differ, blocks.size(), kRunsOfArchivedBlock,
                                   stored, entries.size(), seed),
                         output_width());
  }
  return differ == 0 && entries.size() == all.size() ? kDone : kDifferent;
}

}  // namespace montecarta::experiments
