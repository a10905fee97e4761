// SPDX-License-Identifier: BSD-3-Clause
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/merge.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/runs/monte_carlo.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/shard_folder.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/commands/work_claim.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// [s] Time without a sign of life after which a worker counts as dead. Network file systems show a
/// change after a few seconds, and at most after a minute.
constexpr double kPatience = 60.0;

/// One worker: its command line, its folder and its study.
struct ShardWorker {
  const Arguments& arguments;
  ShardFolder folder;
  Study study;
  Stopwatch stopwatch = {};

  double patience() const { return arguments.number("patience", 0.1, 1e6).value_or(kPatience); }
  void say(const std::string& line) const {
    if (!arguments.has("quiet")) std::cerr << "montecarta: " << line << "\n";
  }
};

/// Throws StudyError unless the runs of a study can be divided into so many shards.
void require_shards(const Study& study, std::uint64_t shards) {
  const bool in_groups = study.settings.lists("record", "columns", "sums");
  const std::uint64_t runs = study.settings.count("study", "runs");
  const std::uint64_t unit = in_groups ? kRunsOfAGroup : 1;
  const std::uint64_t most = (runs + unit - 1) / unit;
  if (shards <= most) return;
  throw StudyError(
      "--shards {}: not usable (a shard holds at least {} of the study's {}): choose 1 to {}",
      shards, in_groups ? formatted("one group of {} runs", unit) : "one run", runs, most);
}

StudyPlan plan_of_shard(const Study& study, std::uint64_t index, std::uint64_t shards,
                        ExternalPrograms programs) {
  const std::string part = formatted("{}/{}", index, shards);
  return make_plan(study, shard_of(study.settings, part), programs);
}

/// Opens the folder, after making it if it has no plan yet.
ShardFolder folder_of(const Arguments& arguments) {
  const fs::path folder = fs::absolute(arguments.operands().front());
  const auto named = arguments.text("study");
  const auto shards = arguments.count("shards", 1, 1'000'000);
  if (named.has_value() != shards.has_value()) {
    throw StudyError(std::string(named ? "--study without --shards" : "--shards without --study") +
                     ": a folder is made of both: add the other, or leave both out if the folder "
                     "has a plan");
  }
  if (!named) return ShardFolder(folder);
  const Study study = study_named(*named, arguments.texts("set"));
  require_shards(study, *shards);
  const StudyPlan plan = plan_of_shard(study, 0, *shards, programs_of(study, arguments));
  return ShardFolder::make(folder, study,
                           {.runs = plan.runs,
                            .cells = plan.cells.size(),
                            .shards = *shards,
                            .program = fs::read_symlink("/proc/self/exe").string(),
                            .settings = settings_beside_text(study)});
}

RunOptions options_of(const ShardWorker& worker, const fs::path& shard) {
  const Arguments& arguments = worker.arguments;
  RunOptions options;
  options.output = shard;
  options.parallel = parallel_of(arguments);
  options.attempt = true;
  options.time_budget = arguments.number("time-budget", 0.001, 1e9);
  if (options.time_budget)
    *options.time_budget = std::max(0.001, *options.time_budget - worker.stopwatch.seconds());
  options.progress = ProgressStyle::none;
  options.quiet = arguments.has("quiet");
  options.provenance = provenance_of("work", arguments);
  return options;
}

/// Computes a shard. Returns 0, or the exit code of a process that was stopped at a checkpoint.
int compute(const ShardWorker& worker, WorkClaim& claim) {
  const std::uint64_t index = worker.folder.index_of(claim.file());
  const StudyPlan plan = plan_of_shard(worker.study, index, worker.folder.plan().shards,
                                       programs_of(worker.study, worker.arguments));
  const RunOptions options = options_of(worker, claim.file());
  RunOutcome outcome =
      plan.columns.sums ? run_summed_study(plan, options) : run_study(plan, options);
  const std::string name = formatted("shard {} of {}", index, worker.folder.plan().shards);
  if (outcome.counts.missing > 0) {
    worker.say(name + ": stopped at a checkpoint, from which any worker continues");
    claim.leave();
    return exit_code(outcome, runs_under_scheduler());
  }
  worker.say(
      formatted("{}: {} runs in {}{}", name, outcome.runs_here, duration_text(outcome.seconds),
                outcome.counts.failed == 0
                    ? ""
                    : formatted(", {} failed, which are results too", outcome.counts.failed)));
  if (outcome.signal == StopReason::complete) return kDone;
  worker.say("stopped by a signal; any worker continues");
  outcome.stopped = outcome.signal;
  return exit_code(outcome, runs_under_scheduler());
}

