// SPDX-License-Identifier: BSD-3-Clause
// Distances of estimated paths from independent measurements of the path.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/verdict_table.hpp"
#include "engine/text/list_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Text of a mean, rounded to a centimetre or a hundredth of a degree because no fix is known
/// better.
std::string mean_text(const Spread& spread, double factor = 1.0) {
  return with_error_to(2, factor * spread.summary.mean, factor * spread.summary.standard_error());
}

std::string count_text(const Spread& spread) {
  return with_error_to(1, spread.summary.mean, spread.summary.standard_error());
}

/// Text of the median over runs, with the least and the greatest run: "1.55 [1.41, 2.20]".
std::string runs_text(const Spread& spread) {
  if (std::isnan(spread.median)) return "-";
  const auto text = [](double value) { return with_error_to(2, value, kNaN); };
  return text(spread.median) + " [" + text(spread.least) + ", " + text(spread.greatest) + "]";
}

std::string of_text(std::size_t k, std::size_t n) {
  return std::to_string(k) + " of " + std::to_string(n);
}

/// Number of runs that can be judged, including failed ones.
std::size_t judged_runs(const CellAnalysis& cell, const ReferenceAnalysis& against) {
  return against.with_fixes() + cell.failures.size();
}

std::string lost_text(const CellAnalysis& cell, const ReferenceAnalysis& against) {
  return of_text(against.lost() + cell.failures.size(), judged_runs(cell, against));
}

bool any_heading(const StudyAnalysis& study) {
  return std::ranges::any_of(study.references, &JudgedReference::has_heading);
}

std::vector<TextTable::Entry> reference_row(const StudyAnalysis& study, const CellAnalysis& cell,
                                            std::size_t r) {
  const ReferenceAnalysis& against = cell.get<ReferenceAnalyses>()[r];
  const auto text = [&](double ReferenceScores::*score, double factor = 1.0) {
    return mean_text(against.over_runs(score), factor);
  };
  const double kept = against.over_runs(&ReferenceScores::aligned_gated_share).summary.mean;
  std::vector<TextTable::Entry> row = {
      {"cell", cell.label, Align::left},
      {"reference", study.references[r].name, Align::left},
      {"runs", runs_in_words(cell), Align::left, tone_of_runs(cell)},
      {"lost", study.references[r].fixes == 0 ? "-" : lost_text(cell, against)},
      {"raw RMS [m]", text(&ReferenceScores::rms)},
      {"raw median [m]", text(&ReferenceScores::median)},
      {"aligned RMS [m]", text(&ReferenceScores::aligned_rms)},
      {"middle run [ends]", runs_text(against.over_runs(&ReferenceScores::aligned_rms))},
      {"aligned median [m]", text(&ReferenceScores::aligned_median)},
      {"gated [m] (kept)", text(&ReferenceScores::aligned_gated_rms) + " (" + percent(kept) + ")"}};
  if (any_heading(study)) {
    row.push_back({"heading RMSE [deg]", text(&ReferenceScores::heading_rmse, 180.0 / kPi)});
  }
  return row;
}

std::vector<TextTable::Entry> map_row(const StudyAnalysis& study, const CellAnalysis& cell) {
  const auto text = [&](std::string_view score) { return mean_text(cell.known_over_runs(score)); };
  const auto mean = [&](const char* score) { return readable(cell.over_runs(score).mean); };
  const Spread found = cell.known_over_runs("beacons_found");
  const std::string beacons = " of " + std::to_string(study.beacons);
  std::vector<TextTable::Entry> row = {
      {"landmarks", count_text(cell.known_over_runs("map_landmarks"))}};
  if (study.beacons > 0) {
    row.push_back({"beacons found", found.summary.n == 0 ? "-" : count_text(found) + beacons});
    row.push_back({"beacon error [m]", text("beacon_rms")});
    row.push_back({"beacon error, aligned [m]", text("beacon_aligned_rms")});
  }
  row.push_back({"ESS", mean("ess")});
  row.push_back({"ancestors", mean("ancestors_at_start_at_the_end")});
  row.push_back({"CPU [s]", mean("cpu_seconds")});
  return row;
}

