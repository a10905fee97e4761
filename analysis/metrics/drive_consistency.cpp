// SPDX-License-Identifier: BSD-3-Clause
// NEES along a recorded drive, by references with known errors.
#include "analysis/metrics/drive_consistency.hpp"

#include "analysis/metrics/innovations.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace montecarta::analysis {
namespace {

/// So few effective samples may as well be one that lasts for the whole drive.
constexpr double kFewestEffective = 3.0;

/// Means over runs; each run by itself has an interval that holds, and the runs are not
/// independent.
CorrelatedAverage mean_over_drives(std::span<const DriveScores> runs, std::size_t block) {
  const auto is_judged = [&](const DriveScores& run) {
    return run.blocks[block].effective_samples > 0.0;
  };
  const auto n = static_cast<double>(std::ranges::count_if(runs, is_judged));
  CorrelatedAverage mean;
  if (n == 0.0) return mean;
  double inverse = 0.0;
  for (const DriveScores& run : runs) {
    if (!is_judged(run)) continue;
    const CorrelatedAverage& one = run.blocks[block];
    mean.mean += one.mean / n;
    mean.ratio.lower += one.ratio.lower / n;
    mean.ratio.upper += one.ratio.upper / n;
    inverse += 1.0 / one.effective_samples / n;
  }
  mean.effective_samples = 1.0 / inverse;
  return mean;
}

DriveScores mean_scores(std::span<const DriveScores> runs) {
  DriveScores all = runs.front();
  all.median = 0.0;
  for (std::size_t block = 0; block < all.blocks.size(); ++block) {
    all.blocks[block] = mean_over_drives(runs, block);
  }
  for (const DriveScores& run : runs) {
    all.median += run.median / static_cast<double>(runs.size());
    all.in_gaps = std::max(all.in_gaps, run.in_gaps);
    all.undefined = std::max(all.undefined, run.undefined);
    all.fixes = std::min(all.fixes, run.fixes);
    all.is_the_reference = all.is_the_reference || run.is_the_reference;
    all.is_below_reference = all.is_below_reference || run.is_below_reference;
  }
  return all;
}

Answer answer_of_drive(const Interval& ratio, double within) {
  if (ratio.lower >= 1.0 / within && ratio.upper <= within) return Answer::consistent;
  if (ratio.lower > 1.0) return Answer::optimistic;
  return ratio.upper < 1.0 ? Answer::conservative : Answer::undecided;
}

/// The average over the runs that have the block.
CorrelatedAverage over_own_drives(std::span<const DriveScores> runs, std::size_t block,
                                  double level) {
  std::vector<VectorSeries> drives;
  for (const DriveScores& run : runs) {
    if (run.blocks[block].effective_samples > 0.0) drives.push_back(run.errors[block]);
  }
  return drives.empty() ? CorrelatedAverage{} : correlated_average(drives, level);
}

DriveScores sums_over_drives(std::span<const DriveScores> runs, double level) {
  DriveScores all;
  all.leading = runs.front().leading;
  all.median = 0.0;
  double judged = 0.0;
  for (std::size_t block = 0; block < all.blocks.size(); ++block) {
    all.blocks[block] = over_own_drives(runs, block, level);
  }
  for (const DriveScores& run : runs) {
    all.in_gaps += run.in_gaps;
    all.undefined += run.undefined;
    if (!(run.leads().effective_samples > 0.0)) continue;
    judged += 1.0;
    all.median += run.median;
    all.fixes += run.fixes;
    all.seconds += run.seconds;
    all.is_the_reference = all.is_the_reference || run.is_the_reference;
    all.is_below_reference = all.is_below_reference || run.is_below_reference;
  }
  all.median /= judged;
  return all;
}

/// Fills verdict and minutes from the mean.
void decide(double level, DriveConsistency& result) {
  const CorrelatedAverage& leads = result.mean.leads();
  if (!(leads.effective_samples > 0.0) || result.mean.is_the_reference) return;
  result.answer = answer_of_drive(leads.ratio, result.within);
  result.minutes = result.mean.seconds / 60.0 *
                   samples_that_decide(dimension_of(result.mean.leading), level, result.within) /
                   leads.effective_samples;
}

std::string drives_text(const DriveConsistency& found) {
  const std::string these = found.drives == 1
                                ? "one judged drive cannot tell"
                                : std::to_string(found.drives) + " drives cannot tell";
  const double needed =
      static_cast<double>(found.drives) * found.minutes * 60.0 / found.mean.seconds;
  if (!std::isfinite(needed)) return these + ", nor could more";
  return these + ": it would take " + compact(std::ceil(needed)) + " like them";
}

std::string minutes_text(const DriveConsistency& drive) {
  if (drive.drives > 0) return drives_text(drive);
  if (std::isinf(drive.minutes)) return "this drive cannot tell, nor could a longer one";
  const bool is_least = drive.mean.leads().effective_samples < kFewestEffective;
  return std::string("this drive cannot tell: it would need ") + (is_least ? "at least " : "") +
         compact(std::max(drive.minutes, 1.0)) + " minutes";
}

/// "1.2 to 1.4", "more than 1.2"
std::string factor_words(double lower, double upper) {
  if (std::isinf(upper)) return "more than " + compact(lower);
  return compact(lower) + " to " + compact(upper);
}

}  // namespace

