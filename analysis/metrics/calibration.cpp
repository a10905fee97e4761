// SPDX-License-Identifier: BSD-3-Clause
// Where the truth lies in what filters hold for possible; only where the noise is matched.
#include "analysis/metrics/calibration.hpp"

#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/nees.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/numbers/angle.hpp"

#include <boost/math/distributions/students_t.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

namespace montecarta::analysis {
namespace {

double wrapped(std::size_t component, double difference) {
  return component == 2 ? wrap(difference) : difference;
}

/// Gaussian probability of less than `deviation` = truth - mean; NaN where the variance is none.
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

/// The truth is one more draw (Hotelling's F of one component). NaN of three effective draws or
/// fewer.
RunPits::Components drawn_pits(const RunRows& rows, const EffectiveDraws& draws, std::size_t scan) {
  RunPits::Components pits{kNaN, kNaN, kNaN};
  const double E = draws.of_mean;
  if (!(E > 3.0)) return pits;
  const boost::math::students_t student(draws.of_variance - 1.0);
  for (std::size_t c = 0; c < 3; ++c) {
    const double error = wrapped(c, rows.truth[3 * scan + c] - rows.spread.mean[3 * scan + c]);
    const double variance = rows.spread.covariance[9 * scan + 4 * c] * (E + 1.0) / (E - 1.0);
    if (!(variance > 0.0) || !std::isfinite(variance) || !std::isfinite(error)) continue;
    pits[c] = boost::math::cdf(student, error / std::sqrt(variance));
  }
  return pits;
}

/// Rank of the truth among the particles, smoothed: of E draws of equal weight there are E + 1
/// gaps, each as probable, and where in its gap the truth lies is spread evenly over runs by
/// `within`. Of uneven weights E is the effective sample size.
RunPits::Components rank_pits(const std::vector<double>& truth, const CloudRows& cloud,
                              std::size_t scan, std::size_t moment, double within) {
  const std::size_t M = cloud.log_weight.size() / kQuarters;
  RunPits::Components pits;
  for (std::size_t c = 0; c < 3; ++c) {
    double below = 0.0, all = 0.0, squares = 0.0;
    for (std::size_t i = moment * M; i < (moment + 1) * M; ++i) {
      const double weight = std::exp(cloud.log_weight[i]);
      all += weight;
      squares += weight * weight;
      if (wrapped(c, cloud.pose[3 * i + c] - truth[3 * scan + c]) < 0.0) below += weight;
    }
    const double E = all * all / squares;
    pits[c] = (below / all * E + within) / (E + 1.0);
  }
  return pits;
}

/// One landmark of the map, another one from run to run.
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

}  // namespace

RunPits pits_of(const RunRows& rows, std::size_t particles, std::uint64_t run,
                std::span<const Eigen::Vector2d> landmarks) {
  RunPits pits;
  if (rows.truth.empty()) return pits;
  const MomentRows& estimate = estimate_of(rows);
  const auto scans = calibration_scans(rows.truth.size() / 3);
  pits.has_pose = !estimate.covariance.empty();
  pits.has_rank = !rows.cloud.log_weight.empty();
  pits.has_landmark = rows.final_map && !landmarks.empty();
  for (std::size_t m = 0; m < kQuarters; ++m) {
    if (pits.has_pose) {
      const bool drawn = particles > 0 && is_drawn(rows, scans[m]);
      pits.pose[m] = drawn ? drawn_pits(rows, draws_at(rows, particles, scans[m]), scans[m])
                           : gaussian_pits(rows.truth, estimate, scans[m]);
    }
    if (pits.has_rank) pits.rank[m] = rank_pits(rows.truth, rows.cloud, scans[m], m, evenly(run));
  }
  if (pits.has_landmark) pits.landmark = landmark_pits(*rows.final_map, run, landmarks);
  return pits;
}

namespace {

constexpr std::array kComponents = {"x", "y", "heading"};

/// Histograms with the bands of their numbers of values, which are nearly always the same; all of
/// the cell keep them together (Bonferroni).
class Histograms {
 public:
  Histograms(std::span<const RunPits> runs, std::size_t tests, double level)
      : runs_(runs), level_(1.0 - (1.0 - level) / static_cast<double>(tests)) {}

