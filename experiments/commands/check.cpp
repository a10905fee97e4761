// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/check.hpp"

#include "analysis/render/tables/terminal.hpp"
#include "analysis/study/stored_sums.hpp"
#include "analysis/study/text_table.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/posix_file.hpp"
#include "engine/records/result_description.hpp"
#include "engine/records/run_record.hpp"
#include "engine/runs/step.hpp"
#include "engine/runs/worker.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"
#include "engine/text/wrapped_text.hpp"
#include "experiments/commands/arguments.hpp"
#include "experiments/commands/commands.hpp"
#include "experiments/study/enough_runs.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <iostream>
#include <limits>
#include <malloc.h>
#include <new>
#include <numeric>
#include <set>
#include <sys/resource.h>
#include <unistd.h>

namespace montecarta::experiments {
namespace {

constexpr double kTrialSeconds = 0.25;

/// [byte] Memory of a process with one thread and no filter, most of it the program and libraries.
constexpr double kProgramBytes = 2.6e7;

/// [byte/s] Rate at which one thread hands its runs to the operating system. No disk is faster.
constexpr double kWritingRate = 1.9e8;

/// Memory of this process without the pages of files, such as the program [byte].
double private_bytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0.0, resident = 0.0, shared = 0.0;
  file >> all >> resident >> shared;
  return (resident - shared) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

/// Time of a trial: that of this thread, which does not grow while others use the processor, or for
/// a program of the user, which runs elsewhere, the time that has passed.
class TrialClock {
 public:
  explicit TrialClock(const Cell& cell) : is_elsewhere_(cell.filter == "external") {}
  double seconds() const { return is_elsewhere_ ? stopwatch_.seconds() : cpu_.seconds(); }

 private:
  bool is_elsewhere_;
  Stopwatch stopwatch_;
  engine::CpuClock cpu_;
};

/// Limits the memory of this process, while the object exists, to the free memory of the
/// machine, so that an allocation beyond it throws an exception instead of ending the process.
class WithinFreeMemory {
 public:
  WithinFreeMemory() {
    ::getrlimit(RLIMIT_AS, &before_);
    std::ifstream file("/proc/self/statm");
    double pages = 0.0;
    file >> pages;
    const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
    const double free = static_cast<double>(::sysconf(_SC_AVPHYS_PAGES)) * page;
    struct rlimit within = before_;
    within.rlim_cur = std::min(before_.rlim_cur, static_cast<rlim_t>(pages * page + 0.9 * free));
    ::setrlimit(RLIMIT_AS, &within);
  }
  ~WithinFreeMemory() { ::setrlimit(RLIMIT_AS, &before_); }
  WithinFreeMemory(const WithinFreeMemory&) = delete;
  WithinFreeMemory& operator=(const WithinFreeMemory&) = delete;

