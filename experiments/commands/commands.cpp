// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/commands.hpp"

#include "engine/errors.hpp"
#include "engine/records/provenance.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/visible_output.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <iostream>
#include <map>
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
    std::cout << "montecarta " << program_version() << " (" << instruction_set() << ")\n";
    return kDone;
  }
  const bool help_first = words[0] == "help";
  const std::string& name = words[help_first ? 1 : 0];
  const Command& command = item_called(
      name, commands, [](const Command& known) { return known.spec.name; },
      name + ": unknown command (see montecarta --help)");
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
  const std::map<std::string, CommandFunction*> functions = {{"run", run_command},
                                                             {"check", check_command},
                                                             {"info", info_command},
                                                             {"status", status_command},
                                                             {"merge", merge_command},
                                                             {"analyze", analyze_command},
                                                             {"report", report_command},
                                                             {"compare", compare_command},
                                                             {"gate", gate_command},
                                                             {"verify", verify_command},
                                                             {"replay", replay_command},
                                                             {"bounds", bounds_command},
                                                             {"plan", plan_command},
                                                             {"tune", tune_command},
                                                             {"export", export_command},
                                                             {"judge", judge_command},
                                                             {"list", list_command},
                                                             {"work", work_command},
                                                             {"benchmark", benchmark_command}};
  std::vector<Command> commands;
  for (CommandSpec& spec : read_commands(commands_text())) {
    CommandFunction* const function = functions.at(spec.name);
    commands.push_back({std::move(spec), function});
  }
  return commands;
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

}  // namespace montecarta::experiments
