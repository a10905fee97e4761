// SPDX-License-Identifier: BSD-3-Clause
// NEES along a recorded drive, computed from references with known errors.
#include "analysis/run/measured_run.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/study/section.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/text_table.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/drive_verdict.hpp"
#include "analysis/verdict/innovations.hpp"
#include "analysis/verdict/verdict.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

class DrivesOverRuns final : public MergedSums<DrivesOverRuns> {
 public:
  explicit DrivesOverRuns(const RunCriteria& criteria)
      : level_(criteria.level),
        within_(criteria.within),
        are_own_(!criteria.drives.empty()),
        runs_(static_cast<std::size_t>(
            std::ranges::count_if(criteria.references, &PathAtFixes::has_errors))) {}
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
  std::vector<std::vector<DriveScores>> runs_;  ///< {reference}{run} scores
};

/// Calls visit(cell, reference, DriveConsistency) for every cell and reference.
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
  // The ends lie at very different distances from the mean, so each is rounded by itself.
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
          {"runs", runs_in_words(cell), Align::left, tone_of_runs(cell)},
          {"verdict", in_words(drive), Align::left, tone_of(drive.answer)},
          {"NEES / expected" + level, judged(block_text(drive, drive.mean.leading))},
          {"median / expected", judged(readable(drive.mean.median))},
          {"position" + level, judged(block_text(drive, ErrorBlock::position))},
          {"heading" + level, judged(block_text(drive, ErrorBlock::heading))},
          {"fixes", std::to_string(drive.mean.fixes)},
          {"effective", judged(readable(drive.mean.leads().effective_samples))},
          {"NIS per component", innovations == nullptr ? "-" : readable(innovations->ratio)},
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
  const auto add = [&](bool applies, const char* key) {
    if (applies) warnings.push_back(prose("drive", key));
  };
  add(drive.mean.is_below_reference, "below reference");
  add(reference.has_start, "starts at fix");
  add(cell.filter == "external", "external");
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
  Section section = section_of("drive");
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    section.blocks.emplace_back(
        Section::Lead{cell.label + " by " + reference.name + ": " + in_words(drive) + "."});
  });
  section.add("drive", drive_table(study));
  if (section.blocks.empty()) return {};
  section.add("drive_warnings", warning_table(study));
  section.add_notes(
      "notes",
      {{"independence", prose("drive", study.own_drives == 0 ? "same drive" : "own drives")}});
  return {section};
}

Frame::Row drive_numbers(const DriveConsistency& drive) {
  const DriveScores& mean = drive.mean;
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  Frame::Row all = {{"within", "1", drive.within},
                    {"fixes", "1", count(mean.fixes)},
                    {"fixes_in_gaps", "1", count(mean.in_gaps)},
                    {"fixes_undefined", "1", count(mean.undefined)},
                    {"median_nees_ratio", "1", mean.median},
                    {"gross_outliers", "1", count(mean.outliers)},
                    {"nees_ratio_without_outliers", "1", mean.ratio_without_outliers},
                    {"needed", "min", drive.minutes},
                    {"drives", "1", count(drive.drives)}};
  static const std::vector<ResultNumber<CorrelatedAverage>> kBlockNumbers = {
      {"nees_ratio", "1", &CorrelatedAverage::mean, {}, {}, &CorrelatedAverage::ratio},
      {"effective_fixes", "1", &CorrelatedAverage::effective_samples}};
  for (const ErrorBlock block : kErrorBlocks) {
    const CorrelatedAverage& found = mean.blocks[static_cast<std::size_t>(block)];
    Frame::Row row;
    add_numbers(kBlockNumbers, found.effective_samples > 0.0 ? &found : nullptr, row);
    for (Frame::Entry& entry : row) entry.name = name_of(block) + "_" + entry.name;
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

Frame drive_frame(const StudyAnalysis& study) {
  Frame frame;
  for_each_drive(study, [&](const auto& cell, const auto& reference, const auto& drive) {
    frame.add({{"cell", cell.label},
               {"filter", cell.filter},
               {"reference", reference.name},
               {"verdict", in_words(drive)}},
              drive_numbers(drive));
  });
  return frame;
}

}  // namespace

Metric drive_metric() {
  return {.sums = make_sums<DrivesOverRuns>,
          .sections = drive_sections,
          .files = {{"drive.csv", drive_frame}}};
}

}  // namespace montecarta::analysis
