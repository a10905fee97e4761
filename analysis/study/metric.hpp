// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/sums.hpp"
#include "analysis/study/cell_analysis.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/score_table.hpp"
#include "analysis/study/section.hpp"
#include "analysis/study/text_table.hpp"
#include "engine/errors.hpp"
#include "engine/text/number_text.hpp"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace montecarta::analysis {

struct MeasuredRun;
struct StudyAnalysis;
struct RunCriteria;

/// Sums of one metric over the complete runs of a cell, or of a block, in the order of the calls.
class MetricSums {
 public:
  virtual ~MetricSums() = default;
  virtual void add(const MeasuredRun& run) = 0;
  /// Adds the sums of the same metric over the runs that follow; `next` is used up.
  virtual void merge(MetricSums& next) = 0;
  /// Writes the sums as words (sums.hpp), reads them, and names their layout.
  virtual void write(SumWriter& words) const = 0;
  virtual void read(SumReader& words) = 0;
  virtual void add_layout(std::string& text) const = 0;
  /// Puts the result into the cell, which already has failures, scores (without intervals), series
  /// and the results of the metrics before this one.
  virtual void put(CellAnalysis& cell) = 0;
};

/// The base class of a class of sums `Sums` that has parts() (sums.hpp).
template <class Sums>
class MergedSums : public MetricSums {
 public:
  void merge(MetricSums& next) final {
    merge_into(static_cast<Sums&>(*this), static_cast<Sums&>(next));
  }
  void write(SumWriter& words) const final { words.put(static_cast<const Sums&>(*this)); }
  void read(SumReader& words) final { words.get(static_cast<Sums&>(*this)); }
  void add_layout(std::string& text) const final { SumLayout<Sums>::add(text); }
};

/// A CSV file of a study.
struct TableFile {
  const char* name;
  Frame (*of)(const StudyAnalysis& study);  ///< contents; there is no file if they have no columns
};

/// A number of a result, described once: its columns in files, and its column in a table.
template <class Result>
struct ResultNumber {
  std::string name;  ///< name in files; empty: only in the table
  std::string units;
  std::function<double(const Result&)> value;
  std::string heading = {};  ///< heading in the table; empty: only in files
  /// Text of the value in the table; readable() if it is empty. It is not used beside an interval.
  std::function<std::string(double)> text = {};
  /// Interval of the value: NAME_lower and NAME_upper in files, and with_interval() in the table.
  std::function<Interval(const Result&)> interval = {};
};

/// Adds the numbers of a result to a row of a file; NaN if there is no result.
template <class Result>
void add_numbers(const std::vector<ResultNumber<Result>>& quantities, const Result* result,
                 Frame::Row& row) {
  for (const ResultNumber<Result>& one : quantities) {
    if (one.name.empty()) continue;
    row.emplace_back(one.name, one.units, result == nullptr ? kNaN : one.value(*result));
    if (!one.interval) continue;
    const Interval interval = result == nullptr ? Interval{kNaN, kNaN} : one.interval(*result);
    row.emplace_back(one.name + "_lower", one.units, interval.lower);
    row.emplace_back(one.name + "_upper", one.units, interval.upper);
  }
}

/// Adds the numbers of a result to a row of a table, with intervals at `level`.
template <class Result>
void add_entries(const std::vector<ResultNumber<Result>>& quantities, const Result& result,
                 double level, std::vector<TextTable::Entry>& row) {
  for (const ResultNumber<Result>& one : quantities) {
    if (one.heading.empty()) continue;
    if (one.interval) {
      expect(!one.text, "a number with an interval has the text of with_interval()");
      row.push_back({one.heading + " [" + level_text(level) + "]",
                     with_interval(one.value(result), one.interval(result))});
    } else {
      const double value = one.value(result);
      row.push_back({one.heading, one.text ? one.text(value) : readable(value)});
    }
  }
}

/// A function for Metric::add_numbers that adds the numbers of a result that a cell may have.
template <class Result>
auto numbers_by(const std::vector<ResultNumber<Result>>& quantities) {
  return [&quantities](const CellAnalysis& cell, Frame::Row& row) {
    add_numbers(quantities, cell.find<Result>(), row);
  };
}

template <class Sums>
std::unique_ptr<MetricSums> make_sums(const RunCriteria& criteria) {
  return std::make_unique<Sums>(criteria);
}

/// Contributions of a metric to the analysis; those that it does not make stay empty.
struct Metric {
  std::span<const Score> scores = {};            ///< scores of a run
  std::span<const ScanSeries> scan_series = {};  ///< series over the scans of a run
  /// Whether the means of the scores are written for every cell to cells.csv and HDF5.
  bool scores_are_numbers = true;
  /// Makes sums for results beyond means of scores, e.g. make_sums<MySums>; `criteria` outlive the
  /// sums.
  std::unique_ptr<MetricSums> (*sums)(const RunCriteria& criteria) = nullptr;
  /// Adds single numbers: the same names for every cell, and NaN if a number does not apply.
  std::function<void(const CellAnalysis& cell, Frame::Row& all)> add_numbers = nullptr;
  /// Adds those series over scans that apply.
  void (*add_series)(const CellAnalysis& cell, std::vector<Frame::Column>& all) = nullptr;
  /// Sections of the report, with tables and notes.
  std::vector<Section> (*sections)(const StudyAnalysis& study) = nullptr;
  /// Figures; those without data are left out.
  std::vector<Figure> (*figures)(const StudyAnalysis& study) = nullptr;
  std::vector<TableFile> files = {};
};

}  // namespace montecarta::analysis