DriveConsistency judge_drive(std::span<const DriveScores> runs, double level, double within) {
  DriveConsistency result;
  result.within = within;
  if (runs.empty()) return result;
  result.mean = mean_scores(runs);
  decide(level, result);
  return result;
}

DriveConsistency judge_own_drives(std::span<const DriveScores> runs, double level, double within) {
  DriveConsistency result;
  result.within = within;
  result.drives = static_cast<std::size_t>(std::ranges::count_if(
      runs, [](const DriveScores& run) { return run.leads().effective_samples > 0.0; }));
  if (runs.empty()) return result;
  result.mean = sums_over_drives(runs, level);
  decide(level, result);
  return result;
}

std::string in_words(const DriveConsistency& drive) {
  const Interval& ratio = drive.mean.leads().ratio;
  switch (drive.answer) {
    case Answer::consistent:
      return "consistent within " + exact_text(drive.within);
    case Answer::optimistic:
      return "optimistic: NEES " + factor_words(ratio.lower, ratio.upper) + " times too large";
    case Answer::conservative:
      return "conservative: NEES " + factor_words(1.0 / ratio.upper, 1.0 / ratio.lower) +
             " times too small";
    case Answer::undecided:
      return minutes_text(drive);
    case Answer::inconsistent:
    case Answer::untested:
      break;
  }
  return drive.mean.is_the_reference ? "refused: the reference is this estimate" : "not tested";
}

namespace {

/// {reference with known errors}
using DriveConsistencies = std::vector<DriveConsistency>;

class DrivesOverRuns final : public MergedSums<DrivesOverRuns> {
 public:
  explicit DrivesOverRuns(const RunCriteria& criteria)
      : level_(criteria.level),
        within_(criteria.within),
        are_own_(!criteria.drives.empty()),
        runs_(criteria.judged_fixes.size()) {}
  void add(const MeasuredRun& run) override {
    for (std::size_t r = 0; r < runs_.size(); ++r) runs_[r].push_back(run.drives[r]);
  }
  void put(CellAnalysis& cell) override {
    DriveConsistencies all;
    for (const auto& runs : runs_) {
      all.push_back(are_own_ ? judge_own_drives(runs, level_, within_)
                             : judge_drive(runs, level_, within_));
    }
    if (!all.empty()) cell.findings.put(all);
  }
  static constexpr auto parts() { return std::tuple(appended(&DrivesOverRuns::runs_)); }

 private:
  double level_, within_;
  bool are_own_;
  std::vector<std::vector<DriveScores>> runs_;  ///< {reference}{run}
};

/// Calls visit(cell, reference, its DriveConsistency).
template <class Visit>
void for_each_drive(const StudyAnalysis& study, const Visit& visit) {
  for (const CellAnalysis& cell : study.cells) {
    std::size_t k = 0;
    for (const JudgedReference& reference : study.references) {
      if (!reference.has_errors) continue;
      const DriveConsistencies& all = cell.get<DriveConsistencies>();
      if (k < all.size()) visit(cell, reference, all[k]);
      ++k;
    }
  }
}

std::string block_text(const DriveConsistency& drive, ErrorBlock block) {
  const CorrelatedAverage& found = drive.mean.blocks[static_cast<std::size_t>(block)];
  if (!(found.effective_samples > 0.0)) return "-";
  // The ends lie at very different distances: each is to be read by itself.
  return readable(found.mean) + " [" + compact(found.ratio.lower) + ", " +
         compact(found.ratio.upper) + "]";
}

std::vector<TextTable::Entry> drive_row(const CellAnalysis& cell, const JudgedReference& reference,
                                        const DriveConsistency& drive, const std::string& level) {
  const Innovations* innovations = cell.find<Innovations>();
  const bool is_judged = drive.answer != Answer::untested;
  const auto judged = [&](const std::string& text) { return is_judged ? text : "-"; };
  return {{"cell", cell.label, Align::left},
          {"reference", reference.name, Align::left},
          {"runs", runs_in_words(cell), Align::left},
          {"verdict", in_words(drive), Align::left},
          {"NEES / expected" + level, judged(block_text(drive, drive.mean.leading))},
          {"median / expected", judged(readable(drive.mean.median))},
          {"position" + level, judged(block_text(drive, ErrorBlock::position))},
          {"heading" + level, judged(block_text(drive, ErrorBlock::heading))},
          {"fixes", std::to_string(drive.mean.fixes)},
          {"effective", judged(readable(drive.mean.leads().effective_samples))},
          {"NIS per component",
           innovations == nullptr ? "-" : readable(innovations->verdict.ratio_estimate())},
          {"innovations", innovations == nullptr ? "-" : whiteness_in_words(*innovations),
           Align::left}};
}

TextTable drive_table(const StudyAnalysis& study) {
  const std::string level = " [" + level_text(study.level) + "]";
  TextTable table{.keys = 2};
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    table.add(drive_row(cell, reference, drive, level));
  });
  return table;
}