/// Returns the score by which cells are compared.
double ReferenceScores::*compared_score(const JudgedReference& reference) {
  return reference.compares_raw() ? &ReferenceScores::rms : &ReferenceScores::aligned_rms;
}

std::string against_baseline(const RunsAgainst& found, std::size_t runs) {
  const std::size_t better = found.better, equal = found.equal;
  if (runs == 0) return "not tested";
  if (equal == runs) return "equal in every run";
  if (equal > 0) {
    return "better in " + std::to_string(better) + ", equal in " + std::to_string(equal) +
           ", worse in " + std::to_string(runs - better - equal);
  }
  if (better == runs) return "better in every run";
  if (better == 0) return "better in no run";
  return 2 * better == runs  ? "better in half of the runs"
         : 2 * better > runs ? "better in most runs"
                             : "worse in most runs";
}

/// Text of the runs that beat the baseline: "2 of 5", "2 of 5, 1 tie".
std::string beats_text(const RunsAgainst& found, std::size_t runs) {
  if (found.equal == 0) return of_text(found.better, runs);
  return of_text(found.better, runs) + ", " + std::to_string(found.equal) +
         (found.equal == 1 ? " tie" : " ties");
}

std::vector<TextTable::Entry> baseline_row(const StudyAnalysis& study, const CellAnalysis& cell,
                                           const CellAnalysis* baseline) {
  const ReferenceAnalysis& leading = cell.get<ReferenceAnalyses>().front();
  std::vector<TextTable::Entry> row = {{"loses the map", lost_text(cell, leading)}};
  if (baseline == nullptr) return row;
  const DrivesOfRuns drives = study.own_drives > 0 ? DrivesOfRuns::own : DrivesOfRuns::same;
  const RunsAgainst found =
      runs_against(cell, *baseline, compared_score(study.references.front()), drives);
  const std::size_t runs = judged_runs(cell, leading);
  const bool is_baseline = &cell == baseline;
  row.push_back({"beats " + baseline->label, is_baseline ? "-" : beats_text(found, runs)});
  const bool is_compared = !is_baseline && runs > 0;
  const Tone tone = is_compared && found.better == runs              ? Tone::good
                    : is_compared && found.better + found.equal == 0 ? Tone::bad
                                                                     : Tone::plain;
  row.push_back({"against EKF-SLAM",
                 is_baseline ? "is the baseline" : against_baseline(found, runs), Align::left,
                 tone});
  return row;
}

/// Text of the drives with fixes: "the drive", "2 of 3 drives".
std::string drives_in_words(const StudyAnalysis& study, const JudgedReference& reference) {
  if (study.own_drives == 0) return "the drive";
  return std::to_string(reference.drives) + " of " + std::to_string(study.own_drives) + " drives";
}

std::string fixes_text(const StudyAnalysis& study) {
  std::string text;
  for (const JudgedReference& reference : study.references) {
    append_part(text,
                reference.name + " has " + std::to_string(reference.fixes) + " fixes within " +
                    drives_in_words(study, reference),
                "; ");
    if (reference.in_gaps > 0) text += ", " + std::to_string(reference.in_gaps) + " in gaps";
    if (reference.outside > 0)
      text += ", " + std::to_string(reference.outside) + " before or after the stored poses";
  }
  return text;
}

std::string baseline_note(const StudyAnalysis& study) {
  const JudgedReference& reference = study.references.front();
  if (reference.fixes == 0) {
    return prose("references", "no fix",
                 {{"reference", reference.name},
                  {"drive", study.own_drives == 0 ? "the drive" : "any drive"}});
  }
  const CellAnalysis* baseline = baseline_of(study);
  if (baseline == nullptr) return prose("references", "no baseline");
  if (study.own_drives > 0) {
    return prose("references", "baseline of drives",
                 {{"compared", reference.compared()},
                  {"reference", reference.name},
                  {"baseline", baseline->label}});
  }
  const Spread compared =
      baseline->get<ReferenceAnalyses>().front().over_runs(compared_score(reference));
  return prose("references", reference.compares_raw() ? "raw baseline" : "aligned baseline",
               {{"reference", reference.name},
                {"baseline", baseline->label},
                {"rms", readable(compared.summary.mean)}});
}

