// SPDX-License-Identifier: BSD-3-Clause
// Ancestors of the particles, their effective number, and the Monte Carlo error of few of them.
#include "analysis/metrics/lineages.hpp"

#include "analysis/metrics/cell_report.hpp"
#include "analysis/metrics/measured_run.hpp"
#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostScansOfLineages = 32;
constexpr double kSameTime = 1e-9;

template <double Lineages::*kValue>
double of_lineages(const MeasuredRun& run) {
  const Lineages* lineages = run.metrics.lineages();
  return lineages == nullptr ? kNaN : lineages->*kValue;
}

constexpr Score kLineagesScores[] = {
    {"coalescence", "s", "time back to the common ancestor", of_lineages<&Lineages::coalescence>,
     Better::higher},
    {"monte_carlo_variance", "m2", "position variance by few particles",
     of_lineages<&Lineages::monte_carlo_variance>},
};

class LineagesOverRuns final : public MergedSums<LineagesOverRuns> {
 public:
  explicit LineagesOverRuns(const RunCriteria& /*criteria*/) {}
  void add(const MeasuredRun& run) override {
    if (run.metrics.lineages() != nullptr) lineages_.add(*run.metrics.lineages());
  }
  void put(CellAnalysis& cell) override {
    if (!lineages_.empty()) cell.findings.put(lineages_.result());
  }
  static constexpr auto parts() { return std::tuple(added(&LineagesOverRuns::lineages_)); }

 private:
  LineageSums lineages_;
};

template <std::size_t kLag>
double ancestors_ago(const LineageSummary& found) {
  return found.ancestors[kLag];
}

/// In words where all runs have one.
std::string common_ancestor_text(double coalescence) {
  return std::isfinite(coalescence) ? readable(coalescence) + " s" : "-";
}

const std::vector<ResultNumber<LineageSummary>> kLineageQuantities = {
    {"distinct_ancestors_1_s_ago", "1", ancestors_ago<0>, "ancestors, 1 s ago"},
    {"distinct_ancestors_2_s_ago", "1", ancestors_ago<1>},
    {"distinct_ancestors_5_s_ago", "1", ancestors_ago<2>},
    {"distinct_ancestors_10_s_ago", "1", ancestors_ago<3>, "10 s ago"},
    {"distinct_ancestors_20_s_ago", "1", ancestors_ago<4>},
    {"distinct_ancestors_50_s_ago", "1", ancestors_ago<5>},
    {"distinct_ancestors_100_s_ago", "1", ancestors_ago<6>, "100 s ago"},
    {"coalescence", "s", &LineageSummary::coalescence, "common ancestor", common_ancestor_text},
    {"coalesced_share", "1", &LineageSummary::coalesced_share, "scans with one", percent},
    {"monte_carlo_share", "1", &LineageSummary::monte_carlo_share, "Monte Carlo share", percent}};

/// Throws RunError where a parent does not exist.
void expect_parents(std::span<const std::uint32_t> parents) {
  std::uint32_t largest = 0;
  for (const std::uint32_t parent : parents) largest = std::max(largest, parent);
  if (largest < parents.size()) return;
  throw RunError("ancestor: parent " + std::to_string(largest) + " of " +
                 std::to_string(parents.size()) +
                 " particles (the column is damaged): run the study again");
}

using Counts = std::vector<std::uint32_t>;

template <Counts Diversity::*kCounts>
std::vector<double> counts_over_time(const MeasuredRun& run) {
  const Diversity* diversity = run.metrics.diversity();
  if (diversity == nullptr) return {};
  return {(diversity->*kCounts).begin(), (diversity->*kCounts).end()};
}

template <Counts Diversity::*kCounts>
double mean_of_counts(const MeasuredRun& run) {
  return mean_of(counts_over_time<kCounts>(run));
}

double first_with_descendants(const MeasuredRun& run) {
  const Diversity* diversity = run.metrics.diversity();
  return diversity == nullptr ? kNaN : diversity->root.back();
}

