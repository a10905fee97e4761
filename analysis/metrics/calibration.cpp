// SPDX-License-Identifier: BSD-3-Clause
// Probability integral transforms of errors (with matched noise) and of the NEES, over runs.
#include "analysis/metrics/calibration.hpp"

#include "analysis/metrics/cell_report.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/nees.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/numbers/angle.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>

namespace montecarta::analysis {
namespace {

double wrapped(std::size_t component, double difference) {
  return component == 2 ? wrap(difference) : difference;
}

/// Gaussian probability of less than `deviation` = truth - mean; NaN without a positive variance.
double gaussian_share(double deviation, double variance) {
  if (!(variance > 0.0) || !std::isfinite(variance) || !std::isfinite(deviation)) return kNaN;
  return 0.5 * std::erfc(-deviation / std::sqrt(2.0 * variance));
}

RunPits::Components gaussian_pits(const std::vector<double>& truth, const MomentRows& moments,
                                  std::size_t scan) {
  RunPits::Components pits;
  for (std::size_t c = 0; c < 3; ++c) {
    const double deviation = wrapped(c, truth[3 * scan + c] - moments.mean[3 * scan + c]);
    pits[c] = gaussian_share(deviation, moments.covariance[9 * scan + 4 * c]);
  }
  return pits;
}

/// The truth is one more draw (Hotelling's F of one component). NaN for three effective draws or
/// fewer.
RunPits::Components drawn_pits(const RunRows& rows, const EffectiveDraws& draws, std::size_t scan) {
  RunPits::Components pits{kNaN, kNaN, kNaN};
  const double E = draws.of_mean;
  if (!(E > 3.0)) return pits;
  for (std::size_t c = 0; c < 3; ++c) {
    const double error = wrapped(c, rows.truth[3 * scan + c] - rows.spread.mean[3 * scan + c]);
    const double variance = rows.spread.covariance[9 * scan + 4 * c] * (E + 1.0) / (E - 1.0);
    if (!(variance > 0.0) || !std::isfinite(variance) || !std::isfinite(error)) continue;
    pits[c] = t_cdf(error / std::sqrt(variance), draws.of_variance - 1.0);
  }
  return pits;
}

/// Rank of the truth among the particles, smoothed: E draws of equal weight leave E + 1 gaps of
/// equal probability, and `within` spreads the truth evenly over its gap from run to run. For
/// uneven weights E is the effective sample size.
RunPits::Components rank_pits(const RunRows& rows, std::size_t scan, double within) {
  const std::size_t M = rows.log_weight.size() / (rows.truth.size() / 3);
  RunPits::Components pits;
  for (std::size_t c = 0; c < 3; ++c) {
    double below = 0.0, all = 0.0, squares = 0.0;
    for (std::size_t i = scan * M; i < (scan + 1) * M; ++i) {
      const double weight = std::exp(rows.log_weight[i]);
      all += weight;
      squares += weight * weight;
      if (wrapped(c, rows.particle_pose[3 * i + c] - rows.truth[3 * scan + c]) < 0.0) {
        below += weight;
      }
    }
    const double E = all * all / squares;
    pits[c] = (below / all * E + within) / (E + 1.0);
  }
  return pits;
}

/// Transforms of one landmark of the map, a different one from run to run.
std::array<double, 2> landmark_pits(const FinalMap& map, std::uint64_t run,
                                    std::span<const Eigen::Vector2d> landmarks) {
  std::vector<std::size_t> seen;
  for (std::size_t l = 0; l < std::min(map.seen.size(), landmarks.size()); ++l) {
    if (map.seen[l] != 0) seen.push_back(l);
  }
  if (seen.empty()) return {kNaN, kNaN};
  const std::size_t l = seen[run % seen.size()];
  const Eigen::Vector2d error = landmarks[l] - map.mean[l];
  return {gaussian_share(error.x(), map.covariance[l](0, 0)),
          gaussian_share(error.y(), map.covariance[l](1, 1))};
}

/// In (0, 1), evenly spread over any stretch of runs: multiples of the golden ratio.
double evenly(std::uint64_t run) {
  const double golden = 0.6180339887498949 * (static_cast<double>(run) + 0.5);
  return golden - std::floor(golden);
}

constexpr std::array kComponents = {"x", "y", "heading"};
constexpr const char* kNees = "NEES";

/// Judges the transforms of a cell by bands that all hold together (Bonferroni). The bands belong
/// to numbers of values, which are nearly always the same.
class PitJudge {
 public:
  PitJudge(std::span<const RunPits> runs, std::size_t tests, double level)
      : runs_(runs), level_(1.0 - (1.0 - level) / static_cast<double>(tests)) {}

