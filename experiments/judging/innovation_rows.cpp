// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/innovation_rows.hpp"

#include "analysis/statistics/distributions.hpp"
#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/numbers/angle.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// Index of the estimate to which a row of innovations belongs.
std::size_t place_in(const StateRows& rows, double time, double tolerance, const CsvRows& file,
                     const fs::path& estimates) {
  const auto after = std::ranges::lower_bound(rows.time, time);
  auto k = static_cast<std::size_t>(after - rows.time.begin());
  if (k == rows.time.size() || (k > 0 && time - rows.time[k - 1] < rows.time[k] - time)) --k;
  if (std::abs(rows.time[k] - time) <= tolerance) return k;
  file.refuse(
      formatted("no estimate in {} has time {} s (the nearest has {} s): give innovations the "
                "times of the estimates after them, or leave out innovations without an estimate",
                estimates, to_text(time), to_text(rows.time[k])));
}

/// Counts a row of innovations if one of them is an angle beyond pi.
void count_unwrapped(const CsvRows& file, const EstimateFields& fields, StateRows& rows) {
  if (fields.nis) return;
  constexpr double kMost = kPi * (1.0 + 1e-6);  // pi itself may be printed with few digits
  for (std::size_t k = 0; k < fields.state.size(); ++k) {
    if (!is_angle(fields.shape, static_cast<Eigen::Index>(k))) continue;
    const double angle = file.number(fields.state[k], "number");
    if (std::abs(angle) <= kMost) continue;
    if (rows.unwrapped_innovations++ > 0) return;
    rows.first_unwrapped =
        formatted("{}: {} {}", file.place(), fields.shape.columns[k], to_text(angle));
    return;
  }
}

bool is_of_sensor(const CsvRows& file, const EstimateFields& fields, const std::string& sensor) {
  return sensor.empty() || (fields.sensor && file.field(*fields.sensor) == sensor);
}

/// Throws StudyError if a sensor lacks a component that another one has.
void require_components(const CsvRows& file, const EstimateFields& fields) {
  if (!fields.sensor || fields.nis) return;
  for (std::size_t k = 0; k < fields.state.size(); ++k) {
    if (!file.field(fields.state[k]).empty()) continue;
    file.refuse(
        formatted("sensor {} has no {} (the sensors of a file have the same components): give each "
                  "sensor files of its own, or write time_s,sensor,nis,nis_dof",
                  file.field(*fields.sensor), fields.shape.columns[k]));
  }
}

/// The NIS of a row, as it would be without the gate.
double without_gate(const CsvRows& file, const EstimateFields& fields, double nis,
                    std::uint32_t dof, const std::optional<Gate>& gate) {
  if (!gate) return nis;
  if (dof > 0 && nis > gate->limit(dof) * (1.0 + analysis::kRoundingOfGate)) {
    const std::string limit = gate->text();
    if (!fields.sensor) {
      file.refuse(
          formatted("a NIS of {} is beyond --gate {} (which the filter leaves out): leave "
                    "it out, or give the gate that it has",
                    to_text(nis), limit));
    }
    const std::string sensor(file.field(*fields.sensor));
    file.refuse(formatted(
        "sensor {0} has a NIS of {1}, beyond its --gate {2} (which the filter leaves out): leave "
        "the row out, give the gate that {0} has, or, if it has none, name those that have one: "
        "--gate SENSOR={2}",
        sensor, to_text(nis), limit));
  }
  return gate->without_gate(nis, dof);
}

