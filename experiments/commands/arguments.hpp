// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/core/plan.hpp"
#include "engine/records/result_description.hpp"
#include "engine/threads/parallel.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/study/make_plan.hpp"
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
  std::string name;    ///< name without dashes
  std::string letter;  ///< one letter, or "" if there is none
  std::string value;   ///< name of the value that follows it; empty: a flag
  std::string meaning;
  bool is_required = false;
  bool repeatable = false;
  bool is_list = false;  ///< whether it takes one or more values, up to the next option
};

/// A positional argument of a command.
struct OperandSpec {
  std::string name;  ///< name in the usage, e.g. "STUDY.ini"
  std::size_t least = 1;
  std::size_t most = 1;
};

/// The usage of a command. Both the parser and the help text are made from it.
struct CommandSpec {
  std::string name;
  std::string usage;                  ///< command line with operands and required options
  std::string summary;                ///< summary in one line
  std::vector<OperandSpec> operands;  ///< operands, of which only the last one may repeat
  std::vector<OptionSpec> options;
  std::string details;  ///< text at the end of --help, e.g. examples
};

/// Reads how commands are called from a text in the form of commands.md.
std::vector<CommandSpec> read_commands(const std::string& text);

/// The words that follow a command's name, checked against its CommandSpec.
class Arguments {
 public:
  /// Throws StudyError if a word is unknown, and suggests the nearest known spelling. An option
  /// whose value is called `a|b|c` takes one of these.
  Arguments(const CommandSpec& spec, std::vector<std::string> words);

  bool has(const std::string& option) const { return values_.contains(option); }
  /// The value of an option; nullopt if it was not given.
  std::optional<std::string> text(const std::string& option) const;
  /// All values of an option, in the order in which they were given.
  std::vector<std::string> texts(const std::string& option) const;
  /// The value of an option as a number within [least, most]; nullopt if it was not given. Throws
  /// StudyError if the value is not such a number.
  std::optional<double> number(const std::string& option, double least, double most) const;
  std::optional<std::uint64_t> count(const std::string& option, std::uint64_t least,
                                     std::uint64_t most) const;
  /// Positional arguments, and all words, in the order in which they were typed.
  const std::vector<std::string>& operands() const { return operands_; }
  const std::vector<std::string>& words() const { return words_; }

 private:
  void check_operands(const CommandSpec& spec) const;

  std::vector<std::string> words_;
  std::map<std::string, std::vector<std::string>> values_;
  std::vector<std::string> operands_;
};

/// The text of --help: "montecarta run STUDY.ini -o OUT.h5 [options]", summary, options, details.
std::string help_text(const CommandSpec& spec);

/// Returns `allowed` if --allow-external was given. Throws StudyError if it was not and a cell of
/// the study is an external program.
ExternalPrograms programs_of(const Study& study, const Arguments& arguments);
/// Reads the study that the first operand names, a file or a shipped study, and applies --set.
Study study_of(const Arguments& arguments);
/// Reads a study, a file or a shipped study, and applies values of --set.
Study study_named(const std::string& name, const std::vector<std::string>& overrides);
/// The runs of a shard, "I/N", of the study that has these settings.
RunRange shard_of(const Settings& settings, const std::string& shard);
/// Makes the plan of `study`, restricted by --runs or --shard, with external programs if
/// --allow-external was given.
StudyPlan plan_of(const Study& study, const Arguments& arguments);
/// [s] Shortest --time-budget. With a budget of zero no run would ever be done, and a script that
/// resumes would never end.
inline constexpr double kLeastBudget = 0.001;
/// Threads and backend as set by --threads, --backend and the environment.
Parallel parallel_of(const Arguments& arguments);
/// The provenance that is stored in a file that `command` makes: build, machine, command line,
/// threads.
TextPairs provenance_of(const std::string& command, const Arguments& arguments);

}  // namespace montecarta::experiments
