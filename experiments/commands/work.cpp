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
#include "experiments/commands/shared_work.hpp"
#include "experiments/commands/stored_result.hpp"
#include "experiments/commands/summed_study.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/make_plan.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// One worker: its command line, its folder and its study.
struct ShardWorker {
  SharedWork work;
  ShardFolder folder;
  Study study;
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
                            .program = program_path().string(),
                            .settings = settings_beside_text(study)});
}

/// Computes a shard. Returns 0, or the exit code of a process that was stopped at a checkpoint.
int compute(const ShardWorker& worker, WorkClaim& claim) {
  const SharedWork& work = worker.work;
  const std::uint64_t index = worker.folder.index_of(claim.file());
  const StudyPlan plan = plan_of_shard(worker.study, index, worker.folder.plan().shards,
                                       programs_of(worker.study, work.arguments()));
  const RunOptions options = work.options_to(claim.file());
  const RunOutcome outcome =
      plan.columns.sums ? run_summed_study(plan, options) : run_study(plan, options);
  const std::string name = formatted("shard {} of {}", index, worker.folder.plan().shards);
  if (outcome.counts.missing > 0) return work.leave(outcome, name, claim);
  work.say(formatted("{}: {} runs in {}{}", name, outcome.runs_here, duration_text(outcome.seconds),
                     outcome.counts.failed == 0
                         ? ""
                         : formatted(", {} failed, which are results too", outcome.counts.failed)));
  return work.finish(outcome);
}

/// Merges the shards. A damaged shard, which the error names, is no loss of a worker.
int merge_shards(const ShardWorker& worker, WorkClaim& claim) {
  try {
    const auto summary = merge_attempt(worker.folder.result(), worker.folder.shards());
    if (!summary) {
      worker.work.say("another worker has merged the shards");
      return kDone;
    }
    for (const std::string& note : summary->notes) worker.work.say(note);
    worker.work.say(
        formatted("{} shards merged to {}", worker.folder.plan().shards, worker.folder.result()));
    return kDone;
  } catch (const StudyError&) {
    claim.leave();
    throw;
  }
}

/// Makes a file that is claimed, and removes the claims on it. Returns as compute() does.
int make_claimed(const ShardWorker& worker, std::unique_ptr<WorkClaim> claim) {
  return SharedWork::make_claimed(std::move(claim), [&](WorkClaim& own) {
    return own.file() == worker.folder.result() ? merge_shards(worker, own) : compute(worker, own);
  });
}

/// Claims one of the missing files, or finds why there is none to claim.
ClaimSearch claim_one(const ShardWorker& worker, const std::vector<fs::path>& missing) {
  const double patience = worker.work.patience();
  if (auto claim = claim_free(missing, patience)) return {std::move(claim), {}};
  worker.work.say(formatted(
      "no shard is free; looking for at most {} whether the workers of the others are alive",
      duration_text(patience)));
  return watch_others(missing, patience);
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
  const ShardWorker worker{SharedWork(arguments, "work"), std::move(folder), std::move(study)};
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
      if (!found.given_up.empty()) refuse_to_begin(found.given_up, "work");
      worker.work.say(
          formatted("nothing to do: other workers are at {} files; the last one merges. If they "
                    "are ended, the same command continues",
                    missing.size()));
      return kDone;
    }
  }
  if (has_merged && !arguments.has("quiet") && print_verdict(result, parallel_of(arguments)))
    print_where_to_look(result.string(), "");
  worker.work.say(formatted("complete: all {} runs are in {}", worker.folder.plan().runs, result));
  return kDone;
}

}  // namespace montecarta::experiments
