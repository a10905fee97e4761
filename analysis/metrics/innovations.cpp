// SPDX-License-Identifier: BSD-3-Clause
// Size and whiteness of the innovations, which need no truth.
#include "analysis/metrics/innovations.hpp"

#include "analysis/metrics/cell_report.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/statistics/distributions.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kLagsTogether = 24;  // lags from 0 in whole registers
static_assert(kInnovationLags < kLagsTogether);

/// How many standard deviations white innovations keep to at all of `lags` lags (Sidak).
double white_deviate(std::size_t lags, double level) {
  const double each = std::pow(level, 1.0 / static_cast<double>(lags));
  return normal_quantile(0.5 + 0.5 * each);
}

/// The widest of the bounds of the lags that are tested; NaN if none is.
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
        innovations_(criteria.times.size()) {}
  void add(const MeasuredRun& run) override {
    if (!run.rows.nis.empty()) innovations_.add(run.rows.nis, run.rows.nis_dof);
  }
  void put(CellAnalysis& cell) override {
    if (innovations_.empty()) return;
    Innovations found = innovations_.result(criteria_->times, criteria_->level, criteria_->within);
    if (!has_common_scans_) {
      found.average.clear();
      found.bounds.clear();
    }
    cell.findings.put(std::move(found));
  }
  static constexpr auto parts() { return std::tuple(added(&InnovationsOverRuns::innovations_)); }

 private:
  const RunCriteria* criteria_;
  bool has_common_scans_;  ///< else runs are drives of their own, without a mean over time
  InnovationSums innovations_;
};

double nis_ratio(const Innovations& found) { return found.verdict.ratio_estimate(); }

const std::vector<ResultNumber<Innovations>> kInnovationQuantities = {
    {"nis_per_component",
     "1",
     nis_ratio,
     "NIS per component",
     {},
     [](const Innovations& found) { return found.verdict.ratio(); }},
    {"nis_share_inside", "1", &Innovations::share_inside, "scans in band", percent}};

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

std::vector<TextTable::Entry> innovation_row(const CellAnalysis& cell, double level) {
  std::vector<TextTable::Entry> row;
  const Innovations* found = cell.find<Innovations>();
  if (found == nullptr) return row;
  add_entries(kInnovationQuantities, *found, level, row);
  const std::size_t lag = found->worst_lag;
  const auto at_worst = [&](const std::vector<double>& values) {
    return lag == 0 ? "-" : readable(values[lag - 1]);
  };
  row.push_back({"correlation at lag 1", readable(found->autocorrelation.front())});
  row.push_back({"largest correlation", at_worst(found->autocorrelation) +
                                            (lag == 0 ? "" : " at lag " + std::to_string(lag))});
  row.push_back({"its bound", at_worst(found->white_bound)});
  row.push_back({"innovations", whiteness_in_words(*found), Align::left});
  return row;
}

/// Where white innovations stay: one band for each number of pairs of scans; where there are none
/// so far apart, no band.
std::vector<Band> white_bands(const StudyAnalysis& study) {
  std::set<double> bounds;
  for (const CellAnalysis& cell : study.cells) {
    const Innovations* found = cell.find<Innovations>();
    if (found != nullptr && found->worst_lag > 0) bounds.insert(widest_bound(*found));
  }
  std::vector<Band> bands;
  for (const double bound : bounds) {
    bands.push_back(
        {bands.empty() ? level_text(study.level) + " band of white ones" : "", -bound, bound});
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
      study, {"whiteness", "correlation of NIS", {}, {}, Scale::around_zero}, correlation);
  for (Panel& panel : panels) panel.bands = white_bands(study);
  std::vector<double> lags(kInnovationLags);
  std::iota(lags.begin(), lags.end(), 1.0);
  figure.chart.x_label = "scans apart";
  add_panels(panels, lags, figure);
  return figure;
}

std::vector<Section> innovations_sections(const StudyAnalysis& study) {
  const CellNumber nis = [](const CellAnalysis& cell) {
    return nis_ratio(cell.get<Innovations>());
  };
  const CellEntries row = [&](const CellAnalysis& cell) {
    return innovation_row(cell, study.level);
  };
  return table_section(section_of("innovations", {{"nis", range_over_cells(study, nis)}}),
                       cell_table(study, row), {{"lags", std::to_string(kInnovationLags)}});
}

