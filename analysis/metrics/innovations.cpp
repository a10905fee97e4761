// SPDX-License-Identifier: BSD-3-Clause
// Size and whiteness of the innovations, which are judged without knowing the truth.
#include "analysis/verdict/innovations.hpp"

#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/study/reference_sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Returns the widest bound of the tested lags; NaN if none is tested.
double widest_bound(const Innovations& found) {
  double widest = kNaN;
  for (const double bound : found.white_bound) widest = std::fmax(widest, bound);
  return widest;
}

class InnovationsOverRuns final : public MergedSums<InnovationsOverRuns> {
 public:
  explicit InnovationsOverRuns(const RunCriteria& criteria)
      : criteria_(&criteria),
        has_common_scans_(criteria.drives.empty()),
        innovations_(criteria.times.size(), criteria.innovation_components,
                     criteria.has_same_measurements ? InnovationSums::Measurements::same
                                                    : InnovationSums::Measurements::own) {}
  void add(const MeasuredRun& run) override {
    if (run.rows.nis.empty()) return;
    std::span<const double> components;
    if (criteria_->innovation_components > 0) components = run.metrics.whitened().standardised;
    innovations_.add(run.rows.run, run.times, run.rows.nis, run.rows.nis_dof, components);
  }
  void put(CellAnalysis& cell) override {
    if (innovations_.empty()) return;
    Innovations found = innovations_.result(criteria_->times, criteria_->level_of_each(),
                                            criteria_->within, cell.find<GateScale>());
    if (!has_common_scans_) {
      found.average.clear();
      found.bounds.clear();
    }
    const auto* on_white = cell.find<VerdictOnWhite>();
    if (on_white != nullptr && found.whiteness() == Whiteness::white) {
      cell.verdict = on_white->verdict;
    }
    cell.findings.put(std::move(found));
  }
  static constexpr auto parts() { return std::tuple(added(&InnovationsOverRuns::innovations_)); }

 private:
  const RunCriteria* criteria_;
  bool has_common_scans_;  ///< false if every run has its own drive: then no mean over time exists
  InnovationSums innovations_;
};

template <auto LargestInnovation::*kMember>
double of_largest(const Innovations& found) {
  return static_cast<double>(found.largest.*kMember);
}

const std::vector<ResultNumber<Innovations>> kInnovationQuantities = {
    {"nis_per_component",
     "1",
     &Innovations::ratio,
     "NIS per component",
     {},
     [](const Innovations& found) { return found.verdict.ratio(); }},
    {"nis_share_inside", "1", &Innovations::share_inside, "scans in band", percent},
    {"nis_largest", "1", of_largest<&LargestInnovation::nis>},
    {"nis_largest_components", "1", of_largest<&LargestInnovation::dof>},
    {"nis_largest_run", "1", of_largest<&LargestInnovation::run>},
    {"nis_largest_time", "s", of_largest<&LargestInnovation::time>},
    {"nis_per_component_without_largest", "1", of_largest<&LargestInnovation::ratio_without>}};

void innovations_numbers(const CellAnalysis& cell, Frame::Row& all) {
  const Innovations* found = cell.find<Innovations>();
  add_numbers(kInnovationQuantities, found, all);
  for (std::size_t lag = 1; lag <= kInnovationLags; ++lag) {
    all.emplace_back("innovation_correlation_" + std::to_string(lag), "1",
                     found != nullptr ? found->autocorrelation[lag - 1] : kNaN);
  }
  all.emplace_back("innovation_correlation_bound", "1",
                   found != nullptr ? widest_bound(*found) : kNaN);
}

void innovations_series(const CellAnalysis& cell, std::vector<Frame::Column>& all) {
  const Innovations* innovations = cell.find<Innovations>();
  if (innovations == nullptr || innovations->average.empty()) return;
  all.push_back({"nis_per_component", "1", innovations->average});
  all.push_back({"nis_lower", "1", ends_of(innovations->bounds, &Interval::lower)});
  all.push_back({"nis_upper", "1", ends_of(innovations->bounds, &Interval::upper)});
}