  void add(PitHistogram blank, const std::function<double(const RunPits&)>& value_of) {
    std::vector<double> values;
    for (const RunPits& run : runs_) {
      const double value = value_of(run);
      if (std::isfinite(value)) values.push_back(value);
    }
    blank.undefined = runs_.size() - values.size();
    const auto [band, fresh] = bands_.try_emplace(values.size());
    if (fresh) band->second = band_for(values.size(), level_);
    blank.test = judge_uniformity(values, band->second);
    found.push_back(std::move(blank));
  }

  std::vector<PitHistogram> found;

 private:
  std::span<const RunPits> runs_;
  double level_;
  std::map<std::size_t, CountBand> bands_;
};

/// How many histograms a cell has whose runs are like `run`.
std::size_t tests_of(const RunPits& run) {
  const std::size_t of_pose = 3 * kQuarters;
  return (run.has_pose ? of_pose : 0) + (run.has_rank ? of_pose : 0) + (run.has_landmark ? 2 : 0);
}

}  // namespace

std::vector<PitHistogram> CalibrationSums::result(std::span<const double> times,
                                                  double level) const {
  if (runs_.empty()) return {};
  Histograms histograms(runs_, tests_of(runs_.front()), level);
  const auto scans = calibration_scans(times.size());
  const auto add_pose = [&](const char* by, auto RunPits::*pits) {
    for (std::size_t m = 0; m < kQuarters; ++m) {
      for (std::size_t c = 0; c < 3; ++c) {
        histograms.add({kComponents[c], by, times[scans[m]], 0, {}},
                       [=](const RunPits& run) { return (run.*pits)[m][c]; });
      }
    }
  };
  if (runs_.front().has_pose) add_pose("Gaussian", &RunPits::pose);
  if (runs_.front().has_rank) add_pose("particles", &RunPits::rank);
  if (runs_.front().has_landmark) {
    for (std::size_t c = 0; c < 2; ++c) {
      histograms.add({std::string("landmark ") + kComponents[c], "Gaussian", times.back(), 0, {}},
                     [=](const RunPits& run) { return run.landmark[c]; });
    }
  }
  return std::move(histograms.found);
}

namespace {

class CalibrationOverRuns final : public MetricSums {
 public:
  explicit CalibrationOverRuns(const RunCriteria& criteria) : criteria_(&criteria) {}
  void add(const MeasuredRun& run) override {
    if (criteria_->calibrates) calibration_.add(run.pits);
  }
  void put(CellAnalysis& cell) override {
    cell.findings.put(calibration_.result(criteria_->times, criteria_->level));
  }

 private:
  const RunCriteria* criteria_;
  CalibrationSums calibration_;
};

constexpr std::array kQuantities = {"x", "y", "heading", "landmark x", "landmark y"};

/// What is said of a quantity at the end of the run; "-" where it is not judged.
std::string last_verdict(const CellAnalysis& cell, const std::string& by,
                         const std::string& quantity) {
  std::string words = "-";
  for (const PitHistogram& one : cell.get<Calibrations>()) {
    if (one.by == by && one.quantity == quantity) words = in_words(one.test.verdict);
  }
  return words;
}

/// "2 of 14": tests of all moments that were made and found a fault.
std::string faults_text(const CellAnalysis& cell, const std::string& by) {
  std::size_t tests = 0, faults = 0;
  for (const PitHistogram& one : cell.get<Calibrations>()) {
    if (one.by != by || one.test.verdict == Calibration::untested) continue;
    ++tests;
    if (one.test.verdict != Calibration::calibrated) ++faults;
  }
  return std::to_string(faults) + " of " + std::to_string(tests);
}

std::vector<std::string> row_of(const CellAnalysis& cell, const std::string& by) {
  std::vector<std::string> row = {cell.label, by};
  for (const char* quantity : kQuantities) row.push_back(last_verdict(cell, by, quantity));
  row.push_back(faults_text(cell, by));
  return row;
}

std::size_t most_bins(const StudyAnalysis& study) {
  std::size_t most = 0;
  for (const CellAnalysis& cell : study.cells) {
    for (const PitHistogram& one : cell.get<Calibrations>())
      most = std::max(most, one.test.counts.size());
  }
  return most;
}

std::vector<std::string> fields_of(const CellAnalysis& cell, const PitHistogram& one) {
  const auto count = [](std::size_t n) { return std::to_string(n); };
  std::vector<std::string> fields = {cell.label,
                                     one.quantity,
                                     one.by,
                                     exact_text(one.time),
                                     in_words(one.test.verdict),
                                     count(one.undefined),
                                     exact_text(one.test.mean),
                                     exact_text(one.test.variance),
                                     count(one.test.band.lower),
                                     count(one.test.band.upper),
                                     exact_text(one.test.band.joint)};
  for (const std::size_t n : one.test.counts) fields.push_back(count(n));
  return fields;
}

/// Whether any cell has histograms to judge.
bool has_calibration(const StudyAnalysis& study) {
  return std::ranges::any_of(
      study.cells, [](const CellAnalysis& cell) { return !cell.get<Calibrations>().empty(); });
}

/// One row a cell and way of judging: the verdicts at the end of the run, and in how many of all
/// tests of all moments there is another verdict than calibrated. Without rows where nothing is
/// judged.
TextTable calibration_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left}, {"by", Align::left}};
  for (const char* quantity : kQuantities) table.headings.push_back({quantity, Align::left});
  table.headings.push_back({"faults at all moments"});
  for (const CellAnalysis& cell : study.cells) {
    for (const char* by : {"Gaussian", "particles"}) {
      const bool judged = std::ranges::any_of(
          cell.get<Calibrations>(), [&](const PitHistogram& one) { return one.by == by; });
      if (judged) table.rows.push_back(row_of(cell, by));
    }
  }
  return table;
}