constexpr Score kParticlesScores[] = {
    {"ess", "1", "effective particles",
     [](const MeasuredRun& run) { return mean_of(run.rows.ess); }, Better::higher},
    {"resampling_rate", "1", "share of scans that resample",
     [](const MeasuredRun& run) { return mean_of(run.rows.resampled); }, Better::neither},
    {"ancestors_last_resampling", "1", "distinct particles after a resampling",
     mean_of_counts<&Diversity::last_resampling>, Better::higher},
    {"ancestors_10_s_ago", "1", "distinct ancestors 10 s ago", mean_of_counts<&Diversity::lag>,
     Better::higher},
    {"ancestors_at_start", "1", "distinct ancestors at the start", mean_of_counts<&Diversity::root>,
     Better::higher},
    {"ancestors_at_start_at_the_end", "1", "first particles that have descendants at the end",
     first_with_descendants, Better::higher},
};

constexpr ScanSeries kParticlesSeries[] = {
    {"ess", "1", [](const MeasuredRun& run) { return run.rows.ess; }},
    {"ancestors_last_resampling", "1", counts_over_time<&Diversity::last_resampling>},
    {"ancestors_10_s_ago", "1", counts_over_time<&Diversity::lag>},
    {"ancestors_at_start", "1", counts_over_time<&Diversity::root>},
};

std::vector<TextTable::Entry> diversity_row(const StudyAnalysis& study, const CellAnalysis& cell) {
  const bool has_ess = study.own_drives > 0 ? cell.complete > 0 : !cell.over_time("ess").empty();
  if (!has_ess) return {};
  std::vector<TextTable::Entry> row = {
      {"ESS", readable(cell.over_runs("ess").mean)},
      {"resampled", percent(cell.over_runs("resampling_rate").mean)}};
  LineageSummary none;
  none.ancestors.fill(kNaN);
  const LineageSummary* found = cell.find<LineageSummary>();
  add_entries(kLineageQuantities, found != nullptr ? *found : none, study.level, row);
  return row;
}

/// A panel of distinct ancestors.
Panel ancestor_panel(const StudyAnalysis& study, const std::string& series,
                     const std::string& label) {
  const CellValues values = [&](const CellAnalysis& cell) { return cell.over_time(series); };
  return {series, label, cell_curves(study, values), {}, Scale::logarithmic};
}

Figure diversity_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("diversity");
  add_panels({ancestor_panel(study, "ancestors_last_resampling", "parents, last resampling"),
              ancestor_panel(study, "ancestors_10_s_ago", "ancestors, 10 s ago"),
              ancestor_panel(study, "ancestors_at_start", "ancestors at the start")},
             study.times, figure);
  return figure;
}

Figure ess_figure(const StudyAnalysis& study) {
  Figure figure = figure_of("ess");
  const CellValues share = [](const CellAnalysis& cell) {
    return scaled(cell.over_time("ess"), 100.0 / static_cast<double>(cell.particles));
  };
  add_panels(
      {{"ess_share", "effective particles [%]", cell_curves(study, share), {}, Scale::percent}},
      study.times, figure);
  return figure;
}

/// How far back the common ancestor lies, or, without ancestry, how many particles count.
std::string diversity_summary(const StudyAnalysis& study) {
  const CellNumber back = [](const CellAnalysis& cell) {
    return cell.get<LineageSummary>().coalescence;
  };
  const std::string range = range_over_cells(study, back, fixed_seconds);
  if (range != "-") return "the common ancestor of all particles lies " + range + " back";
  const CellNumber ess = [](const CellAnalysis& cell) { return cell.over_runs("ess").mean; };
  return "effective particles (ESS) " + range_over_cells(study, ess);
}

std::vector<Section> particles_sections(const StudyAnalysis& study) {
  Section section = section_of("diversity");
  const TextTable table =
      cell_table(study, [&](const CellAnalysis& cell) { return diversity_row(study, cell); });
  section.add("diversity", table);
  section.summary = diversity_summary(study);
  if (!table.rows.empty()) section.add_notes("notes");
  return {section};
}

std::vector<Figure> particles_figures(const StudyAnalysis& study) {
  return {diversity_figure(study), ess_figure(study)};
}

}  // namespace