/// Sums of the innovations of each estimate.
class InnovationsOfRows {
 public:
  InnovationsOfRows(std::size_t rows, const StateShape& shape)
      : shape_(shape), count_(rows), line_(rows), sum_(rows), covariance_(rows) {
    shape_.kind = StateKind::vector;
    shape_.wraps = false;
    shape_.columns = shape_.components;
  }
  /// Adds the current row, scaled by `factor`, to those of estimate `k`.
  void add(const CsvRows& file, const EstimateFields& fields, std::size_t k, double factor) {
    const Eigen::VectorXd one = factor * state_in(file, fields.state, fields.shape);
    const Eigen::MatrixXd P = covariance_in(file, fields);
    if (count_[k]++ == 0) {
      line_[k] = file.line();
      sum_[k] = one;
      covariance_[k] = P;
    } else {
      sum_[k] += one;
      covariance_[k] += P;
    }
  }
  /// Fills the states of `rows`, of which those without an innovation go.
  void put(StateRows& rows) const {
    StateRows kept{.shape = shape_};
    for (std::size_t k = 0; k < count_.size(); ++k) {
      if (count_[k] == 0.0) continue;
      kept.time.push_back(rows.time[k]);
      kept.line.push_back(line_[k]);
      kept.nis.push_back(rows.nis[k]);
      kept.nis_dof.push_back(rows.nis_dof[k]);
      kept.state.emplace_back(sum_[k] / std::sqrt(count_[k]));
      kept.covariance.emplace_back(covariance_[k] / count_[k]);
    }
    kept.uncorrelated = rows.uncorrelated;
    kept.unwrapped_innovations = rows.unwrapped_innovations;
    kept.first_unwrapped = rows.first_unwrapped;
    rows = std::move(kept);
  }

 private:
  StateShape shape_;
  std::vector<double> count_;        ///< {row}
  std::vector<std::uint64_t> line_;  ///< {row} line of its first innovation
  std::vector<Eigen::VectorXd> sum_;
  std::vector<Eigen::MatrixXd> covariance_;
};

}  // namespace

std::map<std::string, PassedInnovations> innovations_in(const fs::path& path) {
  CsvRows file(path);
  const EstimateFields fields = innovation_fields(file.columns(), file.place());
  std::map<std::string, PassedInnovations> sensors;
  while (file.next()) {
    const std::string sensor(fields.sensor ? file.field(*fields.sensor) : "");
    if (fields.sensor && sensor.empty()) {
      file.refuse("no sensor (the column names it): write its name");
    }
    require_components(file, fields);
    const auto [nis, dof] = nis_in(file, fields);
    sensors[sensor].add(nis, dof);
  }
  return sensors;
}

std::optional<fs::path> innovations_beside(const fs::path& estimates) {
  const std::string wanted = "estimate";
  std::string name = estimates.filename().string();
  const std::size_t at = name.rfind(wanted);
  if (at == std::string::npos) return std::nullopt;
  name.replace(at, wanted.size(), "innovation");
  fs::path beside = estimates.parent_path() / fs::path(name).replace_extension(".csv");
  std::error_code ignored;
  if (!fs::is_regular_file(beside, ignored)) return std::nullopt;
  return beside;
}

void read_innovations(const fs::path& path, const fs::path& estimates, double tolerance,
                      StateRows& rows, const InnovationChoice& choice) {
  if (!rows.nis.empty()) {
    throw StudyError("{}: innovations, and {} has nis too (which one is it?): remove one", path,
                     estimates);
  }
  CsvRows file(path);
  const EstimateFields fields = innovation_fields(file.columns(), file.place());
  const bool has_components = choice.with_components && !fields.nis;
  InnovationsOfRows components(has_components ? rows.time.size() : 0, fields.shape);
  std::vector<double> nis(rows.time.size());
  std::vector<std::uint32_t> dof(rows.time.size());
  while (file.next()) {
    const double time = file.time(CsvRows::Order::not_earlier);
    if (!is_of_sensor(file, fields, choice.sensor)) continue;
    require_components(file, fields);
    const auto [as_given, row_dof] = nis_in(file, fields);
    const double row_nis = without_gate(file, fields, as_given, row_dof, choice.gate);
    count_unwrapped(file, fields, rows);
    if (rows.time.empty()) continue;
    const std::size_t k = place_in(rows, time, tolerance, file, estimates);
    nis[k] += row_nis;
    dof[k] += row_dof;
    if (has_components) {
      const double factor = as_given > 0.0 ? std::sqrt(row_nis / as_given) : 1.0;
      components.add(file, fields, k, factor);
    }
  }
  rows.nis = std::move(nis);
  rows.nis_dof = std::move(dof);
  rows.uncorrelated = fields.uncorrelated;
  if (has_components) components.put(rows);
}

}  // namespace montecarta::experiments