/// How to read it, a sentence each; none where there is no table.
std::vector<std::string> calibration_notes(const StudyAnalysis& study) {
  if (!has_calibration(study)) return {};
  std::vector<std::string> notes = {
      "Calibration asks, at the end of each quarter of the run, which share of what the filter "
      "holds "
      "for possible lies below the truth (its Gaussian, or its weighted particles): over runs that "
      "share should be anything from 0 to 1 equally often. 'too narrow': the truth lies at the "
      "ends "
      "too often; 'too wide': in the middle too often; 'shifted': on one side.",
      "A histogram is calibrated where all of its bins are inside a band that chance keeps all "
      "histograms of a cell in at once, in " +
          level_text(study.level) +
          " of studies at least. Every run gives "
          "one landmark, another one from run to run, and less than " +
          std::to_string(kLeastValues) + " runs say nothing."};
  for (const CellAnalysis& cell : study.cells) {
    std::size_t undefined = 0;
    for (const PitHistogram& one : cell.get<Calibrations>()) undefined += one.undefined;
    if (undefined == 0) continue;
    notes.push_back(cell.label + ": " + std::to_string(undefined) +
                    " values had no positive variance or no landmark (left out).");
  }
  return notes;
}

/// One row a histogram: its counts with their band, mean, variance and verdict.
void write_calibration(const StudyAnalysis& study, const std::filesystem::path& path) {
  CsvFile file(path);
  std::vector<std::string> headings = {"cell",       "quantity",   "by",        "time [s]",
                                       "verdict",    "undefined",  "mean",      "variance",
                                       "band_lower", "band_upper", "band_joint"};
  const std::size_t bins = most_bins(study);
  for (std::size_t b = 0; b < bins; ++b) headings.push_back("bin_" + std::to_string(b + 1));
  file.row(headings);
  for (const CellAnalysis& cell : study.cells) {
    for (const PitHistogram& one : cell.get<Calibrations>()) {
      std::vector<std::string> fields = fields_of(cell, one);
      fields.resize(headings.size());
      file.row(fields);
    }
  }
  file.close();
}

constexpr std::size_t kMostRows = 8;

/// A histogram that is drawn.
struct DrawnHistogram {
  std::size_t cell = 0;
  std::string label;
  const PitHistogram* histogram = nullptr;
};

/// Those of one cell at the end of the run.
std::vector<DrawnHistogram> last_of(const StudyAnalysis& study, std::size_t c,
                                    const std::string& by) {
  std::vector<DrawnHistogram> drawn;
  const CellAnalysis& cell = study.cells[c];
  for (const PitHistogram& one : cell.get<Calibrations>()) {
    if (one.by == by && one.time == study.times.back()) drawn.push_back({c, cell.label, &one});
  }
  return drawn;
}

/// Share of runs in every bin, as a multiple of what is expected.
FigureData data_of(const std::string& name, const DrawnHistogram& drawn) {
  FigureData data{name, {"from", "to", "count / expected", "lower", "upper"}, {}};
  const Uniformity& test = drawn.histogram->test;
  double all = 0.0;
  for (const std::size_t n : test.counts) all += static_cast<double>(n);
  const auto bins = static_cast<double>(test.counts.size());
  const double expected = std::max(all, 1.0) / bins;  // without values all bins are empty
  for (std::size_t b = 0; b < test.counts.size(); ++b) {
    data.rows.push_back({static_cast<double>(b) / bins, static_cast<double>(b + 1) / bins,
                         static_cast<double>(test.counts[b]) / expected,
                         static_cast<double>(test.band.lower) / expected,
                         static_cast<double>(test.band.upper) / expected});
  }
  return data;
}