Frame references_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    for (std::size_t r = 0; r < cell.get<ReferenceAnalyses>().size(); ++r) {
      frame.add(
          {{"cell", cell.label}, {"filter", cell.filter}, {"reference", study.references[r].name}},
          reference_numbers(cell, r));
    }
  }
  return frame;
}

/// Makes a file with one row for each fix of the leading reference, and one column for each cell:
/// RMS distance over runs.
Frame reference_errors_frame(const StudyAnalysis& study) {
  if (study.references.empty() || study.own_drives > 0) return {};
  Frame frame{{{"time", "s", study.references.front().times}}};
  for (const CellAnalysis& cell : study.cells) {
    if (cell.complete == 0) continue;
    frame.columns.push_back(
        {cell.label, "m", cell.get<ReferenceAnalyses>().front().error_over_time});
  }
  return frame;
}

/// [m] The least distance that a reference resolves: satellite positions are good to a centimetre.
constexpr double kLeastError = 0.01;

constexpr double kTwoDecades = 100.0;

/// Returns the scale of the axis that all panels share. A logarithmic axis begins at kLeastError.
Scale scale_of(const std::vector<Panel>& panels) {
  double least = std::numeric_limits<double>::infinity(), greatest = 0.0;
  for (const Panel& panel : panels) {
    for (const Curve& curve : panel.curves) {
      for (const double value : curve.values) {
        if (std::isnan(value)) continue;
        least = std::min(least, std::max(value, kLeastError));
        greatest = std::max(greatest, value);
      }
    }
  }
  return greatest > kTwoDecades * least ? Scale::logarithmic : Scale::from_zero;
}

/// Adds panels to a figure. If there are several, adds a sentence about them.
void add(const std::vector<Panel>& panels, const std::vector<double>& times, Figure& figure) {
  if (panels.size() > 1) figure.sentence += " " + prose("references", "panels");
  add_panels(panels, times, figure);
}

/// Returns the score of a run by the leading reference, which is the one that comparisons use.
template <double ReferenceScores::*kValue>
double of_reference(const MeasuredRun& run) {
  return run.references.empty() ? kNaN : run.references.front().scores.*kValue;
}

constexpr Score kReferencesScores[] = {
    {"reference_rms", "m", "RMS distance to the reference", of_reference<&ReferenceScores::rms>},
    {"reference_median", "m", "median distance to the reference",
     of_reference<&ReferenceScores::median>},
    {"reference_gated_rms", "m", "RMS distance to the reference without outliers",
     of_reference<&ReferenceScores::gated_rms>},
    {"reference_aligned_rms", "m", "RMS distance to the reference, aligned",
     of_reference<&ReferenceScores::aligned_rms>},
    {"reference_aligned_median", "m", "median distance to the reference, aligned",
     of_reference<&ReferenceScores::aligned_median>},
    {"reference_aligned_gated_rms", "m", "RMS distance to the reference without outliers, aligned",
     of_reference<&ReferenceScores::aligned_gated_rms>},
    {"reference_heading_rmse", "rad", "heading RMSE to the reference",
     of_reference<&ReferenceScores::heading_rmse>},
};

class ReferencesOverRuns final : public MergedSums<ReferencesOverRuns> {
 public:
  explicit ReferencesOverRuns(const RunCriteria& criteria)
      : references_(
            criteria.references.size(),
            ReferenceAccumulator(criteria.drives.empty() ? ReferenceAccumulator::Fixes::same
                                                         : ReferenceAccumulator::Fixes::own)) {}
  void add(const MeasuredRun& run) override {
    for (std::size_t r = 0; r < references_.size(); ++r) references_[r].add(run.references[r]);
  }
  void put(CellAnalysis& cell) override {
    ReferenceAnalyses all;
    for (const ReferenceAccumulator& sums : references_) all.push_back(sums.result());
    cell.findings.put(all);
  }
  static constexpr auto parts() { return std::tuple(added(&ReferencesOverRuns::references_)); }

