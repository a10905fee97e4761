// SPDX-License-Identifier: BSD-3-Clause
// Why a cell is inconsistent: bias or scatter, in which direction, how far.
#include "analysis/metrics/cell_panels.hpp"
#include "analysis/metrics/credibility.hpp"
#include "analysis/metrics/error_anatomy.hpp"
#include "analysis/metrics/lineages.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/metrics/metric.hpp"
#include "analysis/metrics/study_analysis.hpp"
#include "analysis/output/number_text.hpp"
#include "analysis/statistics/means.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta::analysis {
namespace {

class ErrorAnatomyOverRuns final : public MetricSums {
 public:
  explicit ErrorAnatomyOverRuns(const RunCriteria& criteria)
      : credibility_(criteria.times.size()), moments_(criteria.times.size()) {}
  void add(const MeasuredRun& run) override {
    const RunMetrics& metrics = run.metrics;
    if (metrics.covariances().empty()) return;
    is_empty_ = false;
    credibility_.add(metrics.errors(), metrics.leading_nees()->value[0]);
    moments_.add(metrics.errors(), metrics.covariances());
  }
  void put(CellAnalysis& cell) override {
    if (is_empty_) return;
    cell.findings.put(credibility_.result());
    cell.findings.put(moments_.result());
  }

 private:
  bool is_empty_ = true;
  CredibilitySamples credibility_;
  ErrorMoments moments_;
};

void error_anatomy_numbers(const CellAnalysis& cell, std::vector<NamedNumber>& all) {
  const bool known = cell.find<ErrorAnatomy>() != nullptr;
  const ErrorAnatomy& anatomy = cell.get<ErrorAnatomy>();
  const Credibility& credibility = cell.get<Credibility>();
  all.push_back({"worst_variance_ratio", "1", known ? anatomy.mean_worst_ratio : kNaN});
  for (std::size_t c = 0; c < kErrorComponents.size(); ++c) {
    all.push_back({std::string("worst_direction_") + kErrorComponents[c], "1",
                   known ? anatomy.worst_direction[c] : kNaN});
  }
  all.push_back({"bias_share", "1", known ? anatomy.mean_bias_share : kNaN});
  all.push_back({"noncredibility", "dB", credibility.noncredibility});
  all.push_back({"inclination", "dB", credibility.inclination});
}

void error_anatomy_series(const CellAnalysis& cell, std::vector<NamedSeries>& all) {
  const ErrorAnatomy* anatomy = cell.find<ErrorAnatomy>();
  if (anatomy == nullptr) return;
  for (std::size_t c = 0; c < kErrorComponents.size(); ++c) {
    const std::string name = kErrorComponents[c];
    const std::string units = name == "heading" ? "rad" : "m";
    all.push_back({"rms_error_" + name, units, anatomy->happened[c]});
    all.push_back({"believed_deviation_" + name, units, anatomy->believed[c]});
    all.push_back({"mean_error_" + name, units, anatomy->bias[c]});
  }
  all.push_back({"bias_share", "1", anatomy->bias_share});
  all.push_back({"worst_variance_ratio", "1", anatomy->worst_ratio});
}

std::string decibel(double value) { return std::isnan(value) ? "-" : readable(value) + " dB"; }

/// "heading 97 %".
std::string direction_text(const ErrorAnatomy& anatomy) {
  const auto& shares = anatomy.worst_direction;
  const auto most = std::ranges::max_element(shares);
  if (std::isnan(*most)) return "-";
  return std::string(kErrorComponents[static_cast<std::size_t>(most - shares.begin())]) + " " +
         readable(100.0 * *most, 2) + " %";
}

std::vector<std::string> why_row(const CellAnalysis& cell, double level) {
  const ErrorAnatomy& anatomy = *cell.find<ErrorAnatomy>();
  const Credibility& credibility = cell.get<Credibility>();
  const double share = cell.get<LineageSummary>().monte_carlo_share;
  return {cell.label,
          readable(anatomy.mean_worst_ratio),
          readable(expected_worst_ratio(cell.complete, level)),
          direction_text(anatomy),
          percent(anatomy.mean_bias_share),
          decibel(credibility.noncredibility),
          decibel(credibility.inclination),
          std::isfinite(share) ? percent(share) : "-"};
}

TextTable why_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"worst variance ratio"},
                    {"expected below"},
                    {"worst direction"},
                    {"bias"},
                    {"noncredibility"},
                    {"inclination"},
                    {"Monte Carlo share"}};
  for (const CellAnalysis& cell : study.cells) {
    if (cell.find<ErrorAnatomy>()) table.rows.push_back(why_row(cell, study.level));
  }
  return table;
}