std::vector<std::string> warnings_of(const CellAnalysis& cell, const JudgedReference& reference,
                                     const DriveConsistency& drive) {
  std::vector<std::string> warnings;
  const auto add = [&](bool applies, const char* key, const Values& values = {}) {
    if (applies) warnings.push_back(prose("drive", key, values));
  };
  const auto count = [](std::size_t n) { return std::to_string(n); };
  add(drive.mean.is_below_reference, "below reference");
  add(reference.has_start, "starts at fix");
  add(cell.filter == "external", "external");
  add(drive.mean.in_gaps > 0, "in gaps",
      {{"fixes", count(drive.mean.in_gaps)}, {"gap", readable(kLongestScanGap, 1)}});
  add(drive.mean.undefined > 0, "undefined", {{"fixes", count(drive.mean.undefined)}});
  return warnings;
}

TextTable warning_table(const StudyAnalysis& study) {
  TextTable table;
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    for (const std::string& warning : warnings_of(cell, reference, drive)) {
      table.add({{"cell", cell.label, Align::left},
                 {"reference", reference.name, Align::left},
                 {"to be considered", warning, Align::left}});
    }
  });
  return table;
}

std::vector<Section> drive_sections(const StudyAnalysis& study) {
  const TextTable table = drive_table(study);
  if (table.rows.empty()) return {};
  Section section = section_of("drive");
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    section.blocks.emplace_back(
        Section::Lead{cell.label + " by " + reference.name + ": " + in_words(drive) + "."});
  });
  section.add("drive", table);
  section.add("drive_warnings", warning_table(study));
  section.add_notes(
      "notes",
      {{"independence", prose("drive", study.own_drives == 0 ? "same drive" : "own drives")}});
  return {section};
}

void add_block(const std::string& name, const CorrelatedAverage& found,
               std::vector<NamedNumber>& all) {
  const bool known = found.effective_samples > 0.0;
  all.push_back({name + "_nees_ratio", "1", known ? found.mean : kNaN});
  all.push_back({name + "_nees_ratio_lower", "1", known ? found.ratio.lower : kNaN});
  all.push_back({name + "_nees_ratio_upper", "1", known ? found.ratio.upper : kNaN});
  all.push_back({name + "_effective_fixes", "1", known ? found.effective_samples : kNaN});
}

std::vector<NamedNumber> drive_numbers(const DriveConsistency& drive) {
  const DriveScores& mean = drive.mean;
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  std::vector<NamedNumber> all = {{"within", "1", drive.within},
                                  {"fixes", "1", count(mean.fixes)},
                                  {"fixes_in_gaps", "1", count(mean.in_gaps)},
                                  {"fixes_undefined", "1", count(mean.undefined)},
                                  {"median_nees_ratio", "1", mean.median},
                                  {"needed", "min", drive.minutes},
                                  {"drives", "1", count(drive.drives)}};
  add_block("pose", mean.blocks[0], all);
  add_block("position", mean.blocks[1], all);
  add_block("heading", mean.blocks[2], all);
  return all;
}

bool has_known_errors(const StudyAnalysis& study) {
  return std::ranges::any_of(study.references, &JudgedReference::has_errors);
}

void write_drive(const StudyAnalysis& study, const std::filesystem::path& path) {
  NamedRows file(path);
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    file.row({{"cell", cell.label},
              {"filter", cell.filter},
              {"reference", reference.name},
              {"verdict", in_words(drive)}},
             drive_numbers(drive));
  });
  file.close();
}

}  // namespace

Metric drive_metric() {
  return {.sums = make_sums<DrivesOverRuns>,
          .sections = drive_sections,
          .files = {{"drive.csv", has_known_errors, write_drive}}};
}

}  // namespace montecarta::analysis
