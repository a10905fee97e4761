// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/external_filter.hpp"

#include "engine/core/unusable_filter.hpp"
#include "engine/errors.hpp"
#include "engine/records/fingerprint.hpp"
#include "experiments/files/files.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace montecarta::experiments {

ExternalFilter::ExternalFilter(FilterSetup setup, ExternalCommand command)
    : setup_(std::move(setup)),
      command_(std::move(command)),
      session_(std::make_unique<ProgramSession>()) {}

/// The program receives the start only with the first step, which has the run's number and seed.
void ExternalFilter::start(const Pose& start) {
  start_ = start;
  is_begun_ = false;
  stop_ = nullptr;
  report_ = {};
  session_->controls.clear();
  session_->pose = {start, Eigen::Matrix3d::Zero()};
}

void ExternalFilter::predict(const StepContext& context, const Control& control, double duration) {
  begin(context);
  const auto controls = controls_of(setup_.belief.vehicle).size();
  ControlRow& row =
      session_->controls.emplace_back(control.values.begin(), control.values.begin() + controls);
  row.push_back(duration);
}

void ExternalFilter::update(const StepContext& context, Scan scan) {
  begin(context);
  use_process([&](ProgramSession& session) {
    const std::uint64_t id = session.next_id++;
    const std::string_view line =
        ask(scan_message(id, session.controls, scan, setup_.association.kind,
                         components_of(setup_.belief.sensor).size()));
    const ProgramEstimate estimate = read_estimate(line, id);
    session.pose = estimate.pose;
    session.controls.clear();
    report_ = estimate.report;
  });
}

PoseEstimate ExternalFilter::estimate() const {
  if (session_->controls.empty()) return {session_->pose, std::nullopt};
  use_process([&](ProgramSession& session) {
    const std::uint64_t id = session.next_id++;
    session.pose = read_estimate(ask(predict_message(id, session.controls)), id).pose;
    session.controls.clear();
  });
  return {session_->pose, std::nullopt};
}

void ExternalFilter::map(std::span<std::optional<LandmarkEstimate>> landmarks) const {
  use_process([&](ProgramSession& session) {
    const std::uint64_t id = session.next_id++;
    read_map(ask(map_message(id)), id, setup_.association.kind, landmarks);
  });
}

void ExternalFilter::begin(const StepContext& context) {
  if (is_begun_) return;
  is_begun_ = true;
  stop_ = context.stop();
  StreamIdentity identity = context.identity(Draw::external_filter, 0);
  identity.step = 0;  // the seed must not depend on the step of the first message
  const auto seed = static_cast<std::uint32_t>(RngStream(identity).bits() >> 32U);
  const RunStart start{context.run(), seed, start_};
  if (!command_.keeps_process) session_->process.reset();
  if (session_->process != nullptr) {
    try {
      send_start(start);
      return;
    } catch (const ProgramError&) {
      if (stop_ != nullptr && stop_->is_set()) throw;
    }
  }
  send_start(start);
}

void ExternalFilter::send_start(const RunStart& start) const {
  try {
    use_process([&](ProgramSession& session) {
      if (session.process == nullptr)
        session.process = std::make_unique<ChildProcess>(command_.words);
      session.next_id = 1;
      read_started(ask(start_message(0, start, setup_)), 0);
    });
    command_.starts->any_was_answered = true;
  } catch (const ProgramError& error) {
    if (stop_ != nullptr && stop_->is_set()) throw;
    if (command_.starts->any_was_answered || ++command_.starts->failed < kHopelessStarts) throw;
    throw UnusableFilter(
        "program '{}': none of its first {} starts was answered ({}): mend the program and give "
        "the same command again",
        command_.words.front(), kHopelessStarts, error.what());
  }
}

std::string_view ExternalFilter::ask(const std::string& message) const {
  if (session_->process == nullptr) throw ProgramError("program is gone");
  const bool is_started = session_->process->has_answered();
  return session_->process->exchange(
      message, {is_started ? command_.answer_limit : command_.start_limit(), stop_});
}

template <class Use>
void ExternalFilter::use_process(const Use& use) const {
  try {
    use(*session_);
  } catch (...) {
    session_->process.reset();
    throw;
  }
}

namespace {

constexpr const char* kExternal = "external";
const std::vector<std::string> kProcesses{"kept", "new"};

std::unique_ptr<SlamFilter> make_external(const FilterSetup& setup) {
  const FilterOptions& options = setup.options;
  ExternalCommand command{.words = quoted_words(options.choice("command")),
                          .answer_limit = options.number("answer_limit"),
                          .keeps_process = options.choice("process") == kProcesses.front()};
  if (command.words.empty())
    throw StudyError("command is empty (nothing to start): name a program");
  find_program(command.words.front());
  return std::make_unique<ExternalFilter>(setup, std::move(command));
}

Parameter command_option() {
  return {
      .key = "command",
      .meaning = "program and its arguments, in quotes; it is only started with --allow-external",
      .example = "\"python3 my_filter.py\""};
}

/// The words of a command of a shell; none if a quote is not closed.
std::vector<std::string> words_for_shell(const std::string& command) {
  try {
    return quoted_words(command);
  } catch (const StudyError&) {
    return {};
  }
}

/// Adds words of a command to `all`: those given and, where one has white space, those within.
/// Leaves out files to which a shell writes: `2>>log.txt`, `> log.txt`.
void add_words(const std::vector<std::string>& words, std::vector<std::string>& all) {
  bool is_written = false;
  for (const std::string& word : words) {
    const bool has_blanks = word.find_first_of(" \t\r\n") != word.npos;
    const bool is_redirection = !has_blanks && word.find('>') != word.npos;
    if (!is_written && !is_redirection) all.push_back(word);
    is_written = is_redirection && word.ends_with('>');
    if (has_blanks) add_words(words_for_shell(word), all);
  }
}

}  // namespace

bool starts_program(const FilterKind& filter) { return starts_program(filter.name); }
bool starts_program(std::string_view filter) { return filter == kExternal; }

std::vector<std::pair<std::string, std::string>> files_of_command(const std::string& command) {
  std::vector<std::pair<std::string, std::string>> files;
  std::vector<std::string> words;
  add_words(quoted_words(command), words);
  for (const std::string& word : words) {
    if (std::ranges::count(files, word, &std::pair<std::string, std::string>::first) > 0) continue;
    std::error_code none;
    const std::filesystem::path path = std::filesystem::canonical(word, none);
    if (none || !std::filesystem::is_regular_file(path, none)) continue;
    const std::string name = path.string();
    const bool is_of_system = name.starts_with("/usr/bin/") || name.starts_with("/usr/lib/");
    if (!is_of_system) files.emplace_back(word, sha256(whole_file(path)));
  }
  return files;
}

FilterKind external_kind() {
  return {
      .name = kExternal,
      .long_name = "external program",
      .source = "experiments/EXTERNAL_FILTERS.md",
      .reports = {},
      .options =
          {command_option(),
           number_parameter("answer_limit", "30", 1e-3, 86400,
                            "seconds to wait for an answer before the run fails"),
           choice_parameter(
               "process", kProcesses.front(), kProcesses,
               "whether a process is kept for all runs of a worker or started anew for each run")},
      .sensors = {},
      .make = make_external};
}

}  // namespace montecarta::experiments