 private:
  struct rlimit before_ {};
};

StepContext first_run_at(const StudyPlan& plan, std::size_t k) {
  return {plan.seed, plan.first_run, static_cast<std::uint32_t>(k), Parallel::serial()};
}

/// Performs step `k` of the first run. `scan` is the index of the next scan.
void step_through(SlamFilter& filter, const StudyPlan& plan, const engine::RunInput& input,
                  std::size_t k, std::size_t& scan) {
  const StepContext context = first_run_at(plan, k);
  engine::take_step(filter, context, input, scan, [&](std::size_t now) {
    engine::update_with_scan(filter, context, input, now);
    return true;
  });
  (void)filter.estimate();
}

/// Number of different landmarks that are detected in the first `scans` scans.
double landmarks_in(const Drive& drive, std::size_t scans) {
  std::set<std::int32_t> seen;
  for (std::size_t s = 0; s < scans; ++s) {
    for (const Detection& detection : drive.scan(s)) seen.insert(detection.identity);
  }
  return static_cast<double>(seen.size());
}

/// Memory that a filter holds after a number of steps.
struct Held {
  std::size_t steps = 0;
  double bytes = 0.0;
};

/// Extrapolates the memory of a filter to the end of a drive from its memory at two times. It grows
/// with the number of landmarks if every particle has a map, and with its square if there is one
/// joint covariance. A filter that keeps its path also grows with the number of steps.
double bytes_at_end(const Cell& cell, const Itinerary& itinerary, const Drive& drive,
                    const Held& half, const Held& end) {
  const auto landmarks_by = [&](std::size_t steps) {
    std::size_t scans = 0;
    while (scans < itinerary.scans() && itinerary.scan_step[scans] < steps) ++scans;
    return landmarks_in(drive, scans);
  };
  const double before = landmarks_by(half.steps), now = landmarks_by(end.steps);
  const double all = landmarks_by(itinerary.steps());
  const double by_steps = static_cast<double>(itinerary.steps() - end.steps) /
                          static_cast<double>(std::max<std::size_t>(end.steps - half.steps, 1));
  double rest = by_steps;  // growth until the end, in units of the growth between the two times
  if (now > before && cell.particles > 0) rest = (all - now) / (now - before);
  if (now > before && cell.particles == 0)
    rest = std::max(by_steps, (all * all - now * now) / (now * now - before * before));
  return end.bytes + rest * std::max(0.0, end.bytes - half.bytes);
}

}  // namespace

std::optional<Trial> trial_of(const Cell& cell, const StudyPlan& plan, const Drive& drive) {
  const Itinerary& itinerary = plan.drives->itinerary_of(plan.first_run);
  const engine::RunInput input{itinerary, drive};
  const std::size_t steps = itinerary.steps();
  const WithinFreeMemory limit;
  ::malloc_trim(0);  // memory left by an earlier trial would hide that of this one
  const double before = private_bytes();
  TrialClock clock(cell);
  double first = 0.0, all = 0.0;
  Held half, end;
  std::size_t k = 0;
  try {
    const std::unique_ptr<SlamFilter> filter = cell.make_filter();
    std::size_t scan = 0;
    // An external program is started in the first step of its first run.
    engine::start_filter(*filter, first_run_at(plan, 0), input);
    step_through(*filter, plan, input, 0, scan);
    scan = 0;
    clock = TrialClock(cell);
    engine::start_filter(*filter, first_run_at(plan, 0), input);
    for (; k < steps && all < kTrialSeconds; ++k) {
      step_through(*filter, plan, input, k, scan);
      all = clock.seconds();
      if (k == 0) first = all;
      if (half.steps == 0 && scan > 0 && 2.0 * all > kTrialSeconds) {
        half = {k + 1, private_bytes() - before};
      }
    }
    end = {k, private_bytes() - before};
  } catch (const std::bad_alloc&) {
    return Trial{.seconds = 0.0, .bytes = std::numeric_limits<double>::infinity()};
  } catch (const std::exception&) {
    return std::nullopt;
  }
  const double share =
      static_cast<double>(steps - 1) / static_cast<double>(std::max<std::size_t>(k, 2) - 1);
  return Trial{.seconds = first + (all - first) * share,
               .bytes = bytes_at_end(cell, itinerary, drive, half, end)};
}

double runs_like_the_first(const StudyPlan& plan) {
  if (plan.drives->own_drives() == 0) return static_cast<double>(plan.runs_here());
  const auto steps = [&](std::uint64_t run) {
    return static_cast<double>(plan.drives->itinerary_of(run).steps());
  };
  double all = 0.0;
  for (std::uint64_t run = plan.first_run; run < plan.last_run; ++run) all += steps(run);
  return all / steps(plan.first_run);
}

namespace {

std::string memory_text(double bytes) {
  if (std::isinf(bytes)) return "more than this machine has free: use fewer particles";
  return "about " + bytes_text(bytes);
}

/// [byte] Estimated size of the result file.
double size_of_file(const StudyPlan& plan) {
  if (!plan.columns.sums) return describe(plan, {}).bytes();
  StudyPlan first_runs = plan;  // only these runs are stored as rows
  const std::uint64_t kept = std::max(kRunsBesideSums, plan.columns.full_runs);
  first_runs.last_run = std::min(plan.first_run + kept, plan.last_run);
  const double sums = bytes_of_sums(plan.runs_here(), plan.drives->itinerary().scans());
  return describe(first_runs, {}).bytes() + sums * static_cast<double>(plan.cells.size());
}

/// Estimated cost of a study, with a table row for each cell below the headings.
struct Costs {
  double cpu_seconds = 0.0;
  double disk = 0.0;        ///< [byte] size of the result file
  double written = 0.0;     ///< [byte] size of the runs, which may be more than is kept
  double per_thread = 0.0;  ///< [byte] memory of one thread
  /// [byte] Largest first: records of runs that are stored in full, each held by one thread while
  /// it makes the run.
  std::vector<double> full_records = {};
  std::vector<TableRow> rows{{"run time", "run size", "all runs"}};

