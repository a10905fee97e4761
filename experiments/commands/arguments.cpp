// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/arguments.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/provenance.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/visible_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "engine/threads/thread_budget.hpp"
#include "experiments/commands/array_index.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/text/words.hpp"

#include <boost/program_options.hpp>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <sstream>

namespace montecarta::experiments {
namespace {

/// Parses an option from a line of the help, e.g. "-o, --output OUT.h5  result file".
OptionSpec option_in(const std::string& line) {
  const std::size_t gap = std::min(line.find("  "), line.size());
  OptionSpec option;
  option.meaning = trimmed(line.substr(gap));
  for (const std::string& word : split(line.substr(0, gap), ' ')) {
    if (word.starts_with("--")) {
      option.name = word.substr(2);
    } else if (word.starts_with('-')) {
      option.letter = word.substr(1, 1);
    } else if (word == "...") {
      option.repeatable = true;
    } else {
      option.value = word;
      // A word such as "NAME,..." is one word with commas, not a list of words.
      option.is_list = word.ends_with("...") && word.find(",...") == std::string::npos;
    }
  }
  return option;
}

/// Parses an operand from a word of the usage: "FILE.h5", "FILE.h5..." or "[NAME]".
OperandSpec operand_in(std::string word) {
  OperandSpec operand;
  if (word.starts_with('[')) {
    operand.least = 0;
    word = word.substr(1, word.size() - 2);
  }
  if (word.ends_with("...")) {
    operand.most = SIZE_MAX;
    word.resize(word.size() - 3);
  }
  operand.name = word;
  return operand;
}

/// Parses a command from its usage, e.g. "replay FILE.h5 -o ONE.h5". Its options are read later.
CommandSpec command_in(const std::string& usage) {
  const std::vector<std::string> words = split(usage, ' ');
  CommandSpec command;
  command.name = words.front();
  command.usage = usage;
  for (std::size_t i = 1; i < words.size() && !words[i].starts_with('-'); ++i)
    command.operands.push_back(operand_in(words[i]));
  return command;
}

/// Returns whether the usage of a command has an option, which must then be given.
bool is_in_usage(const OptionSpec& option, const CommandSpec& command) {
  const std::vector<std::string> words = split(command.usage, ' ');
  return std::ranges::find(words, "--" + option.name) != words.end() ||
         (!option.letter.empty() && std::ranges::find(words, "-" + option.letter) != words.end());
}

/// Adds a line of the text to the details, as a line of its own or to the paragraph before it.
void add_detail(const std::string& line, std::string& details) {
  const bool is_item = line.starts_with("  ") && !line.starts_with("    ");
  const bool begins = details.empty() || details.ends_with('\n');
  if (line.empty() && !details.empty()) {
    details += "\n\n";
  } else if (is_item) {
    details += (begins ? "" : "\n") + line;
  } else if (!line.empty()) {
    details.append(begins ? "" : " ").append(trimmed(line));
  }
}

}  // namespace

std::vector<CommandSpec> read_commands(const std::string& text) {
  std::vector<CommandSpec> commands;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("## ")) {
      commands.push_back(command_in(line.substr(3)));
    } else if (commands.empty()) {
      continue;
    } else if (commands.back().summary.empty()) {
      commands.back().summary = line;
    } else if (line.starts_with("-") && commands.back().details.empty()) {
      commands.back().options.push_back(option_in(line));
    } else {
      add_detail(line, commands.back().details);
    }
  }
  const std::vector<OptionSpec> shared = commands.front().options;
  commands.erase(commands.begin());
  for (CommandSpec& command : commands) {
    while (command.details.ends_with('\n')) command.details.pop_back();
    for (OptionSpec& option : command.options) {
      if (option.meaning.empty())
        option = item_called(option.name, shared, &OptionSpec::name, "commands.md");
      option.is_required = is_in_usage(option, command);
    }
  }
  return commands;
}

