// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/runs/monte_carlo.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/work_claim.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// One process of several that make the files of a folder, each by the same command.
class SharedWork {
 public:
  SharedWork(const Arguments& arguments, std::string command)
      : arguments_(arguments), command_(std::move(command)) {}

  const Arguments& arguments() const { return arguments_; }
  /// [s] Time without a sign of life after which another process counts as dead.
  double patience() const;
  void say(const std::string& line) const;
  /// Options by which a study is run to a file, within the rest of the time budget.
  RunOptions options_to(const std::filesystem::path& file) const;

  /// The exit code of a study that a checkpoint stopped, after `name` and the reason are said.
  int leave(const RunOutcome& outcome, const std::string& name, WorkClaim& claim) const;
  /// The exit code of a study that is finished, perhaps by a process that was told to stop.
  int finish(RunOutcome outcome) const;

  /// Has `make` make the claimed file unless it is there, and removes the claims on it. Returns the
  /// exit code that `make` returns. An error is noted in the claim, unless the claim was left.
  static int make_claimed(std::unique_ptr<WorkClaim> claim,
                          const std::function<int(WorkClaim&)>& make);

 private:
  const Arguments& arguments_;
  std::string command_;
  Stopwatch stopwatch_;
};

/// Throws RunError that names the files that nobody may begin again.
[[noreturn]] void refuse_to_begin(const std::vector<std::filesystem::path>& given_up,
                                  const std::string& command);

}  // namespace montecarta::experiments
