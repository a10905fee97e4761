// SPDX-License-Identifier: BSD-3-Clause
// Tests of the probability integral transforms of the NEES and, with matched noise, of the errors,
// over runs.
#include "analysis/verdict/calibration.hpp"

#include "analysis/run/measured_run.hpp"
#include "analysis/statistics/uniformity.hpp"
#include "analysis/study/cell_report.hpp"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

namespace montecarta::analysis {
namespace {

class CalibrationOverRuns final : public MergedSums<CalibrationOverRuns> {
 public:
  explicit CalibrationOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override { calibration_.add(run.pits); }
  void put(CellAnalysis& cell) override {
    cell.findings.put(calibration_.result(criteria_->times, criteria_->level));
  }
  static constexpr auto parts() { return std::tuple(added(&CalibrationOverRuns::calibration_)); }

 private:
  const RunCriteria* criteria_;
  CalibrationSums calibration_;
};

using Chosen = std::function<bool(const JudgedPits&)>;

/// Returns the tests of a cell that `chosen` selects.
std::vector<const JudgedPits*> tests_of(const CellAnalysis& cell, const Chosen& chosen) {
  std::vector<const JudgedPits*> found;
  for (const JudgedPits& one : cell.get<Calibrations>()) {
    if (chosen(one)) found.push_back(&one);
  }
  return found;
}

/// Returns whether `chosen` selects a test of any cell.
bool has_test(const StudyAnalysis& study, const Chosen& chosen) {
  return std::ranges::any_of(
      study.cells, [&](const CellAnalysis& cell) { return !tests_of(cell, chosen).empty(); });
}

bool is_of_error(const JudgedPits& one) { return one.quantity != kNees; }

bool is_of_nees(const JudgedPits& one) { return one.quantity == kNees; }

/// Returns the names of the quantities that at least one cell has.
std::vector<std::string> quantities_of(const StudyAnalysis& study) {
  std::vector<std::string> found;
  for (const char* name : {"x", "y", "heading", "landmark x", "landmark y", kNees}) {
    if (has_test(study, [&](const JudgedPits& one) { return one.quantity == name; })) {
      found.emplace_back(name);
    }
  }
  return found;
}

/// Text of the number of tests that found a fault, of those made: "2 of 14".
std::string faults_text(const std::vector<const JudgedPits*>& tests) {
  std::size_t made = 0, faults = 0;
  for (const JudgedPits* one : tests) {
    if (one->test.verdict == Calibration::untested) continue;
    ++made;
    if (one->test.verdict != Calibration::calibrated) ++faults;
  }
  return std::to_string(faults) + " of " + std::to_string(made);
}

/// Makes a row with the verdict on each quantity at the end of the run; "-" if a quantity is not
/// judged.
std::vector<TextTable::Entry> row_of(const CellAnalysis& cell, const std::string& by,
                                     const std::vector<std::string>& quantities) {
  std::vector<TextTable::Entry> row = {{"cell", cell.label, Align::left}, {"by", by, Align::left}};
  const auto tests = tests_of(cell, [&](const JudgedPits& one) { return one.by == by; });
  for (const std::string& quantity : quantities) {
    row.push_back({quantity, "-", Align::left});
    for (const JudgedPits* one : tests) {
      if (one->quantity == quantity) row.back().text = in_words(one->test.verdict);
    }
  }
  row.push_back({"faults at all moments", faults_text(tests)});
  return row;
}

/// A table with one row for each cell and law of the transform: the verdicts at the end of the run,
/// and the number of faults at all times. It has no rows if nothing is judged.
TextTable calibration_table(const StudyAnalysis& study) {
  TextTable table;
  const std::vector<std::string> quantities = quantities_of(study);
  for (const CellAnalysis& cell : study.cells) {
    for (const char* by : {"Gaussian", "particles"}) {
      const bool is_judged =
          !tests_of(cell, [&](const JudgedPits& one) { return one.by == by; }).empty();
      if (is_judged) table.add(row_of(cell, by, quantities));
    }
  }
  return table;
}

/// Adds notes on how to read the table, if there is one.
void add_calibration_notes(const StudyAnalysis& study, Section& section) {
  const bool has_errors = has_test(study, is_of_error), has_nees = has_test(study, is_of_nees);
  if (has_errors) section.add_notes("errors");
  if (has_nees) section.add_notes("squared errors");
  if (!has_errors && !has_nees) return;
  section.add_notes("tests",
                    {{"level", level_text(study.level)}, {"fewest", std::to_string(kLeastValues)}});
  for (const CellAnalysis& cell : study.cells) {
    std::size_t undefined = 0;
    for (const JudgedPits& one : cell.get<Calibrations>()) undefined += one.undefined;
    if (undefined == 0) continue;
    section.add_notes("undefined", {{"cell", cell.label}, {"values", std::to_string(undefined)}});
  }
}

/// Makes a file with one row for each test. Its p-value is not corrected for the number of tests.
Frame calibration_frame(const StudyAnalysis& study) {
  Frame frame;
  for (const CellAnalysis& cell : study.cells) {
    for (const JudgedPits& one : cell.get<Calibrations>()) {
      const Uniformity& test = one.test;
      frame.add({{"cell", cell.label},
                 {"quantity", one.quantity},
                 {"by", one.by},
                 {"time", "s", one.time},
                 {"verdict", in_words(test.verdict)},
                 {"values", "1", static_cast<double>(test.band.values)},
                 {"undefined", "1", static_cast<double>(one.undefined)},
                 {"mean", "1", test.mean},
                 {"variance", "1", test.variance},
                 {"largest_deviation", "1", test.deviation},
                 {"p_value", "1", p_value(test)},
                 {"band_joint", "1", test.band.joint}});
    }
  }
  return frame;
}

/// Returns {point} the share of the values at or below each point of the ECDF, minus the point.
std::vector<double> deviations(std::size_t values,
                               const std::function<std::size_t(std::size_t)>& count_at) {
  std::vector<double> found;
  for (std::size_t j = 0; j <= kEcdfSteps; ++j) {
    found.push_back(static_cast<double>(count_at(j)) / static_cast<double>(values) - ecdf_point(j));
  }
  return found;
}

/// Makes panels with the curves of all cells, and with the band of the cell that has most values.
std::vector<Panel> panels_like(const StudyAnalysis& study, const JudgedPits& like,
                               const std::string& name) {
  Panel blank{name, "ECDF - PIT, " + like.quantity + " at " + fixed_seconds(like.time), {}, {}};
  blank.scale = Scale::around_zero;
  EcdfBand band;
  const auto is_drawn_here = [&](const JudgedPits& one) {
    return one.is_like(like) && one.test.verdict != Calibration::untested;
  };
  const auto values_of = [&](const CellAnalysis& cell) -> std::vector<double> {
    const auto tests = tests_of(cell, is_drawn_here);
    if (tests.empty()) return {};
    const Uniformity& test = tests.front()->test;
    if (test.band.values > band.values) band = test.band;
    return deviations(test.band.values, [&](std::size_t j) { return test.counts[j]; });
  };
  std::vector<Panel> panels = cell_panels(study, blank, values_of);
  for (Panel& panel : panels) {
    const auto add = [&](const char* legend, const auto& count_at) {
      panel.curves.push_back({legend, kReferenceStyle, deviations(band.values, count_at)});
    };
    add("band, upper end", [&](std::size_t j) { return band.upper(j); });
    add("band, lower end", [&](std::size_t j) { return band.lower[j]; });
  }
  return panels;
}

/// A figure with a panel for each chosen quantity and time. It has no data if nothing is judged.
Figure pit_figure(const StudyAnalysis& study, const Chosen& chosen, Figure figure) {
  std::vector<const JudgedPits*> drawn;
  for (const CellAnalysis& cell : study.cells) {
    for (const JudgedPits* one : tests_of(cell, chosen)) {
      const bool is_new = std::ranges::none_of(
          drawn, [&](const JudgedPits* other) { return other->is_like(*one); });
      if (is_new && one->test.verdict != Calibration::untested) drawn.push_back(one);
    }
  }
  std::vector<Panel> panels;
  for (const JudgedPits* one : drawn) {
    const std::string name = figure.name + "_" + std::to_string(panels.size() + 1);
    std::ranges::move(panels_like(study, *one, name), std::back_inserter(panels));
  }
  std::vector<double> points;
  for (std::size_t j = 0; j <= kEcdfSteps; ++j) points.push_back(ecdf_point(j));
  figure.chart.x_label = "probability integral transform (PIT)";
  figure.chart.columns = drawn.size() == kQuarters ? 2 : 3;
  figure.chart.least = 260;
  figure.chart.aspect = 0.6;
  add_panels(panels, points, figure);
  return figure;
}

/// Figures of the ECDFs at the end of the run, by the Gaussian and, if they are stored, by the
/// particles, and of the NEES at the end of each quarter.
std::vector<Figure> calibration_figures(const StudyAnalysis& study) {
  const auto is_gaussian = [](const JudgedPits& one) {
    return one.by == std::string_view("Gaussian");
  };
  const auto is_last = [&](const JudgedPits& one, const char* by) {
    return one.by == by && one.time == study.times.back();
  };
  return {pit_figure(
              study, [&](const JudgedPits& one) { return is_of_nees(one) && is_gaussian(one); },
              figure_of("nees_quantiles")),
          pit_figure(
              study,
              [&](const JudgedPits& one) { return is_of_error(one) && is_last(one, "Gaussian"); },
              figure_of("calibration")),
          pit_figure(
              study, [&](const JudgedPits& one) { return is_last(one, "particles"); },
              figure_of("ranks"))};
}

std::vector<Section> calibration_sections(const StudyAnalysis& study) {
  std::vector<const JudgedPits*> all;
  for (const CellAnalysis& cell : study.cells) {
    std::ranges::move(tests_of(cell, [](const JudgedPits&) { return true; }),
                      std::back_inserter(all));
  }
  if (all.empty()) return {};
  Section section = section_of("calibration", {{"faults", faults_text(all)}});
  section.is_for_terminal = false;
  section.add("calibration", calibration_table(study));
  add_calibration_notes(study, section);
  return {section};
}

}  // namespace

Metric calibration_metric() {
  return {.sums = make_sums<CalibrationOverRuns>,
          .sections = calibration_sections,
          .figures = calibration_figures,
          .files = {{"calibration.csv", calibration_frame}}};
}

}  // namespace montecarta::analysis