namespace {

namespace po = boost::program_options;
using Texts = std::vector<std::string>;

constexpr const char* kOperands = "operands";

po::options_description described(const CommandSpec& spec) {
  po::options_description all;
  const auto add = [&](const OptionSpec& option) {
    const std::string names = option.name + (option.letter.empty() ? "" : "," + option.letter);
    if (option.value.empty()) {
      all.add_options()(names.c_str(), po::value<bool>()->zero_tokens()->implicit_value(true));
    } else {
      auto* values = po::value<Texts>()->composing();
      all.add_options()(names.c_str(), option.is_list ? values->multitoken() : values);
    }
  };
  std::ranges::for_each(spec.options, add);
  all.add_options()(kOperands, po::value<Texts>());
  return all;
}

Texts spellings_of(const CommandSpec& spec) {
  Texts names{"--help"};
  for (const OptionSpec& option : spec.options) names.push_back("--" + option.name);
  return names;
}

po::parsed_options parsed(const CommandSpec& spec, const Texts& words,
                          const po::options_description& all) {
  const po::positional_options_description positional =
      po::positional_options_description().add(kOperands, -1);
  const int style = po::command_line_style::default_style & ~po::command_line_style::allow_guessing;
  try {
    return po::command_line_parser(words).options(all).positional(positional).style(style).run();
  } catch (const po::unknown_option& error) {
    throw StudyError("{}: unknown option (montecarta {} has none of that name): {}",
                     error.get_option_name(), spec.name,
                     nearest_spelling(error.get_option_name(), spellings_of(spec)));
  } catch (const po::error& error) {
    throw StudyError("{}: {} (see the options below --help): correct the command", spec.name,
                     error.what());
  }
}

/// Text of an option with its value: "-o OUT.h5".
std::string spelling_of(const OptionSpec& option) {
  return formatted("{} {}", option.letter.empty() ? "--" + option.name : "-" + option.letter,
                   option.value);
}

/// Checks the values of an option that was given `times` times.
void check_values(const OptionSpec& option, const Texts& values, std::size_t times) {
  if (times > 1 && !option.repeatable) {
    throw StudyError("--{}: given {} times (once is meant): remove all but one", option.name,
                     times);
  }
  if (option.value.find('|') == std::string::npos) return;
  const Texts known = split(option.value, '|');
  item_called(
      values.front(), known, std::identity(),
      formatted("--{} {}: not known (one of {})", option.name, values.front(), joined(known)));
}

}  // namespace

Arguments::Arguments(const CommandSpec& spec, std::vector<std::string> words)
    : words_(std::move(words)) {
  const po::options_description all = described(spec);
  std::map<std::string, std::size_t> times;
  for (const auto& option : parsed(spec, words_, all).options) {
    if (option.string_key == kOperands || option.position_key >= 0) {
      operands_.insert(operands_.end(), option.value.begin(), option.value.end());
      continue;
    }
    auto& values = values_[option.string_key];
    values.insert(values.end(), option.value.begin(), option.value.end());
    ++times[option.string_key];
  }
  check_operands(spec);
  for (const OptionSpec& option : spec.options) {
    if (has(option.name)) check_values(option, texts(option.name), times[option.name]);
  }
  for (const OptionSpec& option : spec.options) {
    if (has(option.name) || !option.is_required) continue;
    throw StudyError("{}: {} is missing ({}): write montecarta {}", spec.name, spelling_of(option),
                     option.meaning, spec.usage);
  }
}

void Arguments::check_operands(const CommandSpec& spec) const {
  std::size_t least = 0;
  std::size_t most = 0;
  Texts names;
  for (const OperandSpec& operand : spec.operands) {
    if (operands_.size() < least + operand.least) {
      throw StudyError("{}: {} is missing (nothing to work on): see montecarta {} --help",
                       spec.name, operand.name, spec.name);
    }
    least += operand.least;
    most = operand.most > 1000 ? operand.most : most + operand.most;
    names.push_back(operand.name);
  }
  if (operands_.size() <= most) return;
  throw StudyError(
      "{}: stray argument (montecarta {} takes {}): remove it, or put its option before it",
      operands_[most], spec.name, names.empty() ? "options only" : joined(names, " "));
}

std::optional<std::string> Arguments::text(const std::string& option) const {
  const Texts all = texts(option);
  return all.empty() ? std::nullopt : std::optional(all.front());
}

std::vector<std::string> Arguments::texts(const std::string& option) const {
  const auto found = values_.find(option);
  return found == values_.end() ? Texts{} : found->second;
}

std::optional<double> Arguments::number(const std::string& option, double least,
                                        double most) const {
  const auto given = text(option);
  if (!given) return std::nullopt;
  const auto value = to_number(*given);
  if (value && *value >= least && *value <= most) return value;
  throw StudyError("--{} {}: not usable (a number from {} to {} is needed): correct it", option,
                   *given, to_text(least), to_text(most));
}