  void add(JudgedPits blank, PitOf kind, const std::function<double(const RunPits&)>& value_of) {
    std::vector<double> values;
    for (const RunPits& run : runs_) {
      const double value = value_of(run);
      if (std::isfinite(value)) values.push_back(value);
    }
    blank.undefined = runs_.size() - values.size();
    const auto [band, is_new] = bands_.try_emplace(values.size());
    if (is_new) band->second = ecdf_band(values.size(), level_);
    blank.test = judge_uniformity(values, band->second, kind);
    found.push_back(std::move(blank));
  }

  std::vector<JudgedPits> found;

 private:
  std::span<const RunPits> runs_;
  double level_;
  std::map<std::size_t, EcdfBand> bands_;
};

/// The largest number of tests of any cell, so that cells with as many runs have the same band.
std::size_t most_tests(const RunPits& run) {
  const bool has_components = run.has_pose || run.has_rank || run.has_landmark;
  const std::size_t of_components = 2 * kQuarters * kComponents.size() + run.landmark.size();
  return run.nees.size() + (has_components ? of_components : 0);
}

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

/// The tests of a cell that are chosen.
std::vector<const JudgedPits*> tests_of(const CellAnalysis& cell, const Chosen& chosen) {
  std::vector<const JudgedPits*> found;
  for (const JudgedPits& one : cell.get<Calibrations>()) {
    if (chosen(one)) found.push_back(&one);
  }
  return found;
}

/// Whether any cell has a test that is chosen.
bool has_test(const StudyAnalysis& study, const Chosen& chosen) {
  return std::ranges::any_of(
      study.cells, [&](const CellAnalysis& cell) { return !tests_of(cell, chosen).empty(); });
}

bool is_of_error(const JudgedPits& one) { return one.quantity != kNees; }
bool is_of_nees(const JudgedPits& one) { return one.quantity == kNees; }

/// Names of the quantities that any cell has.
std::vector<std::string> quantities_of(const StudyAnalysis& study) {
  std::vector<std::string> found;
  for (const char* name : {"x", "y", "heading", "landmark x", "landmark y", kNees}) {
    if (has_test(study, [&](const JudgedPits& one) { return one.quantity == name; })) {
      found.emplace_back(name);
    }
  }
  return found;
}

/// "2 of 14": tests of all moments that were made and found a fault.
std::string faults_text(const std::vector<const JudgedPits*>& tests) {
  std::size_t made = 0, faults = 0;
  for (const JudgedPits* one : tests) {
    if (one->test.verdict == Calibration::untested) continue;
    ++made;
    if (one->test.verdict != Calibration::calibrated) ++faults;
  }
  return std::to_string(faults) + " of " + std::to_string(made);
}

/// The verdicts at the end of the run; "-" if a quantity is not judged.
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

/// One row for each cell and way of judging: the verdicts at the end of the run, and the number of
/// faults at all moments. No rows if nothing is judged.
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

/// Adds how to read the table; nothing without a table.
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

/// One row for each test. The p-value is that of the test alone.
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

/// Counts as shares of all values, minus the points of the ECDF.
std::vector<double> deviations(std::size_t values,
                               const std::function<std::size_t(std::size_t)>& count_at) {
  std::vector<double> found;
  for (std::size_t j = 0; j <= kEcdfSteps; ++j) {
    found.push_back(static_cast<double>(count_at(j)) / static_cast<double>(values) - ecdf_point(j));
  }
  return found;
}

/// The curves of all cells with the band of the cell that has most values.
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

/// A panel for each quantity and time that is chosen. No data if nothing is judged.
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

/// ECDFs at the end of the run by the Gaussian and by the particles where they are stored, and of
/// the NEES at the end of each quarter.
std::vector<Figure> calibration_figures(const StudyAnalysis& study) {
  const auto is_last = [&](const JudgedPits& one, const char* by) {
    return is_of_error(one) && one.by == by && one.time == study.times.back();
  };
  return {pit_figure(study, is_of_nees, figure_of("nees_quantiles")),
          pit_figure(
              study, [&](const JudgedPits& one) { return is_last(one, "Gaussian"); },
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

RunPits pits_of(const RunRows& rows, std::size_t particles, std::uint64_t run,
                std::span<const Eigen::Vector2d> landmarks) {
  RunPits pits;
  if (rows.truth.empty()) return pits;
  const MomentRows& estimate = estimate_of(rows);
  const auto scans = calibration_scans(rows.truth.size() / 3);
  pits.has_pose = !estimate.covariance.empty();
  pits.has_rank = !rows.log_weight.empty();
  pits.has_landmark = rows.final_map && !landmarks.empty();
  for (std::size_t m = 0; m < kQuarters; ++m) {
    if (pits.has_pose) {
      const bool drawn = particles > 0 && is_drawn(rows, scans[m]);
      pits.pose[m] = drawn ? drawn_pits(rows, draws_at(rows, particles, scans[m]), scans[m])
                           : gaussian_pits(rows.truth, estimate, scans[m]);
    }
    if (pits.has_rank) pits.rank[m] = rank_pits(rows, scans[m], evenly(run));
  }
  if (pits.has_landmark) pits.landmark = landmark_pits(*rows.final_map, run, landmarks);
  return pits;
}

std::array<double, kQuarters> nees_pits(std::span<const double> nees, std::size_t dimension) {
  std::array<double, kQuarters> pits;
  const auto scans = calibration_scans(nees.size());
  for (std::size_t m = 0; m < kQuarters; ++m) {
    const double value = nees[scans[m]];
    pits[m] = std::isfinite(value) ? chi_squared_cdf(value, static_cast<double>(dimension)) : kNaN;
  }
  return pits;
}

std::vector<JudgedPits> CalibrationSums::result(std::span<const double> times, double level) const {
  if (runs_.empty()) return {};
  const RunPits& first = runs_.front();
  PitJudge judge(runs_, most_tests(first), level);
  const auto scans = calibration_scans(times.size());
  const auto add_pose = [&](const char* by, auto RunPits::*pits) {
    for (std::size_t m = 0; m < kQuarters; ++m) {
      for (std::size_t c = 0; c < kComponents.size(); ++c) {
        judge.add({kComponents[c], by, times[scans[m]], 0, {}}, PitOf::error,
                  [=](const RunPits& run) { return (run.*pits)[m][c]; });
      }
    }
  };
  if (first.has_pose) add_pose("Gaussian", &RunPits::pose);
  if (first.has_rank) add_pose("particles", &RunPits::rank);
  if (first.has_landmark) {
    for (std::size_t c = 0; c < first.landmark.size(); ++c) {
      judge.add({std::string("landmark ") + kComponents[c], "Gaussian", times.back(), 0, {}},
                PitOf::error, [=](const RunPits& run) { return run.landmark[c]; });
    }
  }
  for (std::size_t m = 0; m < (first.has_nees ? kQuarters : 0); ++m) {
    judge.add({kNees, "Gaussian", times[scans[m]], 0, {}}, PitOf::squared_error,
              [=](const RunPits& run) { return run.nees[m]; });
  }
  return std::move(judge.found);
}

Metric calibration_metric() {
  return {.sums = make_sums<CalibrationOverRuns>,
          .sections = calibration_sections,
          .figures = calibration_figures,
          .files = {{"calibration.csv", calibration_frame}}};
}

}  // namespace montecarta::analysis