std::vector<Figure> innovations_figures(const StudyAnalysis& study) {
  return {innovation_figure(study), whiteness_figure(study)};
}

}  // namespace

InnovationSums::InnovationSums(std::size_t scans)
    : nis_(scans), products_(1 + std::min(kInnovationLags, scans / 4)) {}

void InnovationSums::add(std::span<const double> nis, std::span<const std::uint32_t> dof) {
  bool has_any = false;
  // The last scan stands first, so that earlier ones follow it; where there is none stands zero.
  deviations_.assign(nis.size() + kLagsTogether, 0.0);
  is_there_.assign(deviations_.size(), 0.0);
  for (std::size_t s = 0; s < nis.size(); ++s) {
    if (dof[s] == 0 || !std::isfinite(nis[s])) continue;
    const double n = dof[s];
    nis_.add(s, nis[s], n);
    has_any = true;
    const std::size_t place = nis.size() - 1 - s;
    deviations_[place] = (nis[s] - n) / std::sqrt(2.0 * n);
    is_there_[place] = 1.0;
  }
  if (!has_any) return;
  ++runs_;
  std::array<double, kLagsTogether> n{}, both{}, product{};
  for (std::size_t place = nis.size(); place-- > 0;) {
    if (is_there_[place] == 0.0) continue;
    const double* const earlier = deviations_.data() + place;
    const double* const is_there = is_there_.data() + place;
    for (std::size_t lag = 0; lag < kLagsTogether; ++lag) {
      n[lag] += is_there[lag];
      both[lag] += is_there[lag] * (*earlier + earlier[lag]);
      product[lag] += *earlier * earlier[lag];
    }
  }
  for (std::size_t lag = 0; lag < products_.size(); ++lag) {
    products_[lag].n += n[lag];
    products_[lag].both += both[lag];
    products_[lag].product += product[lag];
  }
}

Innovations InnovationSums::result(std::span<const double> times, double level,
                                   double within) const {
  Innovations result;
  double tested = 0.0, inside = 0.0;
  for (const SummedError::Scan& scan : nis_.scans()) {
    const auto freedom = static_cast<std::uint64_t>(scan.dimensions);
    result.average.push_back(scan.ratio());  // NaN where there is none
    result.bounds.push_back(freedom == 0 ? Interval{} : nees_bounds(freedom, 1, level));
    if (freedom == 0) continue;
    const Interval& band = result.bounds.back();
    tested += 1.0;
    inside += band.lower <= scan.ratio() && scan.ratio() <= band.upper ? 1.0 : 0.0;
  }
  result.share_inside = inside / tested;
  result.verdict = judge(nis_.white_families(level, times), level, within, runs_);
  result.autocorrelation.assign(kInnovationLags, kNaN);
  result.white_bound.assign(kInnovationLags, kNaN);
  const double mean = products_[0].both / (2.0 * products_[0].n);
  const double power = products_[0].mean_product(mean);
  double farthest = 0.0;
  for (std::size_t lag = 1; lag < products_.size(); ++lag) {
    if (products_[lag].n == 0.0 || !(power > 0.0)) continue;
    const double correlation = products_[lag].mean_product(mean) / power;
    const double bound = white_deviate(products_.size() - 1, level) / std::sqrt(products_[lag].n);
    result.autocorrelation[lag - 1] = correlation;
    result.white_bound[lag - 1] = bound;
    if (result.worst_lag > 0 && std::abs(correlation) / bound <= farthest) continue;
    farthest = std::abs(correlation) / bound;
    result.worst_lag = lag;
  }
  return result;
}

bool Innovations::is_white() const {
  return worst_lag == 0 || std::abs(autocorrelation[worst_lag - 1]) <= white_bound[worst_lag - 1];
}

std::string whiteness_in_words(const Innovations& found) {
  const std::string white = found.worst_lag == 0 ? "whiteness not tested"
                            : found.is_white()   ? "white"
                                                 : "not white";
  return white + ", " + name_of(found.verdict.answer);
}

Metric innovations_metric() {
  return {.sums = make_sums<InnovationsOverRuns>,
          .add_numbers = innovations_numbers,
          .add_series = innovations_series,
          .sections = innovations_sections,
          .figures = innovations_figures};
}

}  // namespace montecarta::analysis
