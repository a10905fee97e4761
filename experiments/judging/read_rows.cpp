// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/read_rows.hpp"

#include "analysis/run/nees.hpp"

namespace montecarta::experiments {
namespace {

void remove_last(StateRows& rows) {
  rows.time.pop_back();
  rows.line.pop_back();
  if (!rows.state.empty()) rows.state.pop_back();
  if (!rows.covariance.empty()) rows.covariance.pop_back();
  if (rows.nis.empty()) return;
  rows.nis.pop_back();
  rows.nis_dof.pop_back();
}

/// Adds time and line of the current row, instead of those of a row that is not kept. Returns
/// whether the current row is kept.
bool take_time(CsvRows& file, EqualTimes equal, StateRows& rows) {
  const double time = file.time(CsvRows::Order::not_earlier);
  if (!rows.time.empty() && time == rows.time.back()) {
    if (equal == EqualTimes::refuse) {
      file.refuse_equal_times("keep one of the rows by --keep last or --keep first");
    }
    ++rows.left_out;
    if (equal == EqualTimes::keep_first) return false;
    remove_last(rows);
  }
  rows.time.push_back(time);
  rows.line.push_back(file.line());
  return true;
}

}  // namespace

StateRows read_estimates(const std::filesystem::path& path, EqualTimes equal) {
  CsvRows file(path);
  const EstimateFields fields = estimate_fields(file.columns(), file.place());
  StateRows rows{.shape = fields.shape, .uncorrelated = fields.uncorrelated};
  while (file.next()) {
    if (!take_time(file, equal, rows)) continue;
    rows.state.push_back(state_in(file, fields.state, fields.shape));
    rows.covariance.push_back(covariance_in(file, fields));
    if (!fields.nis) continue;
    const auto [nis, dof] = nis_in(file, fields);
    rows.nis.push_back(nis);
    rows.nis_dof.push_back(dof);
  }
  return rows;
}

std::vector<double> times_in(const std::filesystem::path& path, EqualTimes equal) {
  CsvRows file(path);
  StateRows kept;
  while (file.next()) take_time(file, equal, kept);
  return kept.time;
}

StateRows read_truth(const std::filesystem::path& path, const StateShape& shape,
                     const TruthReading& how) {
  CsvRows file(path);
  const EstimateFields fields =
      truth_fields(file.columns(), shape, file.place(), how.prefix, how.with_covariance);
  StateRows rows{shape, {}, {}, {}, {}, {}};
  while (file.next()) {
    if (!take_time(file, how.equal, rows)) continue;
    rows.state.push_back(state_in(file, fields.state, shape));
    if (!how.with_covariance) continue;
    rows.covariance.push_back(covariance_in(file, fields));
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(rows.covariance.back().rows());
    if (!analysis::imported_nees(none, rows.covariance.back()).is_usable()) {
      file.refuse("the covariance of the truth is not symmetric or not positive semidefinite (it " +
                  std::string("is added to that of the estimate): correct it"));
    }
  }
  if (how.prefix.empty())
    file.require_some();  // else it is in the file of a run, which may have failed
  return rows;
}

}  // namespace montecarta::experiments
