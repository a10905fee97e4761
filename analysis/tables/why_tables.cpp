// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/tables/why_tables.hpp"

#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <cmath>

namespace montecarta {
namespace {

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
  const ErrorAnatomy& anatomy = *cell.anatomy;
  const bool has_share = cell.lineages && std::isfinite(cell.lineages->monte_carlo_share);
  return {cell.label,
          readable(anatomy.mean_worst_ratio),
          readable(right_worst_ratio(cell.complete, level)),
          direction_text(anatomy),
          percent(anatomy.mean_bias_share),
          decibel(cell.credibility->noncredibility),
          decibel(cell.credibility->inclination),
          has_share ? percent(cell.lineages->monte_carlo_share) : "-"};
}

std::vector<std::string> innovation_row(const CellAnalysis& cell) {
  const Innovations& found = *cell.innovations;
  const auto worst =
      std::ranges::max_element(found.autocorrelation, {}, [](double r) { return std::abs(r); });
  const auto lag = worst - found.autocorrelation.begin() + 1;
  return {cell.label,
          with_interval(found.mean, found.interval),
          percent(found.share_inside),
          readable(found.autocorrelation.front()),
          readable(*worst) + " at " + std::to_string(lag),
          readable(found.bound),
          found.white ? "white" : "not white"};
}

std::vector<std::string> diversity_row(const CellAnalysis& cell) {
  std::vector<std::string> row = {cell.label, readable(cell.over_runs("ess").mean),
                                  percent(cell.over_runs("resampling_rate").mean)};
  if (!cell.lineages) {
    row.resize(8, "-");
    return row;
  }
  for (const std::size_t lag : {0u, 3u, 6u}) row.push_back(readable(cell.lineages->ancestors[lag]));
  const bool has_met = std::isfinite(cell.lineages->coalescence);
  row.push_back(has_met ? readable(cell.lineages->coalescence) + " s" : "-");
  row.push_back(percent(cell.lineages->coalesced_share));
  return row;
}

}  // namespace

TextTable why_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"worst variance ratio"},
                    {"right below"},
                    {"worst direction"},
                    {"bias"},
                    {"noncredibility"},
                    {"inclination"},
                    {"Monte Carlo share"}};
  for (const CellAnalysis& cell : study.cells) {
    if (cell.anatomy) table.rows.push_back(why_row(cell, study.level));
  }
  return table;
}

std::vector<std::string> why_notes(const StudyAnalysis& study) {
  return {
      "The worst variance ratio is how many times larger the squared errors are than the filter's "
      "variance, in the direction where that is worst (seen from the true vehicle: forward, left, "
      "heading), geometric mean over scans; of a right filter it is below 'right below' at " +
          level_text(study.level) +
          " of scans. The direction says which component that is, in units of its deviation.",
      "'bias' is the part of ANEES that the mean error makes: what is left is scatter that the "
      "filter does not know of. Bias calls for a better model, scatter for more honest noise.",
      "Noncredibility is how far, up or down, covariances are from the errors that happened (3 dB: "
      "a "
      "factor of 2 in variance); the inclination has a sign: above 0 too sure, below 0 too modest.",
      "'Monte Carlo share' is the part of the squared position error that comes from the particles "
      "being few, by how far their families differ; it needs record.columns with ancestry and "
      "particles."};
}

TextTable innovation_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},
                    {"NIS per component [" + level_text(study.level) + "]"},
                    {"scans inside"},
                    {"correlation, 1 scan"},
                    {"largest, scans apart"},
                    {"white below"},
                    {"innovations", Align::left}};
  for (const CellAnalysis& cell : study.cells) {
    if (cell.innovations) table.rows.push_back(innovation_row(cell));
  }
  return table;
}

std::vector<std::string> innovation_notes() {
  return {
      "The NIS compares what the filter measured with what it expected to measure, and needs no "
      "truth: 1 per component means it expects its measurements rightly, more that they surprise "
      "it. "
      "Surprises of a right filter are 'white': one says nothing of the next. The correlation over "
      "scans that lie up to " +
      std::to_string(kInnovationLags) +
      " apart stays below the bound then. A filter can pass this test and still not know its "
      "pose."};
}

TextTable diversity_table(const StudyAnalysis& study) {
  TextTable table;
  table.headings = {{"cell", Align::left},  {"ESS"},      {"resampled"},
                    {"ancestors, 1 s ago"}, {"10 s ago"}, {"100 s ago"},
                    {"common ancestor"},    {"in scans"}};
  for (const CellAnalysis& cell : study.cells) {
    if (!cell.over_time("ess").empty()) table.rows.push_back(diversity_row(cell));
  }
  return table;
}

std::vector<std::string> diversity_notes() {
  return {
      "How many different histories the particles tell: the effective number of particles, the "
      "share of scans that end with a resampling, and how many different ancestors all particles "
      "have so long ago. Behind the common ancestor there is only one history left: the filter can "
      "no longer change its mind about what lies before it, nor know how wrong it is there. It was "
      "found in the share of scans in the last column."};
}

}  // namespace montecarta