std::vector<std::string> why_notes(const StudyAnalysis& study) {
  return {
      "The worst variance ratio is how many times larger the squared errors are than the filter's "
      "variance, in the direction where that is worst (seen from the true vehicle: forward, left, "
      "heading), geometric mean over scans; of a consistent filter it is below 'expected below' "
      "at " +
          level_text(study.level) +
          " of scans. The direction says which component that is, in units of its deviation.",
      "'bias' is the part of ANEES that the mean error makes: what is left is scatter that the "
      "filter does not know of. Bias calls for a better model, scatter for a noise model that "
      "matches.",
      "Noncredibility is how far, up or down, covariances are from the errors that happened (3 dB: "
      "a "
      "factor of 2 in variance); the inclination has a sign: above 0 overconfident, below 0 "
      "conservative.",
      "'Monte Carlo share' is the part of the squared position error that comes from the particles "
      "being few, by how far their families differ; it needs record.columns with ancestry and "
      "particles."};
}

/// Where the worst ratio of a consistent filter lies, by the cell with the fewest runs.
Band expected_ratios(const StudyAnalysis& study) {
  std::size_t fewest = study.runs_here;
  for (const CellAnalysis& cell : study.cells) {
    if (cell.find<ErrorAnatomy>()) fewest = std::min(fewest, cell.complete);
  }
  return {"consistent filter", 1.0, expected_worst_ratio(fewest, study.level)};
}

Figure why_figure(const StudyAnalysis& study) {
  Figure figure{"why", "What is wrong, scatter or bias?", ""};
  figure.sentence =
      "Above: how many times larger squared errors are than the variance the filter believes, in "
      "the direction where that is worst. Below: how much of ANEES comes from errors that all runs "
      "share (bias); the rest is scatter that the filter does not know of.";
  const CellValues ratio = [](const CellAnalysis& cell) {
    return cell.get<ErrorAnatomy>().worst_ratio;
  };
  const CellValues bias = [](const CellAnalysis& cell) {
    return scaled(cell.get<ErrorAnatomy>().bias_share, 100.0);
  };
  std::vector<Panel> panels = cell_panels(
      study, {"worst_variance_ratio", "worst variance ratio", {}, {}, Scale::automatic}, ratio);
  for (Panel& panel : panels) panel.bands.push_back(expected_ratios(study));
  for (Panel& panel :
       cell_panels(study, {"bias_share", "bias in ANEES [%]", {}, {}, Scale::percent}, bias)) {
    panels.push_back(std::move(panel));
  }
  add_panels(panels, study.times, figure);
  return figure;
}

std::vector<Section> error_anatomy_sections(const StudyAnalysis& study) {
  const TextTable table = why_table(study);
  if (table.rows.empty()) return {};
  Section section{"error_anatomy", "Why?"};
  section.add("why", table);
  section.add(why_notes(study));
  return {section};
}

std::vector<Figure> error_anatomy_figures(const StudyAnalysis& study) {
  return {why_figure(study)};
}

}  // namespace

Metric error_anatomy_metric() {
  return {.sums = make_sums<ErrorAnatomyOverRuns>,
          .add_numbers = error_anatomy_numbers,
          .add_series = error_anatomy_series,
          .sections = error_anatomy_sections,
          .figures = error_anatomy_figures};
}

}  // namespace montecarta::analysis
