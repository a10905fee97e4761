// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/score.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/text_table.hpp"

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace montecarta::analysis {

struct CellAnalysis;
struct MeasuredRun;
struct StudyAnalysis;
struct RunCriteria;

/// Adds up the complete runs of one cell in the order of the calls.
class MetricSums {
 public:
  virtual ~MetricSums() = default;
  virtual void add(const MeasuredRun& run) = 0;
  /// Puts what the runs say into the cell, which has failures, scores (without intervals), series
  /// and what the metrics before put.
  virtual void put(CellAnalysis& cell) = 0;
};

/// A CSV file of a study.
struct TableFile {
  const char* name;
  bool (*applies)(const StudyAnalysis& study);
  void (*write)(const StudyAnalysis& study, const std::filesystem::path& path);
};

template <class Sums>
std::unique_ptr<MetricSums> make_sums(const RunCriteria& criteria) {
  return std::make_unique<Sums>(criteria);
}

/// What a metric contributes; what it has nothing of stays empty.
struct Metric {
  std::span<const Score> scores = {};            ///< of a run
  std::span<const ScanSeries> scan_series = {};  ///< of every scan of a run
  /// Whether means of the scores are numbers of every cell, in cells.csv and HDF5.
  bool scores_are_numbers = true;
  /// For more than means of scores, e.g. make_sums<MySums>; `criteria` outlive the sums.
  std::unique_ptr<MetricSums> (*sums)(const RunCriteria& criteria) = nullptr;
  /// Adds single numbers: the same names for every cell, NaN where one does not apply.
  void (*add_numbers)(const CellAnalysis& cell, std::vector<NamedNumber>& all) = nullptr;
  /// Adds numbers of every scan; what does not apply is absent.
  void (*add_series)(const CellAnalysis& cell, std::vector<NamedSeries>& all) = nullptr;
  /// Its parts of a report, tables with notes.
  std::vector<Section> (*sections)(const StudyAnalysis& study) = nullptr;
  /// Those without data are left out.
  std::vector<Figure> (*figures)(const StudyAnalysis& study) = nullptr;
  std::vector<TableFile> files = {};
};

/// All, in the order of files: a new one is a line in registry.cpp.
std::span<const Metric> all_metrics();

/// Everything a cell says in single numbers but its NEES tests.
std::vector<NamedNumber> numbers_of(const CellAnalysis& cell);
/// Everything a cell has over scans.
std::vector<NamedSeries> series_of(const CellAnalysis& cell);
/// The parts of a report that metrics have.
std::vector<Section> sections_of(const StudyAnalysis& study);
std::vector<Figure> figures_of(const StudyAnalysis& study);

}  // namespace montecarta::analysis
