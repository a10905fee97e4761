// SPDX-License-Identifier: BSD-3-Clause
// Where the truth lies in what filters hold for possible; only where the noise is matched.
#include "analysis/metrics/cell_calibration.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <array>

namespace montecarta::analysis {
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
