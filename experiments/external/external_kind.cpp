// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/external/external_kind.hpp"

#include "engine/errors.hpp"
#include "experiments/external/external_filter.hpp"
#include "experiments/text/words.hpp"

#include <vector>

namespace montecarta::experiments {
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

Option command_option() {
  return {.key = "command",
          .meaning = "the program and its arguments, in quotes; started by --allow-external alone",
          .example = "\"python3 my_filter.py\""};
}

}  // namespace

FilterKind external_kind() {
  return {.name = kExternal,
          .long_name = "external program",
          .source = "experiments/EXTERNAL_FILTERS.md",
          .has_particles = false,
          .has_mixture = false,
          .has_joint = false,
          .options = {command_option(),
                      number_option("answer_limit", "30", 1e-3, 86400,
                                    "[s] to wait for an answer before the run fails"),
                      choice_option("process", kProcesses.front(), kProcesses,
                                    "one process of a worker for all its runs, or a new one each")},
          .sensors = {},
          .make = make_external};
}

bool starts_program(const FilterKind& filter) { return filter.name == kExternal; }

std::span<const FilterKind> known_filters() {
  static const std::vector<FilterKind> kinds = [] {
    std::vector<FilterKind> all(filter_kinds().begin(), filter_kinds().end());
    all.push_back(external_kind());
    return all;
  }();
  return kinds;
}

}  // namespace montecarta::experiments