 private:
  std::vector<ReferenceAccumulator> references_;
};

TextTable reference_table(const StudyAnalysis& study) {
  TextTable table{.keys = 2};
  for (const CellAnalysis& cell : study.cells) {
    for (std::size_t r = 0; r < cell.get<ReferenceAnalyses>().size(); ++r) {
      table.add(reference_row(study, cell, r));
    }
  }
  return table;
}

TextTable map_table(const StudyAnalysis& study) {
  return cell_table(study, [&](const CellAnalysis& cell) { return map_row(study, cell); });
}

TextTable baseline_table(const StudyAnalysis& study) {
  if (study.references.empty() || study.references.front().fixes == 0) return {};
  const CellAnalysis* baseline = baseline_of(study);
  return cell_table(study,
                    [&](const CellAnalysis& cell) { return baseline_row(study, cell, baseline); });
}

std::vector<std::string> reference_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  const auto add = [&](const char* key, const Values& values = {}) {
    std::ranges::move(paragraphs("references", key, values), std::back_inserter(notes));
  };
  if (!study.references.empty()) {
    add("fixes", {{"gap", readable(kLongestGap, 1)}, {"fixes", fixes_text(study)}});
    const char* runs = study.own_drives > 0 ? "own drives" : "same drive";
    add("distances", {{"gate", readable(kReferenceGate, 1)},
                      {"runs", prose("references", runs)},
                      {"lost", readable(kLostBeyond, 2)}});
    notes.push_back(baseline_note(study));
  }
  if (study.beacons > 0) add("beacons", {{"distance", readable(kFoundWithin, 1)}});
  if (study.own_drives > 0) add("no series");
  add("map");
  return notes;
}

Figure reference_error_figure(const StudyAnalysis& study) {
  if (study.references.empty() || study.own_drives > 0) return {};
  const JudgedReference& reference = study.references.front();
  Figure figure = figure_of("reference_error", {{"reference", reference.name}});
  const Panel blank{"reference_error", "distance to " + reference.name + " [m]", {}, {}, {},
                    kLeastError};
  std::vector<Panel> panels = cell_panels(study, blank, [](const CellAnalysis& cell) {
    return cell.complete == 0 ? std::vector<double>{}
                              : cell.get<ReferenceAnalyses>().front().error_over_time;
  });
  if (panels.empty()) return figure;
  const Scale scale = scale_of(panels);
  for (Panel& panel : panels) panel.scale = scale;
  add(panels, reference.times, figure);
  return figure;
}

Figure map_size_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("map_size");
  const std::vector<Panel> panels =
      cell_panels(study, {"map_size", "landmarks", {}, {}, Scale::from_zero},
                  [](const CellAnalysis& cell) { return cell.over_time("map_landmarks"); });
  if (!panels.empty()) add(panels, study.times, figure);
  return figure;
}

std::vector<Section> references_sections(const StudyAnalysis& study) {
  const bool is_other_program = study.imported.is_imported();  // which has no map here
  if (study.references.empty() && (study.has_truth || is_other_program)) return {};
  Section section = section_of("references");
  if (!study.has_truth) section.add_html("<p>" + no_truth_sentence(study) + "</p>\n");
  section.add("reference", reference_table(study));
  section.add("baseline", baseline_table(study));
  section.add("map", map_table(study));
  section.add(reference_notes(study));
  return {section};
}

}  // namespace

Metric references_metric() {
  return {.scores = kReferencesScores,
          .scores_are_numbers = false,
          .sums = make_sums<ReferencesOverRuns>,
          .sections = references_sections,
          .figures =
              [](const StudyAnalysis& study) {
                return std::vector{reference_error_figure(study), map_size_figure(study)};
              },
          .files = {{"references.csv", references_frame},
                    {"reference_errors.csv", reference_errors_frame}}};
}

}  // namespace montecarta::analysis