/// From the rows of data_of(). The band is that of all bins.
ChartPanel chart_panel(const DrawnHistogram& drawn, const FigureData& data) {
  ChartPanel panel{drawn.label + ", " + drawn.histogram->quantity,
                   {false, 0.0, 0.0},
                   {},
                   {},
                   {{"band of a calibrated filter", data.rows.front()[3], data.rows.front()[4]}},
                   drawn.label};
  ChartMarks& bars = panel.marks.emplace_back();
  bars.cell = drawn.label;
  bars.name = drawn.histogram->quantity;
  bars.style = drawn.cell;
  bars.shape = ChartMarks::Shape::boxes;
  bars.facts = {{"from", {}}, {"to", {}}, {"count / expected", {}}};
  double highest = std::max(1.0, panel.bands.front().upper);
  for (const auto& row : data.rows) {
    bars.x.push_back(0.5 * (row[0] + row[1]));
    bars.y.push_back(0.5 * row[2]);
    bars.width.push_back(row[1] - row[0]);
    bars.height.push_back(row[2]);
    for (std::size_t f = 0; f < bars.facts.size(); ++f) bars.facts[f].values.push_back(row[f]);
    highest = std::max(highest, row[2]);
  }
  panel.axis.high = 1.1 * highest;
  return panel;
}

Chart empty_chart(std::size_t columns) {
  Chart chart{"from the lower (0) to the upper end (1)", 0.0, 1.0, {}};
  chart.columns = columns;
  chart.least = 150;
  chart.aspect = 0.5;
  return chart;
}

Figure figure_of(const StudyAnalysis& study, const std::string& by, Figure figure) {
  std::vector<std::vector<DrawnHistogram>> rows;
  for (std::size_t c = 0; c < study.cells.size() && rows.size() < kMostRows; ++c) {
    if (auto row = last_of(study, c, by); !row.empty()) rows.push_back(std::move(row));
  }
  if (rows.empty()) return figure;
  std::size_t columns = 0;
  for (const auto& row : rows) columns = std::max(columns, row.size());
  figure.chart = empty_chart(columns);
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string name =
          figure.name + "_" + row[c].label + "_" + std::to_string(c + 1) + ".csv";
      figure.data.push_back(data_of(name, row[c]));
      figure.chart.panels.push_back(chart_panel(row[c], figure.data.back()));
    }
  }
  return figure;
}

/// Histograms of where the truth lies in what filters hold for possible, at the end of the run: by
/// their Gaussian, and by their particles where they are stored; a row for each of the first eight
/// cells. Without data where nothing is judged.
std::vector<Figure> calibration_figures(const StudyAnalysis& study) {
  const std::string reading =
      " Bars are shares of runs, 1 is what they should be; bars that all stay in the grey band "
      "belong to a calibrated filter. A valley: the filter is overconfident; a hill: "
      "conservative; a slope: it is off to one side.";
  Figure gaussian{"calibration", "Does the truth lie where the filter says?", ""};
  gaussian.sentence =
      "Where the truth lies in the Gaussian of the filter at the end of the run, from its lower "
      "(0) "
      "to its upper end (1)." +
      reading;
  Figure particles{"ranks", "Does the truth lie among the particles?", ""};
  particles.sentence =
      "Which share of the weighted particles lies below the truth at the end of the run." + reading;
  return {figure_of(study, "Gaussian", gaussian), figure_of(study, "particles", particles)};
}

std::vector<Section> calibration_sections(const StudyAnalysis& study) {
  if (!has_calibration(study)) return {};
  Section section{"calibration", "Calibration"};
  section.is_for_terminal = false;
  section.add("calibration", calibration_table(study));
  section.add(calibration_notes(study));
  return {section};
}

}  // namespace

Metric calibration_metric() {
  return {.sums = make_sums<CalibrationOverRuns>,
          .sections = calibration_sections,
          .figures = calibration_figures,
          .files = {{"calibration.csv", has_calibration, write_calibration}}};
}

}  // namespace montecarta::analysis