/// Text of the largest innovation: "74 of 3 components at 0.05 s of run 0".
std::string largest_text(const LargestInnovation& largest) {
  const std::string components = std::to_string(std::llround(largest.dof));
  return compact(largest.nis) + " of " + components +
         (largest.dof == 1.0 ? " component at " : " components at ") +
         time_text(largest.time, largest.origin) + " of run " + std::to_string(largest.run);
}

/// Whether a cell has innovations that passed a gate, so that the stored NIS are those of (9.3).
bool has_gate(const StudyAnalysis& study) {
  return std::ranges::any_of(
      study.cells, [](const CellAnalysis& cell) { return cell.find<GateScale>() != nullptr; });
}

std::vector<TextTable::Entry> innovation_row(const CellAnalysis& cell, bool is_gated) {
  std::vector<TextTable::Entry> row;
  const Innovations* found = cell.find<Innovations>();
  if (found == nullptr) return row;
  add_entries(kInnovationQuantities, *found, found->verdict.level, row);
  const std::size_t lag = found->worst_lag;
  const auto at_worst = [&](const std::vector<double>& values) {
    return lag == 0 ? "-" : readable(values[lag - 1]);
  };
  row.push_back({"correlation at lag 1", readable(found->autocorrelation.front())});
  row.push_back({"largest correlation", at_worst(found->autocorrelation) +
                                            (lag == 0 ? "" : " at lag " + std::to_string(lag))});
  row.push_back({"its bound", at_worst(found->white_bound)});
  row.push_back({"innovations", whiteness_in_words(*found), Align::left});
  row.push_back({is_gated ? "largest NIS, as if without the gate" : "largest NIS",
                 largest_text(found->largest), Align::left});
  row.push_back({"mean without it", readable(found->largest.ratio_without)});
  return row;
}

/// Returns the bands within which white innovations stay: one for each different width among the
/// cells; none if no lag was tested.
std::vector<Band> white_bands(const StudyAnalysis& study) {
  std::map<double, double> level_of_bound;
  for (const CellAnalysis& cell : study.cells) {
    const Innovations* found = cell.find<Innovations>();
    if (found == nullptr || found->worst_lag == 0) continue;
    level_of_bound.emplace(widest_bound(*found), found->verdict.level);
  }
  std::vector<Band> bands;
  for (const auto& [bound, level] : level_of_bound) {
    bands.push_back(
        {bands.empty() ? level_text(level) + " band of white ones" : "", -bound, bound});
  }
  return bands;
}

Figure innovation_figure(const StudyAnalysis& study) {
  return cell_figure(study, figure_of("nis"),
                     {"nis_per_component", "NIS per component", {}, {}, Scale::automatic},
                     [](const CellAnalysis& cell) { return cell.get<Innovations>().average; });
}

Figure whiteness_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("whiteness");
  const CellValues correlation = [](const CellAnalysis& cell) {
    return cell.get<Innovations>().autocorrelation;
  };
  std::vector<Panel> panels = cell_panels(
      study, {"whiteness", "correlation of NIS to the power 2/3", {}, {}, Scale::around_zero},
      correlation);
  for (Panel& panel : panels) panel.bands = white_bands(study);
  std::vector<double> lags(kInnovationLags);
  std::iota(lags.begin(), lags.end(), 1.0);
  figure.chart.x_label = "innovations apart";
  add_panels(panels, lags, figure);
  return figure;
}

