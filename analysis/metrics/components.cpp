// SPDX-License-Identifier: BSD-3-Clause
// Estimates of another program: errors and deviations of each component, in the convention of the
// error that the user stated.
#include "analysis/run/measured_run.hpp"
#include "analysis/study/cell_report.hpp"
#include "analysis/verdict/gate_scale.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
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

/// Ratio of the RMS error of a component to its RMS deviation; NaN if the deviation is 0, and of
/// innovations that passed a gate, where how much of one component passes depends on the others.
double ratio_of(const CellAnalysis& cell, std::size_t component) {
  if (cell.find<GateScale>() != nullptr) return kNaN;
  const ComponentErrors& found = cell.get<ComponentErrors>();
  const double deviation = found.deviation[component];
  return deviation > 0.0 ? found.error[component] / deviation : kNaN;
}

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
    ComponentErrors found;
    for (std::size_t c = 0; c < squares_.size(); ++c) {
      found.error.push_back(std::sqrt(squares_[c] / samples_));
      found.deviation.push_back(std::sqrt(variances_[c] / samples_ / kScale));
    }
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
      variances_[c] += kScale * covariance(i, i);
    }
    samples_ += 1.0;
  }

  /// Factor of variances, so that sums of the largest numbers are finite.
  static constexpr double kScale = 0x1p-64;

  /// {component} sums of squared errors and of scaled reported variances.
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
                 {"ratio", readable(ratio_of(cell, c))}});
    }
  }
  return table;
}

std::vector<Section> imported_sections(const StudyAnalysis& study) {
  if (!study.imported.is_imported() || !study.has_truth) return {};
  const CellNumber largest = [](const CellAnalysis& cell) {
    double ratio = kNaN;
    for (std::size_t c = 0; c < cell.get<ComponentErrors>().error.size(); ++c) {
      ratio = std::fmax(ratio, ratio_of(cell, c));
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
