// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/calibration_table.hpp"

#include "analysis/metrics/cell_calibration.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/number_text.hpp"

#include <algorithm>
#include <array>

namespace montecarta {
namespace {

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

}  // namespace

bool has_calibration(const StudyAnalysis& study) {
  return std::ranges::any_of(
      study.cells, [](const CellAnalysis& cell) { return !cell.get<Calibrations>().empty(); });
}

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

std::vector<std::string> calibration_notes(const StudyAnalysis& study) {
  if (!has_calibration(study)) return {};
  std::vector<std::string> notes = {
      "Calibration asks, at the end of each quarter of the run, which share of what the filter "
      "holds "
      "for possible lies below the truth (its Gaussian, or its weighted particles): over runs that "
      "share should be anything from 0 to 1 equally often. 'too narrow': the truth lies at the "
      "ends "
      "too often; 'too wide': in the middle too often; 'shifted': on one side.",
      "A histogram is calibrated where all of its bins are inside a band that chance keeps all at "
      "once in " +
          level_text(study.level) +
          " of studies, each histogram by itself; of many tests a few fail by chance. Every run "
          "gives "
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

}  // namespace montecarta