void merge_shards(const ShardWorker& worker) {
  const auto summary = merge_attempt(worker.folder.result(), worker.folder.shards());
  if (!summary) return worker.say("another worker has merged the shards");
  for (const std::string& note : summary->notes) worker.say(note);
  worker.say(
      formatted("{} shards merged to {}", worker.folder.plan().shards, worker.folder.result()));
}

/// Claims one of the missing files, or finds why there is none to claim.
ClaimSearch claim_one(const ShardWorker& worker, const std::vector<fs::path>& missing) {
  const double patience = worker.patience();
  if (auto claim = claim_free(missing, patience)) return {std::move(claim), {}};
  worker.say(formatted(
      "no shard is free; looking for at most {} whether the workers of the others are alive",
      duration_text(patience)));
  return watch_others(missing, patience);
}

/// Says in a claim why its worker failed. A damaged shard, which the message of the merge names, is
/// no loss of a worker.
void note_failure(const ShardWorker& worker, WorkClaim& claim, const std::exception& error) {
  const bool is_damage = dynamic_cast<const StudyError*>(&error) != nullptr;
  if (is_damage && claim.file() == worker.folder.result()) return claim.leave();
  claim.fail(error.what());
}

/// Makes a file that is claimed, and removes the claims on it. Returns as compute() does.
int make_claimed(const ShardWorker& worker, std::unique_ptr<WorkClaim> claim) {
  const fs::path file = claim->file();
  int code = kDone;
  try {
    if (!is_there(file)) {  // else it was finished while this worker claimed it
      if (file == worker.folder.result()) {
        merge_shards(worker);
      } else {
        code = compute(worker, *claim);
      }
    }
  } catch (const std::exception& error) {
    if (!is_there(file)) {
      note_failure(worker, *claim, error);
      throw;
    }  // else another worker finished it, and removed the files of this one
  }
  claim.reset();
  if (is_there(file)) remove_claims(file);
  return code;
}

/// Throws RunError that names the files that nobody may begin again.
[[noreturn]] void refuse_to_begin(const std::vector<fs::path>& given_up) {
  std::string files;
  for (const fs::path& file : given_up)
    files += formatted("\n  {}.claim.*: {}", file, trimmed(claims_on(file).text));
  throw RunError(
      "work: {} workers were lost or failed over one file (it would end all workers one by one): "
      "remove the cause and these files, then start work again:{}",
      kMostLosses, files);
}

/// Whether all shards were finished since `before` was found missing, or the result is there.
bool is_further(const ShardFolder& folder, const std::vector<fs::path>& before) {
  const std::vector<fs::path> now = folder.missing();
  return now.empty() || (now.front() == folder.result() && before.front() != folder.result());
}

}  // namespace

int work_command(const Arguments& arguments) {
  ShardFolder folder = folder_of(arguments);
  Study study = folder.study();
  const ShardWorker worker{arguments, std::move(folder), std::move(study)};
  programs_of(worker.study, arguments);
  const fs::path result = worker.folder.result();
  bool has_merged = false;
  for (auto missing = worker.folder.missing(); !missing.empty();
       missing = worker.folder.missing()) {
    ClaimSearch found = claim_one(worker, missing);
    if (found.claim) {
      has_merged = found.claim->file() == result;
      const int code = make_claimed(worker, std::move(found.claim));
      if (code != kDone) return code;
    } else if (!is_further(worker.folder, missing)) {
      if (!found.given_up.empty()) refuse_to_begin(found.given_up);
      worker.say(
          formatted("nothing to do: other workers are at {} files; the last one merges. If they "
                    "are ended, the same command continues",
                    missing.size()));
      return kDone;
    }
  }
  if (has_merged && !arguments.has("quiet") && print_verdict(result, parallel_of(arguments)))
    print_where_to_look(result.string(), "");
  worker.say(formatted("complete: all {} runs are in {}", worker.folder.plan().runs, result));
  return kDone;
}

}  // namespace montecarta::experiments