/// Makes a sentence for each cell whose findings depend on one innovation.
std::vector<std::string> largest_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  for (const CellAnalysis& cell : study.cells) {
    const Innovations* found = cell.find<Innovations>();
    if (found == nullptr || !found->are_decided_by_largest()) continue;
    const LargestInnovation& largest = found->largest;
    const bool is_gated = cell.find<GateScale>() != nullptr;
    notes.push_back(
        prose("innovations", "largest",
              {{"cell", cell.label},
               {"largest", largest_text(largest) + (is_gated ? ", as if without the gate" : "")},
               {"words", whiteness_without_largest(*found)},
               {"without", readable(largest.ratio_without)},
               {"with", readable(found->ratio)}}));
  }
  return notes;
}

/// Text of the components that are not white, or have a mean: "; gap has a correlation of 0.19 at
/// lag 1, where 0.06 would be white".
std::string correlated_words(const Innovations& found, const std::vector<std::string>& names) {
  std::string words;
  for (std::size_t k = 0; k < std::min(found.components.size(), names.size()); ++k) {
    const ComponentCorrelation& one = found.components[k];
    if (one.is_white()) {
      if (one.has_bias() && found.whiteness() == Whiteness::white) {
        words += "; " + names[k] + " has a bias (a mean of " + readable(one.mean, 2) + " +- " +
                 readable(one.mean_bound, 2) + " deviations, where 0 is right)";
      }
      continue;
    }
    words += "; " + names[k] + " has a correlation of " + readable(one.correlation, 2) +
             " at lag " + std::to_string(one.lag) + ", where " + readable(one.bound, 2) +
             " would be white";
  }
  return words;
}

/// Makes a sentence for each cell, where innovations are all that can be judged.
std::vector<Section::Block> leads_of(const StudyAnalysis& study) {
  std::vector<Section::Block> leads;
  const bool are_judged = study.imported.are_innovations() || !study.has_truth;
  if (!are_judged || !study.references.empty()) return leads;
  for (const CellAnalysis& cell : study.cells) {
    const Innovations* found = cell.find<Innovations>();
    if (found == nullptr) {
      leads.emplace_back(Section::Lead{
          cell.label + (study.imported.are_innovations()
                            ? ", innovations: not judged, since none has a covariance that is "
                              "positive definite."
                            : ", innovations: not judged, since it has none.")});
      continue;
    }
    std::string words = cell.label + ", innovations: " + whiteness_in_words(*found);
    if (found->judges_size()) {
      words += "; NIS per component " + ratio_with_interval(found->ratio, found->verdict.ratio()) +
               ", where 1 is right";
    }
    words += correlated_words(*found, study.imported.components);
    leads.emplace_back(Section::Lead{words + "."});
  }
  return leads;
}

std::vector<Section> innovations_sections(const StudyAnalysis& study) {
  const CellNumber nis = [](const CellAnalysis& cell) { return cell.get<Innovations>().ratio; };
  const CellEntries row = [&](const CellAnalysis& cell) {
    return innovation_row(cell, has_gate(study));
  };
  std::vector<Section> sections = table_section(
      section_of("innovations", {{"nis", range_over_cells(study, nis)}}), cell_table(study, row),
      {{"lags", std::to_string(kInnovationLags)}, {"runs", std::to_string(kFewestRunsOfSize)}});
  for (Section& section : sections) {
    const std::vector<Section::Block> leads = leads_of(study);
    section.blocks.insert(section.blocks.begin(), leads.begin(), leads.end());
    if (study.imported.are_innovations()) {
      section.shown = Section::Shown::open;
      if (!study.has_truth) section.add_html("<p>" + no_truth_sentence(study) + "</p>\n");
    }
    section.add(largest_notes(study));
  }
  return sections;
}

std::vector<Figure> innovations_figures(const StudyAnalysis& study) {
  return {innovation_figure(study), whiteness_figure(study)};
}

}  // namespace

Metric innovations_metric() {
  return {.sums = make_sums<InnovationsOverRuns>,
          .add_numbers = innovations_numbers,
          .add_series = innovations_series,
          .sections = innovations_sections,
          .figures = innovations_figures};
}

}  // namespace montecarta::analysis
