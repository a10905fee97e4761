// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/slam_filter.hpp"
#include "experiments/external/child_process.hpp"
#include "experiments/external/messages.hpp"
#include "filters/factory.hpp"
#include "filters/setup/filter_setup.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// How a cell asks for a program outside of ours.
struct ExternalCommand {
  std::vector<std::string> words;  ///< the program and its arguments
  double answer_limit = 30.0;      ///< [s] to wait for one answer
  bool keeps_process = true;       ///< one process for all runs, else a new one for each

  /// How the starts of the program went, in all runs of its cell together.
  struct Starts {
    std::atomic<bool> any_was_answered{false};
    std::atomic<int> failed{0};
  };
  std::shared_ptr<Starts> starts = std::make_shared<Starts>();
};
/// After so many starts without one that was answered the study is stopped.
inline constexpr int kHopelessStarts = 8;

/// A filter in any language: a process that is told each run's controls and detections and asked
/// what it believes (EXTERNAL_FILTERS.md). It is started at the first run and kept; after a failure
/// the next run has a new one. What a run gives depends on that run alone as long as the program
/// forgets at `start` what came before: a run whose `start` is not answered rightly by a process
/// that was used before is told to a new one.
///
/// Between scans the program is asked what it predicts only where the study stores that, and for
/// its map likewise.
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
  /// The process, and what has been said in this run. Asking changes it, not what is believed.
  struct Session {
    std::unique_ptr<ChildProcess> process;
    std::uint64_t next_id = 0;         ///< of the messages of this run
    std::vector<ControlRow> controls;  ///< that the program has not been told
    PoseMoments pose;                  ///< what it last said
  };

  void begin(const StepContext& context);
  void tell_start(const RunStart& start) const;
  std::string_view ask(const std::string& message) const;
  /// Calls `use`; the process does not survive what goes wrong.
  template <class Use>
  void use_process(const Use& use) const;

  FilterSetup setup_;
  ExternalCommand command_;
  Pose start_;
  bool is_begun_ = false;
  const StopFlag* stop_ = nullptr;
  ScanReport report_;
  std::unique_ptr<Session> session_;
};

/// Whether a cell may start the program that it names. Who runs a study says so; the study does
/// not.
enum class ExternalPrograms { refused, allowed };

/// The option that says it, without dashes.
inline constexpr const char* kAllowExternal = "allow-external";

/// A program outside of ours: "cell = external command="python3 my_filter.py" label=mine".
FilterKind external_kind();

/// Whether cells of this kind start a program.
bool starts_program(const FilterKind& filter);

/// What a study may name: the filters of the table, then `external`.
std::span<const FilterKind> known_filters();

}  // namespace montecarta::experiments
