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

/// Adds up the complete runs of one cell, or of a block of them, in the order of the calls.
class MetricSums {
 public:
  virtual ~MetricSums() = default;
  virtual void add(const MeasuredRun& run) = 0;
  /// Adds the sums of the same metric over the runs that follow these, which are used up.
  virtual void merge(MetricSums& next) = 0;
  /// The sums as words (sums.hpp), and their layout.
  virtual void write(SumWriter& words) const = 0;
  virtual void read(SumReader& words) = 0;
  virtual void add_layout(std::string& text) const = 0;
  /// Puts the result into the cell, which already has failures, scores (without intervals), series
  /// and the results of the metrics before this one.
  virtual void put(CellAnalysis& cell) = 0;
};

/// The base class of `Sums`, which has parts() (sums.hpp).
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
  Frame (*of)(const StudyAnalysis& study);  ///< without columns: there is no file
};

/// A number of a result, described once: its columns in files, and its column in a table.
template <class Result>
struct ResultNumber {
  std::string name;  ///< in files; empty: in the table alone
  std::string units;
  std::function<double(const Result&)> value;
  std::string heading = {};  ///< of the table; empty: in files alone
  /// Text of the value in the table; empty: readable(). Not beside an interval.
  std::function<std::string(double)> text = {};
  /// Of the value: NAME_lower and NAME_upper in files, and with_interval() in the table.
  std::function<Interval(const Result&)> interval = {};
};

/// Adds them to a row of a file; NaN where there is no result.
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

/// Adds them to a row of a table, with intervals at `level`.
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

/// Metric::add_numbers of the quantities of a result that a cell may have.
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

/// Contributions of a metric; members that it does not need stay empty.
struct Metric {
  std::span<const Score> scores = {};            ///< of a run
  std::span<const ScanSeries> scan_series = {};  ///< of every scan of a run
  /// Whether the means of the scores are written for every cell to cells.csv and HDF5.
  bool scores_are_numbers = true;
  /// Sums for results beyond means of scores, e.g. make_sums<MySums>; `criteria` outlive the sums.
  std::unique_ptr<MetricSums> (*sums)(const RunCriteria& criteria) = nullptr;
  /// Adds single numbers: the same names for every cell, NaN where a number does not apply.
  std::function<void(const CellAnalysis& cell, Frame::Row& all)> add_numbers = nullptr;
  /// Adds series over scans; those that do not apply are absent.
  void (*add_series)(const CellAnalysis& cell, std::vector<Frame::Column>& all) = nullptr;
  /// Sections of the report, with tables and notes.
  std::vector<Section> (*sections)(const StudyAnalysis& study) = nullptr;
  /// Figures; those without data are left out.
  std::vector<Figure> (*figures)(const StudyAnalysis& study) = nullptr;
  std::vector<TableFile> files = {};
};

}  // namespace montecarta::analysis
