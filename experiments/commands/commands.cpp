// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"

#include "engine/errors.hpp"
#include "engine/records/provenance.hpp"
#include "experiments/commands/listing.hpp"
#include "experiments/commands/output_guard.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>
#include <new>
#include <unistd.h>

namespace montecarta::experiments {
namespace {

std::string general_help(const std::vector<Command>& commands) {
  TextPairs items;
  for (const Command& command : commands)
    items.emplace_back(command.spec.name, command.spec.summary);
  return wrapped(
             "montecarta runs Monte Carlo studies of SLAM filters and tests whether their "
             "covariances can be trusted.\n\n"
             "usage: montecarta COMMAND ...\n\n",
             output_width()) +
         listing(items) +
         wrapped(
             "\nBegin with: montecarta run first_study\n"
             "More about a command: montecarta COMMAND --help\n"
             "Version: montecarta --version\n",
             output_width());
}

const Command& find_command(const std::vector<Command>& commands, const std::string& name) {
  const auto found =
      std::ranges::find_if(commands, [&](const Command& c) { return c.spec.name == name; });
  if (found != commands.end()) return *found;
  std::vector<std::string> known;
  for (const Command& command : commands) known.push_back(command.spec.name);
  throw StudyError(name +
                   ": unknown command (see montecarta --help): " + nearest_spelling(name, known));
}

bool asks_for_help(const std::vector<std::string>& words) {
  return std::ranges::any_of(
      words, [](const std::string& word) { return word == "--help" || word == "-h"; });
}

int dispatch(const std::vector<std::string>& words) {
  const std::vector<Command> commands = all_commands();
  if (words.empty()) {
    std::cerr << general_help(commands);
    return kWrongInput;
  }
  if (words[0] == "--help" || words[0] == "-h" || (words[0] == "help" && words.size() == 1)) {
    std::cout << general_help(commands);
    return kDone;
  }
  if (words[0] == "--version") {
    std::cout << "montecarta " << program_version() << "\n";
    return kDone;
  }
  const bool help_first = words[0] == "help";
  const Command& command = find_command(commands, words[help_first ? 1 : 0]);
  if (help_first || asks_for_help(words)) {
    std::cout << help_text(command.spec);
    return kDone;
  }
  return command.run(Arguments(command.spec, {words.begin() + 1, words.end()}));
}

int print_error(const std::string& message, int code) {
  std::cout.flush();
  // A log gets the message as one line, so that it can be searched; a terminal gets whole words.
  const std::size_t width = ::isatty(STDERR_FILENO) == 1 ? output_width(STDERR_FILENO) : SIZE_MAX;
  std::cerr << wrapped("montecarta: " + shortened(message), width, 2);
  return code;
}

}  // namespace

std::vector<Command> all_commands() {
  return {run_command(),   check_command(),   info_command(),   status_command(),
          merge_command(), analyze_command(), report_command(), compare_command(),
          gate_command(),  verify_command(),  replay_command(), bounds_command(),
          plan_command(),  export_command(),  judge_command(),  list_command()};
}

int run_program(const std::vector<std::string>& words) {
  const VisibleOutput to_output(std::cout), to_errors(std::cerr);
  try {
    const int code = dispatch(words);
    std::cout.flush();
    return std::cout.good()
               ? code
               : print_error("standard output cannot be written (closed or full): redirect it",
                             kFailed);
  } catch (const StudyError& error) {
    return print_error(error.what(), kWrongInput);
  } catch (const std::bad_alloc&) {
    return print_error(
        "out of memory (the study is too large for this machine): use fewer particles or "
        "record.rate = scan",
        kFailed);
  } catch (const std::exception& error) {
    return print_error(error.what(), kFailed);
  }
}

std::string help_text(const CommandSpec& spec) {
  std::string usage = "usage: montecarta " + spec.name;
  for (const OperandSpec& operand : spec.operands) {
    const std::string name = operand.name + (operand.most > 1 ? "..." : "");
    usage += operand.least > 0 ? " " + name : " [" + name + "]";
  }
  TextPairs options;
  for (const OptionSpec& option : spec.options) {
    const std::string letter = option.letter.empty() ? "    " : "-" + option.letter + ", ";
    const std::string values = option.values.empty() ? "" : " " + joined(option.values, " ");
    options.emplace_back(letter + "--" + option.name + values, option.meaning);
  }
  options.emplace_back("    --help", "print this text");
  return wrapped(usage + (spec.options.empty() ? "" : " [options]") + "\n\n" + spec.summary +
                     "\n\noptions:\n",
                 output_width()) +
         listing(options) +
         wrapped(spec.details.empty() ? "" : "\n" + spec.details, output_width());
}

std::string shell_quoted(const std::string& word) {
  const char* plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./:=,+@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace montecarta::experiments
