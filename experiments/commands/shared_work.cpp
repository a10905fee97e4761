// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/shared_work.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/posix_file.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// [s] Network file systems show a change after a few seconds, and at most after a minute.
constexpr double kPatience = 60.0;

}  // namespace

double SharedWork::patience() const {
  return arguments_.number("patience", 0.1, 1e6).value_or(kPatience);
}

void SharedWork::say(const std::string& line) const {
  if (!arguments_.has("quiet")) std::cerr << "montecarta: " << line << "\n";
}

RunOptions SharedWork::options_to(const fs::path& file) const {
  RunOptions options;
  options.output = file;
  options.parallel = parallel_of(arguments_);
  options.attempt = true;
  options.time_budget = arguments_.number("time-budget", kLeastBudget, 1e9);
  if (options.time_budget)
    *options.time_budget = std::max(kLeastBudget, *options.time_budget - stopwatch_.seconds());
  options.progress = ProgressStyle::none;
  options.quiet = arguments_.has("quiet");
  options.provenance = provenance_of(command_, arguments_);
  return options;
}

int SharedWork::leave(const RunOutcome& outcome, const std::string& name, WorkClaim& claim) const {
  say(name + ": stopped at a checkpoint, from which the same command continues");
  claim.leave();
  return exit_code(outcome, runs_under_scheduler());
}

int SharedWork::finish(RunOutcome outcome) const {
  if (outcome.signal == StopReason::complete) return kDone;
  say("stopped by a signal; the same command continues");
  outcome.stopped = outcome.signal;
  return exit_code(outcome, runs_under_scheduler());
}

int SharedWork::make_claimed(std::unique_ptr<WorkClaim> claim,
                             const std::function<int(WorkClaim&)>& make) {
  const fs::path file = claim->file();
  int code = kDone;
  try {
    if (!is_there(file)) code = make(*claim);  // else it was finished while it was claimed
  } catch (const std::exception& error) {
    if (!is_there(file)) {
      claim->fail(error.what());
      throw;
    }  // else another process finished it, and removed the files of this one
  }
  claim.reset();
  if (is_there(file)) remove_claims(file);
  return code;
}

void refuse_to_begin(const std::vector<fs::path>& given_up, const std::string& command) {
  std::string files;
  for (const fs::path& file : given_up)
    files += formatted("\n  {}.claim.*: {}", file, trimmed(claims_on(file).text));
  throw RunError(
      "{}: {} workers were lost or failed over one file (it would end all workers one by one): "
      "remove the cause and these files, then start {} again:{}",
      command, kMostLosses, command, files);
}

}  // namespace montecarta::experiments
