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
#include <limits>
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

bool is_innovation(double nis, std::uint32_t dof) { return dof > 0 && std::isfinite(nis); }

/// The normal score of a chi-square variable (Wilson and Hilferty 1931), also where its tail is too
/// small for a double.
double normal_deviate(double chi_square, double freedom) {
  const double variance = 2.0 / (9.0 * freedom);
  return (std::cbrt(chi_square / freedom) - (1.0 - variance)) / std::sqrt(variance);
}

bool is_off(Answer answer) {
  return answer == Answer::optimistic || answer == Answer::conservative ||
         answer == Answer::inconsistent;
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
    if (run.rows.nis.empty()) return;
    innovations_.add(run.rows.run, run.times, run.rows.nis, run.rows.nis_dof);
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

/// "74 of 3 components at 0.05 s of run 0"
std::string largest_text(const LargestInnovation& largest) {
  const std::string components = std::to_string(std::llround(largest.dof));
  return compact(largest.nis) + " of " + components +
         (largest.dof == 1.0 ? " component at " : " components at ") + readable(largest.time) +
         " s of run " + std::to_string(largest.run);
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
  row.push_back({"largest NIS", largest_text(found->largest), Align::left});
  row.push_back({"mean without it", readable(found->largest.ratio_without)});
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

/// A sentence for each cell whose findings depend on one innovation.
std::vector<std::string> largest_notes(const StudyAnalysis& study) {
  std::vector<std::string> notes;
  for (const CellAnalysis& cell : study.cells) {
    const Innovations* found = cell.find<Innovations>();
    if (found == nullptr || !found->are_decided_by_largest()) continue;
    const LargestInnovation& largest = found->largest;
    notes.push_back(
        prose("innovations", "largest",
              {{"cell", cell.label},
               {"largest", largest_text(largest)},
               {"words", whiteness_in_words(largest.whiteness_without, largest.answer_without)},
               {"without", readable(largest.ratio_without)},
               {"with", readable(found->ratio)}}));
  }
  return notes;
}

std::vector<Section> innovations_sections(const StudyAnalysis& study) {
  const CellNumber nis = [](const CellAnalysis& cell) { return cell.get<Innovations>().ratio; };
  const CellEntries row = [&](const CellAnalysis& cell) {
    return innovation_row(cell, study.level);
  };
  std::vector<Section> sections = table_section(
      section_of("innovations", {{"nis", range_over_cells(study, nis)}}), cell_table(study, row),
      {{"lags", std::to_string(kInnovationLags)}, {"runs", std::to_string(kFewestRunsOfSize)}});
  for (Section& section : sections) section.add(largest_notes(study));
  return sections;
}

std::vector<Figure> innovations_figures(const StudyAnalysis& study) {
  return {innovation_figure(study), whiteness_figure(study)};
}

}  // namespace

InnovationSums::Totals::Totals(std::size_t scans)
    : nis_(scans), products_(1 + std::min(kInnovationLags, scans / 4)) {}

void InnovationSums::Totals::add(std::span<const double> nis, std::span<const std::uint32_t> dof) {
  std::vector<double> there(nis.begin(), nis.end());
  for (std::size_t s = 0; s < nis.size(); ++s) {
    if (!is_innovation(nis[s], dof[s])) there[s] = kNaN;
  }
  nis_.add(there, std::vector<double>(dof.begin(), dof.end()));
  add_products(nis, dof);
}

void InnovationSums::Totals::add_products(std::span<const double> nis,
                                          std::span<const std::uint32_t> dof) {
  // The last scan stands first, so that earlier ones follow it; where there is none stands zero.
  deviations_.assign(nis.size() + kLagsTogether, 0.0);
  is_there_.assign(deviations_.size(), 0.0);
  for (std::size_t s = 0; s < nis.size(); ++s) {
    if (!is_innovation(nis[s], dof[s])) continue;
    const std::size_t place = nis.size() - 1 - s;
    deviations_[place] = (nis[s] - dof[s]) / std::sqrt(2.0 * dof[s]);
    is_there_[place] = 1.0;
  }
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

void InnovationSums::add(std::uint64_t run, std::span<const double> times,
                         std::span<const double> nis, std::span<const std::uint32_t> dof) {
  std::optional<LargestRun> next;
  for (std::size_t s = 0; s < nis.size(); ++s) {
    if (!is_innovation(nis[s], dof[s])) continue;
    const double deviate = normal_deviate(nis[s], dof[s]);
    if (next && deviate <= next->deviate) continue;
    next = {.deviate = deviate, .run = run, .scan = s, .time = times[s], .nis = {}, .dof = {}};
  }
  if (!next) return;
  if (largest_ && next->deviate <= largest_->deviate) return others_.add(nis, dof);
  if (largest_) others_.add(largest_->nis, largest_->dof);
  next->nis.assign(nis.begin(), nis.end());
  next->dof.assign(dof.begin(), dof.end());
  largest_.swap(next);
}

void InnovationSums::merge(InnovationSums& next) {
  merge_into(others_, next.others_);
  if (!next.largest_) return;
  if (!largest_) return largest_.swap(next.largest_);
  if (next.largest_->deviate > largest_->deviate) largest_.swap(next.largest_);
  others_.add(next.largest_->nis, next.largest_->dof);
}

Innovations InnovationSums::result(std::span<const double> times, double level,
                                   double within) const {
  expect(largest_.has_value(), "an innovation");
  Totals all = others_, without = others_;
  all.add(largest_->nis, largest_->dof);
  std::vector<std::uint32_t> dof = largest_->dof;
  dof[largest_->scan] = 0;
  without.add(largest_->nis, dof);
  Innovations result = all.result(times, level, within);
  const Innovations rest = without.result(times, level, within);
  result.largest = {.nis = largest_->nis[largest_->scan],
                    .dof = static_cast<double>(largest_->dof[largest_->scan]),
                    .run = largest_->run,
                    .time = largest_->time,
                    .ratio_without = rest.ratio,
                    .whiteness_without = rest.whiteness(),
                    .answer_without = rest.verdict.answer};
  return result;
}

Innovations InnovationSums::Totals::result(std::span<const double> times, double level,
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
  find_correlations(level, result);
  judge_size(times, level, within, result);
  return result;
}

void InnovationSums::Totals::find_correlations(double level, Innovations& result) const {
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
}

void InnovationSums::Totals::judge_size(std::span<const double> times, double level, double within,
                                        Innovations& result) const {
  std::vector<FamilyTest> families;
  if (result.whiteness() != Whiteness::not_white) {
    families = nis_.white_families(level, times);
  } else if (runs() >= kFewestRunsOfSize) {
    families = judge_tests({nis_.size_test()}, level);
  }
  result.verdict = judge(std::move(families), level, within, runs());
  double sum = 0.0, freedom = 0.0;
  for (const SummedError::Scan& scan : nis_.scans()) {
    sum += scan.nees;
    freedom += scan.dimensions;
  }
  const double judged = result.verdict.ratio_estimate();
  result.ratio = std::isnan(judged) ? sum / freedom : judged;
}

Whiteness Innovations::whiteness() const {
  if (worst_lag == 0) return Whiteness::untested;
  const bool is_white = std::abs(autocorrelation[worst_lag - 1]) <= white_bound[worst_lag - 1];
  return is_white ? Whiteness::white : Whiteness::not_white;
}

bool Innovations::are_decided_by_largest() const {
  if (std::isnan(largest.ratio_without)) return false;
  return whiteness() != largest.whiteness_without ||
         is_off(verdict.answer) != is_off(largest.answer_without);
}

std::string whiteness_in_words(Whiteness whiteness, Answer answer) {
  if (whiteness == Whiteness::untested) return "whiteness not tested, " + name_of(answer);
  if (whiteness == Whiteness::white) return "white, " + name_of(answer);
  return "not white, size " + (answer == Answer::untested ? "not judged" : name_of(answer));
}

std::string whiteness_in_words(const Innovations& found) {
  return whiteness_in_words(found.whiteness(), found.verdict.answer);
}

Metric innovations_metric() {
  return {.sums = make_sums<InnovationsOverRuns>,
          .add_numbers = innovations_numbers,
          .add_series = innovations_series,
          .sections = innovations_sections,
          .figures = innovations_figures};
}

}  // namespace montecarta::analysis
