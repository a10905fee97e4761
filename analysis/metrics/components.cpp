// SPDX-License-Identifier: BSD-3-Clause
// Estimates of another program: errors and deviations of each component, in the convention of the
// error that the user stated.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <tuple>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

/// Root mean squares, in the units of the components, over the runs and scans that have a NEES.
struct ComponentErrors {
  std::vector<double> error;      ///< {component} RMS error
  std::vector<double> deviation;  ///< {component} RMS deviation that the other program reports
};

class ComponentsOverRuns final : public MergedSums<ComponentsOverRuns> {
 public:
  explicit ComponentsOverRuns(const RunCriteria& /*criteria*/) {}
  void add(const MeasuredRun& run) override {
    const ErrorRows& rows = run.rows.error;
    if (rows.components() == 0) return;
    const std::vector<double>& nees = run.metrics.nees(Moments::spread).value[0];
    squares_.resize(rows.components());
    variances_.resize(rows.components());
    for (std::size_t s = 0; s < rows.scans(); ++s) {
      if (std::isnan(nees[s])) continue;
      add(rows.error(s), rows.covariance_of(s));
    }
  }
  void put(CellAnalysis& cell) override {
    if (squares_.empty()) return;
    const auto root = [&](double sum) { return std::sqrt(sum / samples_); };
    ComponentErrors found;
    std::ranges::transform(squares_, std::back_inserter(found.error), root);
    std::ranges::transform(variances_, std::back_inserter(found.deviation), root);
    cell.findings.put(std::move(found));
  }
  static constexpr auto parts() {
    using Sums = ComponentsOverRuns;
    return std::tuple(added(&Sums::squares_, &Sums::variances_, &Sums::samples_));
  }

 private:
  void add(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
    for (std::size_t c = 0; c < squares_.size(); ++c) {
      const auto i = static_cast<Eigen::Index>(c);
      squares_[c] += error(i) * error(i);
      variances_[c] += covariance(i, i);
    }
    samples_ += 1.0;
  }

  /// {component} sums of squared errors and of reported variances.
  std::vector<double> squares_, variances_;
  double samples_ = 0.0;
};

TextTable component_table(const StudyAnalysis& study) {
  TextTable table;
  for (const CellAnalysis& cell : study.cells) {
    const ComponentErrors& found = cell.get<ComponentErrors>();
    const std::size_t named =
        std::min(study.imported.components.size(), study.imported.units.size());
    for (std::size_t c = 0; c < std::min(found.error.size(), named); ++c) {
      table.add({{"cell", cell.label, Align::left},
                 {"component", study.imported.components[c], Align::left},
                 {"unit", study.imported.units[c], Align::left},
                 {"RMS error", readable(found.error[c])},
                 {"RMS sigma", readable(found.deviation[c])},
                 {"ratio", readable(found.error[c] / found.deviation[c])}});
    }
  }
  return table;
}

std::vector<Section> imported_sections(const StudyAnalysis& study) {
  if (!study.imported.is_imported()) return {};
  const CellNumber largest = [](const CellAnalysis& cell) {
    const ComponentErrors& found = cell.get<ComponentErrors>();
    double ratio = kNaN;
    for (std::size_t c = 0; c < found.error.size(); ++c) {
      ratio = std::fmax(ratio, found.error[c] / found.deviation[c]);
    }
    return ratio;
  };
  Section section = section_of("components", {{"ratio", range_over_cells(study, largest)}});
  section.add("components", component_table(study));
  section.add_notes("notes", {{"convention", study.imported.convention}});
  return {section};
}

}  // namespace

Metric components_metric() {
  return {.sums = make_sums<ComponentsOverRuns>, .sections = imported_sections};
}

}  // namespace montecarta::analysis