  /// [byte] Memory of the process.
  double memory(int threads) const {
    const auto most = std::min(full_records.size(), static_cast<std::size_t>(threads));
    const auto last = full_records.begin() + static_cast<std::ptrdiff_t>(most);
    return kProgramBytes + per_thread * threads + std::accumulate(full_records.begin(), last, 0.0);
  }
};

std::string time_of_run(const std::optional<Trial>& trial, double seconds) {
  if (!trial) return "?";
  if (seconds >= 1.0) return duration_text(seconds);
  return std::to_string(std::max(1L, std::lround(seconds * 1e3))) + " ms";
}

Costs costs_of(const StudyPlan& plan) {
  Drive drive;
  plan.drives->generate(plan.first_run, drive);
  const Itinerary& itinerary = plan.drives->itinerary();
  const double runs = static_cast<double>(plan.runs_here());
  const double alike = runs_like_the_first(plan);
  const ResultDescription file = describe(plan, {});
  const std::size_t n_full_runs = file.full_runs_here();
  const auto full_runs = static_cast<double>(n_full_runs);
  const std::vector<RecordLayout> layouts = layouts_of(plan, Detail::usual);
  const std::vector<RecordLayout> full_layouts = layouts_of(plan, Detail::full);
  Costs costs;
  costs.disk = size_of_file(plan);
  costs.written = file.bytes();
  double largest_record = 0.0;
  costs.per_thread = 2.0 * static_cast<double>(itinerary.steps() * sizeof(Pose));
  for (std::size_t c = 0; c < plan.cells.size(); ++c) {
    const std::optional<Trial> first = trial_of(plan.cells[c], plan, drive);
    const double seconds = first.value_or(Trial{}).seconds;
    const auto bytes = static_cast<double>(layouts[c].bytes());
    const double more = static_cast<double>(full_layouts[c].bytes()) - bytes;
    const double all = plan.columns.sums ? bytes_of_sums(plan.runs_here(), itinerary.scans())
                                         : bytes * runs + more * full_runs;
    costs.rows.push_back(
        {time_of_run(first, seconds * alike / runs), bytes_text(bytes), bytes_text(all)});
    costs.cpu_seconds += seconds * (engine::are_runs_equal(plan, plan.cells[c]) ? 1.0 : alike);
    costs.per_thread += first.value_or(Trial{}).bytes;
    largest_record = std::max(largest_record, bytes);
    // As many as can be held at once: beyond the number of threads it does not matter.
    costs.full_records.insert(costs.full_records.end(), std::min<std::size_t>(n_full_runs, 1024),
                              bytes + more);
  }
  costs.per_thread += largest_record;
  std::ranges::sort(costs.full_records, std::greater());
  return costs;
}

/// Text of the filters, in the order of the study: "EKF-SLAM, FastSLAM II (3 cells)".
std::string filters_of(const Study& study) {
  std::vector<std::string> names;
  for (const CellSpec& cell : study.cells) {
    const std::string& name = cell.filter->long_name;
    const auto is_of_it = [&](const CellSpec& other) { return other.filter == cell.filter; };
    if (&*std::ranges::find_if(study.cells, is_of_it) != &cell) continue;
    const auto n_cells = std::ranges::count_if(study.cells, is_of_it);
    names.push_back(n_cells == 1 ? name : formatted("{} ({} cells)", name, n_cells));
  }
  return joined(names);
}

/// Says that the disk takes longer than the filters, or nothing.
TextPairs disk_limit(const StudyPlan& plan, const Costs& costs, int threads,
                     std::optional<double> stated) {
  const double rate = stated.value_or(kWritingRate * threads);
  const double needed = costs.written / (costs.cpu_seconds / threads);
  if (needed <= rate) return {};
  return {{"disk",
           formatted("the limit: runs are made at {}/s and written at {}/s{}, which takes "
                     "about {}: store fewer columns{}",
                     bytes_text(needed), bytes_text(rate), stated ? " (--disk-rate)" : " at most",
                     duration_text(costs.written / rate),
                     plan.columns.scans_only ? "" : ", or choose record.rate = scan")}};
}

/// Prints the overview of a study: title, time, size of the file, filters, runs.
void print_summary(const Study& study, const StudyPlan& plan, const Costs& costs,
                   const Arguments& arguments) {
  const int threads = parallel_of(arguments).threads();
  auto disk_rate = arguments.number("disk-rate", 1e-6, 1e9);
  if (disk_rate) *disk_rate *= 1e6;
  const std::string part = plan.runs_here() == plan.runs ? "" : " of " + std::to_string(plan.runs);
  const std::string cells = std::to_string(plan.cells.size());
  TextPairs items{
      {"time",
       formatted("{}{} on {} threads (by a short trial)", study.until ? "at most " : "about ",
                 duration_text(costs.cpu_seconds / threads), threads)},
      {"file", (study.until ? "at most " : "") + bytes_text(costs.disk)},
      {"filters", filters_of(study)},
      {"runs", std::to_string(plan.runs_here()) + part +
                   (plan.cells.size() == 1 ? "" : formatted(" for each of {} cells", cells))},
      {"memory", memory_text(costs.memory(threads))}};
  for (auto& item : disk_limit(plan, costs, threads, disk_rate)) items.push_back(std::move(item));
  std::cout << wrapped(plan.title, output_width()) << "\n" << listing(items);
}

void print_details(const Study& study, const StudyPlan& plan) {
  const Itinerary& itinerary = plan.drives->itinerary();
  TextPairs details{{plan.drives->own_drives() > 0 ? "longest run" : "a run",
                     formatted("{} steps, {} scans, {} of driving, {} landmarks", itinerary.steps(),
                               itinerary.scans(), duration_text(itinerary.step_time.back()),
                               itinerary.landmarks.size())}};
  if (!study.logs.empty()) {
    const std::string kind = study.settings.text("association", "kind");
    details.emplace_back("association", kind + (kind == "known" ? ", by the identities of the log"
                                                                : ", by the filters themselves"));
  }
  if (study.until) details.emplace_back("until", in_words(*study.until, plan.runs));
  details.emplace_back("study", formatted("{}, seed {}", plan.name, plan.seed));
  details.emplace_back("SHA-256", sha256(plan.resolved_text));
  std::cout << "\ndetails\n" << listing(details);
}

/// Prints a row for each cell. If a label leaves no room for the numbers, they are printed below
/// it.
void print_cells(const StudyPlan& plan, const std::vector<TableRow>& rows) {
  const auto lines = aligned_lines(rows, {Align::right, Align::right, Align::right});
  TextPairs items{{"cell", lines.front()}};
  for (std::size_t i = 0; i < plan.cells.size(); ++i)
    items.emplace_back(plan.cells[i].label, lines[i + 1]);
  const std::size_t numbers = std::min(lines.back().size() + 4, output_width() / 2);
  std::cout << "\n" << listing(items, 2, output_width() - numbers);
}

}  // namespace

int check_command(const Arguments& arguments) {
  const Study study = study_of(arguments);
  const StudyPlan plan = plan_of(study, arguments);
  if (arguments.has("drives")) {
    for (const std::string& setting : settings_beside_text(study)) std::cout << setting << "\n";
    return kDone;
  }
  if (arguments.has("text")) {
    std::cout << plan.resolved_text;
    return kDone;
  }
  const Costs costs = costs_of(plan);
  print_summary(study, plan, costs, arguments);
  print_details(study, plan);
  print_cells(plan, costs.rows);
  return kDone;
}

}  // namespace montecarta::experiments
