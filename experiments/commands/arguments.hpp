// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_description.hpp"
#include "engine/threads/parallel.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/study/study.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// One option of a command.
struct OptionSpec {
  std::string name;                 ///< without dashes
  std::string letter;               ///< one letter, or ""
  std::vector<std::string> values;  ///< names of what follows it; empty: a flag
  std::string meaning;
  bool repeatable = false;
  bool is_list = false;  ///< one value or more, up to the next option
};

/// What stands on a command's line besides options.
struct OperandSpec {
  std::string name;  ///< e.g. "STUDY.ini"
  std::size_t least = 1;
  std::size_t most = 1;
};

/// How a command is called; parsing and help come from this alone.
struct CommandSpec {
  std::string name;
  std::string summary;                ///< one line
  std::vector<OperandSpec> operands;  ///< of several only the last may repeat
  std::vector<OptionSpec> options;
  std::string details;  ///< the end of --help: examples
};

/// What a user typed behind a command's name, checked against its CommandSpec.
class Arguments {
 public:
  /// Throws StudyError naming the nearest known spelling of what is unknown.
  Arguments(const CommandSpec& spec, std::vector<std::string> words);

  bool has(const std::string& option) const { return values_.contains(option); }
  /// The value behind an option; nullopt where it is not given.
  std::optional<std::string> text(const std::string& option) const;
  /// All values behind an option, in the order given.
  std::vector<std::string> texts(const std::string& option) const;
  /// A number or whole number within limits; throws StudyError where it is none.
  std::optional<double> number(const std::string& option, double least, double most) const;
  std::optional<std::uint64_t> count(const std::string& option, std::uint64_t least,
                                     std::uint64_t most) const;
  /// One of `known`; the first where it is not given.
  std::string choice(const std::string& option, const std::vector<std::string>& known) const;
  /// As typed, in order.
  const std::vector<std::string>& operands() const { return operands_; }
  const std::vector<std::string>& words() const { return words_; }

 private:
  void check_operands(const CommandSpec& spec) const;

  std::vector<std::string> words_;
  std::map<std::string, std::vector<std::string>> values_;
  std::vector<std::string> operands_;
};

/// "montecarta run STUDY.ini -o OUT.h5 [options]" and all below it.
std::string help_text(const CommandSpec& spec);

/// One word as a POSIX shell reads it back.
std::string shell_quoted(const std::string& word);

/// Of options that several commands have.
inline constexpr const char* kWithinMeaning = "margin of the verdict; default: the study's";
inline constexpr const char* kLevelMeaning = "probability of the intervals; default 0.95";
inline constexpr const char* kThreadsMeaning = "number of threads; default: all available";
inline constexpr const char* kBackendMeaning = "thread library; results are the same";

/// Options that choose what part of a study runs and on how many threads: --set, --runs, --shard,
/// --threads, --backend.
std::vector<OptionSpec> plan_options();
/// --allow-external, without which no command starts a program that a study names.
OptionSpec external_option();
/// Whether that was given. Throws StudyError where it was not and a cell of the study is a program.
ExternalPrograms programs_of(const Study& study, const Arguments& arguments);
/// The study that is the first operand, a file or the name of a shipped study, changed by --set.
Study study_of(const Arguments& arguments);
/// Its plan, cut by --runs or --shard, with programs if --allow-external is given.
StudyPlan plan_of(const Study& study, const Arguments& arguments);
/// As --threads, --backend and the environment have it.
Parallel parallel_of(const Arguments& arguments);
/// How `command` makes a file, for the file: this build and machine, the command line, threads.
TextPairs provenance_of(const std::string& command, const Arguments& arguments);

}  // namespace montecarta::experiments
