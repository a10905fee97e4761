// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/output/number_text.hpp"
#include "analysis/output/text_table.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/run_record.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/commands/trial.hpp"

#include <algorithm>
#include <iostream>

namespace montecarta::experiments {
namespace {

std::string memory_text(double bytes) {
  if (std::isinf(bytes)) return "more than this machine has free: use fewer particles";
  return "about " + bytes_text(bytes);
}

struct Estimate {
  double cpu_seconds = 0.0;
  double disk = 0.0;        ///< [byte]
  double per_thread = 0.0;  ///< [byte]
};

/// Prints one row a cell and adds up what they need.
Estimate print_cells(const StudyPlan& plan) {
  Drive drive;
  plan.drives->generate(plan.first_run, drive);
  const Itinerary& itinerary = plan.drives->itinerary();
  const double runs = static_cast<double>(plan.runs_here());
  const double alike = runs_like_the_first(plan);
  Estimate total;
  const auto truth = static_cast<double>(itinerary.steps() * sizeof(Pose));
  total.disk = itinerary.has_truth ? runs * truth : 0.0;
  total.per_thread = 2.0 * truth;
  std::vector<TableRow> rows{{"cell", "filter", "ms a run", "a run", "all runs"}};
  for (const Cell& cell : plan.cells) {
    const std::optional<Trial> first = trial_of(cell, plan, drive);
    const double cpu_seconds = first.value_or(Trial{}).seconds * alike;
    const double bytes = static_cast<double>(RecordLayout(cell, plan.columns, itinerary).bytes());
    rows.push_back(
        {cell.label, cell.long_name,
         first ? std::to_string(std::max(1L, std::lround(cpu_seconds / runs * 1e3))) : "?",
         bytes_text(bytes), bytes_text(bytes * runs)});
    total.cpu_seconds += cpu_seconds;
    total.disk += bytes * runs;
    total.per_thread += bytes + first.value_or(Trial{}).bytes;
  }
  std::cout << aligned(rows);
  return total;
}

int check(const Arguments& arguments) {
  const Study study = study_of(arguments);
  const StudyPlan plan = plan_of(study, arguments);
  if (arguments.has("text")) {
    std::cout << plan.resolved_text;
    return kDone;
  }
  const Itinerary& itinerary = plan.drives->itinerary();
  const int threads = parallel_of(arguments).threads();
  std::cout << plan.title << "\n"
            << aligned(
                   {{"study", plan.name + ", seed " + std::to_string(plan.seed) + ", SHA-256 " +
                                  sha256(plan.resolved_text)},
                    {"runs", std::to_string(plan.runs_here()) + " of " + std::to_string(plan.runs) +
                                 " for each of " + std::to_string(plan.cells.size()) + " cells"},
                    {plan.drives->own_drives() > 0 ? "the longest run" : "a run",
                     std::to_string(itinerary.steps()) + " steps, " +
                         std::to_string(itinerary.scans()) + " scans, " +
                         duration_text(itinerary.step_time.back()) + " of driving, " +
                         std::to_string(itinerary.landmarks.size()) + " landmarks"}})
            << "\n";
  if (study.log != nullptr) {
    const std::string kind = study.settings.text("association", "kind");
    std::cout << "association: " << kind
              << (kind == "known" ? ", by the identities of the log\n\n"
                                  : ", by the filters themselves\n\n");
  }
  if (study.until) std::cout << "until: " << in_words(*study.until, plan.runs) << "\n\n";
  const Estimate total = print_cells(plan);
  std::cout << "\n"
            << aligned({{"time", (study.until ? "at most " : "about ") +
                                     duration_text(total.cpu_seconds / threads) + " on " +
                                     std::to_string(threads) + " threads (by a short trial)"},
                        {"memory", memory_text(total.per_thread * threads + 3e7)},
                        {"disk", bytes_text(total.disk)}});
  return kDone;
}

}  // namespace

Command check_command() {
  CommandSpec spec{.name = "check",
                   .summary =
                       "checks a study and prints its plan: cells, runs, steps, time, memory, "
                       "disk; runs nothing",
                   .operands = {{"STUDY.ini"}},
                   .options = plan_options(),
                   .details = {}};
  spec.options.push_back(
      {"text", "", {}, "print the study with every setting filled in, nothing else"});
  return {spec, check};
}

}  // namespace montecarta::experiments
