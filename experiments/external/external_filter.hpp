// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "experiments/external/child_process.hpp"
#include "experiments/external/messages.hpp"
#include "filters/setup/filter_kind.hpp"
#include "filters/setup/filter_setup.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// The settings by which a cell runs its external program.
struct ExternalCommand {
  std::vector<std::string> words;  ///< the program and its arguments
  double answer_limit = 30.0;      ///< [s] time limit of one answer
  /// [s] time limit of the first answer of a process, whose interpreter starts before it
  double start_limit() const { return 10.0 * answer_limit; }
  /// Whether one process serves all runs; otherwise each run has a new one.
  bool keeps_process = true;

  /// Results of the attempts to start the program, over all runs of its cell.
  struct Starts {
    std::atomic<bool> any_was_answered{false};
    std::atomic<int> failed{0};
  };
  std::shared_ptr<Starts> starts = std::make_shared<Starts>();
};
/// UnusableFilter stops the study after this many failed starts if no start has been answered.
inline constexpr int kHopelessStarts = 8;

/// A filter in any language: a process that receives the controls and detections of each run and
/// answers with its estimates (EXTERNAL_FILTERS.md). It is started in the first run and kept for
/// later runs; after an error the next run starts a new process. The results of a run depend on
/// that run alone, provided that the program resets its state at `start`. If a process that has
/// been used before does not answer `start` correctly, a new process is started for the run.
///
/// Between scans the program is asked for its prediction only if the study stores predictions. The
/// same holds for its map.
class ExternalFilter final : public SlamFilter {
 public:
  ExternalFilter(FilterSetup setup, ExternalCommand command);

  void start(const Pose& start) override;
  void predict(const StepContext& context, const Control& control, double duration) override;
  void update(const StepContext& context, Scan scan) override;
  PoseEstimate estimate() const override;
  const ScanReport& report() const override { return report_; }
  void map(std::span<std::optional<LandmarkEstimate>> landmarks) const override;

 private:
  /// The process and the messages of this run. A request changes the session, but not the estimate,
  /// so it may be made by a const function.
  struct ProgramSession {
    std::unique_ptr<ChildProcess> process;
    std::uint64_t next_id = 0;         ///< number of the next message in this run
    std::vector<ControlRow> controls;  ///< controls that are not yet sent to the program
    PoseMoments pose;                  ///< estimate of the pose in the last answer
  };

  void begin(const StepContext& context);
  void send_start(const RunStart& start) const;
  std::string_view ask(const std::string& message) const;
  /// Calls `use`, and ends the process if that throws.
  template <class Use>
  void use_process(const Use& use) const;

  FilterSetup setup_;
  ExternalCommand command_;
  Pose start_;
  bool is_begun_ = false;
  const StopFlag* stop_ = nullptr;
  ScanReport report_;
  std::unique_ptr<ProgramSession> session_;
};

/// Permission to start the programs that cells name. The user gives it when running a study; a
/// study file cannot.
enum class ExternalPrograms { refused, allowed };

/// Name of the option that gives this permission, without dashes.
inline constexpr const char* kAllowExternal = "allow-external";

/// Returns whether cells of this kind start a program.
bool starts_program(const FilterKind& filter);
/// The same for the kind of this name.
bool starts_program(std::string_view filter);

/// Pairs (word, SHA-256): the words of a command that are files now, relative to the current
/// folder. A word with white space, such as that of a shell behind -c, is split in turn. Programs
/// of the system, in /usr/bin and /usr/lib, and files to which a shell writes by > do not count.
std::vector<std::pair<std::string, std::string>> files_of_command(const std::string& command);

/// The kind of external programs: `cell = external command="python3 my_filter.py" label=mine`.
FilterKind external_kind();

}  // namespace montecarta::experiments
