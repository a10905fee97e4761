// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/score.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/output/text_table.hpp"
#include "analysis/statistics/merging.hpp"

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace montecarta::analysis {

struct CellAnalysis;
struct MeasuredRun;
struct StudyAnalysis;
struct RunCriteria;

/// Adds up the complete runs of one cell, or of a block of them, in the order of the calls.
class MetricSums {
 public:
  virtual ~MetricSums() = default;
  virtual void add(const MeasuredRun& run) = 0;
  /// Adds the sums of the same metric over the runs that follow these.
  virtual void merge(const MetricSums& next) = 0;
  /// Puts the result into the cell, which already has failures, scores (without intervals), series
  /// and the results of the metrics before this one.
  virtual void put(CellAnalysis& cell) = 0;
};

/// The base class of `Sums`, which has parts() (merging.hpp).
template <class Sums>
class MergedSums : public MetricSums {
 public:
  void merge(const MetricSums& next) final {
    merge_into(static_cast<Sums&>(*this), static_cast<const Sums&>(next));
  }
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

/// Contributions of a metric; members that it does not need stay empty.
struct Metric {
  std::span<const Score> scores = {};            ///< of a run
  std::span<const ScanSeries> scan_series = {};  ///< of every scan of a run
  /// Whether the means of the scores are written for every cell to cells.csv and HDF5.
  bool scores_are_numbers = true;
  /// Sums for results beyond means of scores, e.g. make_sums<MySums>; `criteria` outlive the sums.
  std::unique_ptr<MetricSums> (*sums)(const RunCriteria& criteria) = nullptr;
  /// Adds single numbers: the same names for every cell, NaN where a number does not apply.
  void (*add_numbers)(const CellAnalysis& cell, std::vector<NamedNumber>& all) = nullptr;
  /// Adds series over scans; those that do not apply are absent.
  void (*add_series)(const CellAnalysis& cell, std::vector<NamedSeries>& all) = nullptr;
  /// Sections of the report, with tables and notes.
  std::vector<Section> (*sections)(const StudyAnalysis& study) = nullptr;
  /// Figures; those without data are left out.
  std::vector<Figure> (*figures)(const StudyAnalysis& study) = nullptr;
  std::vector<TableFile> files = {};
};

/// All metrics in the order of files; registry.cpp lists them.
std::span<const Metric> all_metrics();

/// All single numbers of a cell except those of its NEES tests.
std::vector<NamedNumber> numbers_of(const CellAnalysis& cell);
/// All series of a cell.
std::vector<NamedSeries> series_of(const CellAnalysis& cell);
/// All sections of the metrics.
std::vector<Section> sections_of(const StudyAnalysis& study);
std::vector<Figure> figures_of(const StudyAnalysis& study);

}  // namespace montecarta::analysis