void find_resamplings(std::span<const std::uint32_t> ancestor, std::size_t particles,
                      std::vector<std::size_t>& resampled) {
  resampled.resize(particles == 0 ? 0 : ancestor.size() / particles);
  std::vector<std::uint32_t> themselves(particles);
  std::iota(themselves.begin(), themselves.end(), 0u);
  std::size_t latest = 0;
  for (std::size_t s = 0; s < resampled.size(); ++s) {
    const auto parents = ancestor.subspan(s * particles, particles);
    if (!std::ranges::equal(parents, themselves)) {
      expect_parents(parents);
      latest = s + 1;
    }
    resampled[s] = latest;
  }
}

struct LineageWalker::Sums {
  std::array<SummaryOf, kLineageLags.size()> ancestors;
  SummaryOf coalescence, coalesced, variance, squared_error;
};

/// With `ancestor_` telling the families of the particles of scan `s`.
double LineageWalker::family_variance(const RunRows& rows, std::size_t s) {
  const std::size_t particles = ancestor_.size();
  const double* const pose = rows.particle_pose.data() + 3 * particles * s;
  const double* const log_weight = rows.log_weight.data() + particles * s;
  double x = 0.0, y = 0.0;
  for (std::size_t i = 0; i < particles; ++i) {
    x += std::exp(log_weight[i]) * pose[3 * i];
    y += std::exp(log_weight[i]) * pose[3 * i + 1];
  }
  families_.assign(2 * particles, 0.0);
  for (std::size_t i = 0; i < particles; ++i) {
    const double weight = std::exp(log_weight[i]);
    families_[2 * ancestor_[i]] += weight * (pose[3 * i] - x);
    families_[2 * ancestor_[i] + 1] += weight * (pose[3 * i + 1] - y);
  }
  return std::inner_product(families_.begin(), families_.end(), families_.begin(), 0.0);
}

/// Walks from resampling to resampling; between them everyone is their own parent.
void LineageWalker::walk_from(std::size_t s, const RunRows& rows,
                              std::span<const std::size_t> resampled, std::span<const double> times,
                              Sums& sums) {
  const std::size_t particles = ancestor_.size();
  bool is_before_family_lag = !rows.particle_pose.empty();
  set_.start(particles);
  std::iota(ancestor_.begin(), ancestor_.end(), 0u);
  std::size_t lag = 0;
  const auto count_until = [&](double back) {
    for (; lag < kLineageLags.size() && back >= kLineageLags[lag]; ++lag) {
      sums.ancestors[lag].add(static_cast<double>(set_.size()));
    }
    if (!is_before_family_lag || back < kDiversityLag) return;
    is_before_family_lag = false;
    if (set_.size() > 1) sums.variance.add(family_variance(rows, s));
  };
  for (std::size_t next = resampled[s]; next > 0 && set_.size() > 1;) {
    const std::size_t scan = next - 1;
    count_until(times[s] - times[scan] + kSameTime);
    const std::span parents(rows.ancestor.data() + particles * scan, particles);
    set_.step_back(parents);
    if (is_before_family_lag) {
      for (std::uint32_t& ancestor : ancestor_) ancestor = parents[ancestor];
    }
    next = scan > 0 ? resampled[scan - 1] : 0;
    if (set_.size() > 1) continue;
    sums.coalescence.add(times[s] - (scan == 0 ? 0.0 : times[scan - 1]) + kSameTime);
  }
  sums.coalesced.add(set_.size() == 1 ? 1.0 : 0.0);
  // If one ancestor is left, it is left at every longer lag of the run too.
  count_until(times[s] + kSameTime);
}

Lineages LineageWalker::walk(const RunRows& rows, std::span<const std::size_t> resampled,
                             std::span<const double> times,
                             std::span<const double> squared_position) {
  ancestor_.resize(rows.ancestor.size() / times.size());
  Sums sums;
  const std::size_t every = (times.size() + kMostScansOfLineages - 1) / kMostScansOfLineages;
  for (std::size_t s = every - 1; s < times.size(); s += every) {
    walk_from(s, rows, resampled, times, sums);
    if (!squared_position.empty()) sums.squared_error.add(squared_position[s]);
  }
  Lineages lineages;
  for (std::size_t lag = 0; lag < kLineageLags.size(); ++lag) {
    lineages.ancestors[lag] = sums.ancestors[lag].result().mean;
  }
  lineages.coalescence = sums.coalescence.result().mean;
  lineages.coalesced_share = sums.coalesced.result().mean;
  lineages.monte_carlo_variance = sums.variance.result().mean;
  lineages.squared_error = sums.squared_error.result().mean;
  return lineages;
}

