// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/runs/recompute.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/archive_check.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/study/make_plan.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <unistd.h>

namespace montecarta::experiments {
namespace {

constexpr std::uint64_t kSample = 10;

std::vector<StoredRun> runs_stored(const ResultFile& file) {
  std::vector<StoredRun> stored;
  for (std::size_t c = 0; c < file.cells().size(); ++c) {
    const std::vector<RunStatus> status = file.status(file.cells()[c]);
    for (std::size_t i = 0; i < status.size(); ++i) {
      if (is_stored(status[i])) stored.push_back({c, i});
    }
  }
  return stored;
}

/// Checks the fingerprints of all stored runs outside the sample, prints the runs that do not
/// match, and returns their number.
std::size_t print_damaged(const ResultFile& file, const std::vector<StoredRun>& sample) {
  const auto is_in_sample = [&](std::size_t c, std::size_t i) {
    return std::ranges::any_of(
        sample, [&](const StoredRun& run) { return run.cell == c && run.run_index == i; });
  };
  std::size_t damaged = 0;
  for (std::size_t c = 0; c < file.cells().size(); ++c) {
    const StoredCell& cell = file.cells()[c];
    const std::vector<RunStatus> status = file.status(cell);
    for (std::size_t i = 0; i < status.size(); ++i) {
      if (status[i] == RunStatus::missing || is_in_sample(c, i)) continue;
      try {
        file.expect_whole(cell, i);
      } catch (const StudyError& error) {
        std::cout << wrapped(error.what(), output_width(), 2);
        ++damaged;
      }
    }
  }
  return damaged;
}

/// Sort key of a run in the random order that `seed` determines.
std::uint64_t draw_order(std::uint64_t seed, const StoredRun& run) {
  Fingerprint draw_order;
  draw_order.add(std::as_bytes(std::span(&seed, 1)));
  draw_order.add(std::as_bytes(std::span(&run, 1)));
  return draw_order.value();
}

/// A random sample of `count` runs (all if there are fewer), determined by `seed`.
std::vector<StoredRun> sample(std::vector<StoredRun> runs, std::uint64_t count,
                              std::uint64_t seed) {
  std::ranges::sort(runs, {}, [&](const StoredRun& run) { return draw_order(seed, run); });
  if (runs.size() > count) runs.resize(count);
  return runs;
}

/// The seed given by --seed, or one from the clock, which gives another sample at every call.
std::uint64_t seed_of(const Arguments& arguments) {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return arguments.count("seed", 0, UINT64_MAX)
      .value_or(static_cast<std::uint64_t>(now) % 1'000'000);
}

/// Computes the sums over one group of runs again, chosen by `seed`, if the file has sums. Prints
/// the result and returns whether they are equal.
bool verify_sums(const ResultFile& file, const StudyPlan& plan, std::uint64_t seed,
                 const Parallel& parallel) {
  if (!file.has_sums()) return true;
  const std::size_t g = draw_order(seed, {}) % file.sum_groups(file.cells().front()).size();
  const SumGroup chosen = file.sum_groups(file.cells().front())[g];
  std::filesystem::path folder = file.path();
  folder += ".verify." + std::to_string(::getpid());
  const auto computed = computed_group(plan, chosen.first_run, folder, parallel);
  bool are_equal = true;
  for (std::size_t c = 0; c < computed.size(); ++c) {
    const SumGroup stored = file.sum_groups(file.cells()[c])[g];
    const bool is_equal = stored.layout == computed[c].head.layout &&
                          stored.complete == computed[c].head.complete &&
                          file.sums(stored) == computed[c].sums;
    are_equal = are_equal && is_equal;
  }
  std::cout << wrapped(formatted("The sums over runs {} to {} {}", chosen.first_run,
                                 chosen.first_run + chosen.runs - 1,
                                 are_equal ? "are reproduced byte for byte" : "differ"),
                       output_width());
  return are_equal;
}

/// Throws StudyError unless one file is named, and no option of archives.
void require_one_result(const Arguments& arguments) {
  if (arguments.operands().size() != 1)
    throw StudyError("verify: one result is verified at a time: give one FILE.h5, or --archive");
  if (arguments.has("whole"))
    throw StudyError("verify: --whole is for archives (it would have no effect): add --archive");
}

}  // namespace

int verify_command(const Arguments& arguments) {
  const std::uint64_t seed = seed_of(arguments);
  if (arguments.has("archive")) return verify_archive(arguments, seed);
  require_one_result(arguments);
  const std::uint64_t count = arguments.count("sample", 1, UINT64_MAX).value_or(kSample);
  const ResultFile file = open_stored(arguments.operands().front());
  const std::vector<StoredRun> stored = runs_stored(file);
  if (stored.empty())
    throw StudyError(file.path().string() +
                     ": holds no run yet (nothing to compute again): run the study first");
  const std::vector<StoredRun> chosen = sample(stored, count, seed);
  const Study study = study_in(file, arguments);
  const StudyPlan plan = make_plan(study, std::nullopt, programs_of(study, arguments));
  const Recomputation again(file.path(), file.description(), plan);
  std::vector<std::optional<std::string>> differences(chosen.size());
  parallel_of(arguments).for_each(
      chosen.size(), [&](std::size_t i) { differences[i] = again.difference(chosen[i]); });
  const auto equal = std::ranges::count_if(differences, [](const auto& d) { return !d; });
  for (const auto& difference : differences) {
    if (difference) std::cout << wrapped(*difference, output_width(), 2);
  }
  const std::size_t damaged = print_damaged(file, chosen);
  std::cout << wrapped(
      formatted("{} of {} runs are reproduced byte for byte, out of {} stored (sample {})", equal,
                chosen.size(), stored.size(), seed),
      output_width());
  const bool sums_equal = verify_sums(file, plan, seed, parallel_of(arguments));
  return equal == std::ssize(chosen) && damaged == 0 && sums_equal ? kDone : kDifferent;
}

}  // namespace montecarta::experiments