std::optional<std::uint64_t> Arguments::count(const std::string& option, std::uint64_t least,
                                              std::uint64_t most) const {
  const auto given = text(option);
  if (!given) return std::nullopt;
  const auto value = to_count(*given);
  if (value && *value >= least && *value <= most) return value;
  throw StudyError("--{} {}: not usable (a whole number from {} to {} is needed): correct it",
                   option, *given, least, most);
}

std::string help_text(const CommandSpec& spec) {
  TextPairs options;
  for (const OptionSpec& option : spec.options) {
    const std::string letter = option.letter.empty() ? "    " : formatted("-{}, ", option.letter);
    const std::string value = option.value.empty() ? "" : " " + option.value;
    options.emplace_back(formatted("{}--{}{}", letter, option.name, value), option.meaning);
  }
  options.emplace_back("    --help", "print this text");
  return wrapped(formatted("usage: montecarta {}{}\n\n{}\n\noptions:\n", spec.usage,
                           spec.options.empty() ? "" : " [options]", spec.summary),
                 output_width()) +
         listing(options) + wrapped("\n" + spec.details, output_width());
}

namespace {

std::optional<RunRange> range_of(const Arguments& arguments, const Settings& settings) {
  const std::uint64_t runs = settings.count("study", "runs");
  const auto range = arguments.text("runs");
  const auto shard = arguments.text("shard");
  if (range && shard) {
    throw StudyError("--runs and --shard: both choose runs (one is enough): remove one of them");
  }
  if (range) return parse_run_range(*range, runs);
  if (shard) return shard_of(settings, with_array_index(*shard));
  return std::nullopt;
}

/// Returns the file of a shipped study by its name in `montecarta list studies`; nullopt if there
/// is none.
std::optional<std::filesystem::path> shipped_study(const std::string& name) {
  if (name.find('/') != std::string::npos) return std::nullopt;
  return shipped_file("studies", name + ".ini");
}

std::string backend_of(const Arguments& arguments) {
  return arguments.text("backend").value_or("tbb");
}

}  // namespace

ExternalPrograms programs_of(const Study& study, const Arguments& arguments) {
  if (arguments.has(kAllowExternal)) return ExternalPrograms::allowed;
  for (const CellSpec& cell : study.cells) {
    if (!starts_program(*cell.filter)) continue;
    throw StudyError(
        "{}: cell {} is a program, which runs with all that you may do: {} (nothing is started "
        "unasked): if you trust it, add --{}",
        cell.place, cell.label, cell_line(cell), kAllowExternal);
  }
  return ExternalPrograms::refused;
}

Study study_named(const std::string& name, const std::vector<std::string>& overrides) {
  const auto shipped = std::filesystem::exists(name) ? std::nullopt : shipped_study(name);
  return read_study(shipped.value_or(name), known_filters(), overrides);
}

Study study_of(const Arguments& arguments) {
  return study_named(arguments.operands().front(), arguments.texts("set"));
}

RunRange shard_of(const Settings& settings, const std::string& shard) {
  const bool in_groups = settings.lists("record", "columns", "sums");
  return parse_shard(shard, settings.count("study", "runs"), in_groups ? kRunsOfAGroup : 1);
}

StudyPlan plan_of(const Study& study, const Arguments& arguments) {
  return make_plan(
      study, range_of(arguments, study.settings),
      arguments.has(kAllowExternal) ? ExternalPrograms::allowed : ExternalPrograms::refused);
}

Parallel parallel_of(const Arguments& arguments) {
  const std::string backend = backend_of(arguments);
  const int threads = thread_budget(arguments.text("threads"));
  if (backend == "serial") return Parallel::serial();
  return Parallel(backend == "openmp" ? Backend::openmp : Backend::tbb, threads);
}

TextPairs provenance_of(const std::string& command, const Arguments& arguments) {
  std::string line = "montecarta " + command;
  for (const std::string& word : arguments.words()) line += " " + shell_quoted(word);
  TextPairs provenance = collect_provenance();
  provenance.emplace_back("command_line", line);
  provenance.emplace_back("backend", backend_of(arguments));
  provenance.emplace_back("threads", std::to_string(parallel_of(arguments).threads()));
  return provenance;
}

}  // namespace montecarta::experiments