void LineageSums::Mean::add(double value) {
  if (std::isnan(value)) return;
  sum += value;
  n += 1.0;
}

void LineageSums::add(const Lineages& lineages) {
  ++runs_;
  for (std::size_t lag = 0; lag < ancestors_.size(); ++lag) {
    ancestors_[lag].add(lineages.ancestors[lag]);
  }
  coalescence_.add(lineages.coalescence);
  coalesced_.add(lineages.coalesced_share);
  variance_.add(lineages.monte_carlo_variance);
  squared_error_.add(lineages.squared_error);
}

LineageSummary LineageSums::result() const {
  LineageSummary summary;
  for (std::size_t lag = 0; lag < ancestors_.size(); ++lag) {
    summary.ancestors[lag] = ancestors_[lag].value();
  }
  summary.coalescence = coalescence_.value();
  summary.coalesced_share = coalesced_.value();
  summary.monte_carlo_share = variance_.value() / squared_error_.value();
  return summary;
}

Metric lineages_metric() {
  return {.scores = kLineagesScores,
          .scores_are_numbers = false,
          .sums = make_sums<LineagesOverRuns>,
          .add_numbers = numbers_by(kLineageQuantities)};
}

/// Walks from resampling to resampling, until one ancestor is left; between them everyone is their
/// own parent.
void DiversityCounter::walk_back(std::size_t first, std::size_t s) {
  path_.clear();
  set_.start(particles_);
  for (std::size_t next = s + 1; next > first && set_.size() > 1;) {
    set_.step_back(parents(next - 1));
    path_.push_back({next - 1, static_cast<std::uint32_t>(set_.size())});
    next = next > 1 ? resampled_[next - 2] : 0;
  }
}

void DiversityCounter::count_back(std::span<const double> times) {
  auto all = static_cast<std::uint32_t>(particles_), last = all;
  path_.clear();
  std::size_t first = 0;  // the first scan later than kDiversityLag ago
  for (std::size_t s = 0; s < times.size(); ++s) {
    while (times[first] <= times[s] - kDiversityLag + 1e-9) ++first;
    if (resampled_[s] == s + 1) {
      walk_back(first, s);
      last = path_.front().ancestors;
    }
    while (!path_.empty() && path_.back().scan < first) path_.pop_back();
    result_.last_resampling[s] = last;
    result_.lag[s] = path_.empty() ? all : path_.back().ancestors;
  }
}

void DiversityCounter::count_root() {
  set_.start(particles_);
  root_.resize(particles_);
  std::iota(root_.begin(), root_.end(), 0u);
  for (std::size_t s = 0; s < resampled_.size(); ++s) {
    if (resampled_[s] == s + 1 && set_.size() > 1) {
      previous_ = root_;
      for (std::size_t i = 0; i < particles_; ++i) root_[i] = previous_[parents(s)[i]];
      set_.assign(root_);
    }
    result_.root[s] = static_cast<std::uint32_t>(set_.size());
  }
}

const Diversity& DiversityCounter::count(Row ancestor, std::size_t particles,
                                         std::span<const double> times) {
  expect(ancestor.size() == times.size() * particles, "ancestors are {scan, particle}");
  ancestor_ = ancestor;
  particles_ = particles;
  for (auto* column : {&result_.last_resampling, &result_.lag, &result_.root}) {
    column->resize(times.size());
  }
  find_resamplings(ancestor, particles, resampled_);
  count_back(times);
  count_root();
  return result_;
}

Metric particles_metric() { return {.scores = kParticlesScores}; }

/// Apart from the scores: in files its series come last.
Metric diversity_metric() {
  return {.scan_series = kParticlesSeries,
          .sections = particles_sections,
          .figures = particles_figures};
}

}  // namespace montecarta::analysis
