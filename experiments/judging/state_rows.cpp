// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/state_rows.hpp"

namespace montecarta::experiments {

StateRows read_estimates(const std::filesystem::path& path) {
  CsvRows file(path);
  const EstimateFields fields = estimate_fields(file.columns(), file.place());
  StateRows rows{fields.shape, {}, {}, {}, {}, {}};
  while (file.next()) {
    rows.time.push_back(file.time());
    rows.state.push_back(state_in(file, fields.state, fields.shape));
    rows.covariance.push_back(covariance_in(file, fields));
    if (!fields.nis) continue;
    const auto [nis, dof] = nis_in(file, fields);
    rows.nis.push_back(nis);
    rows.nis_dof.push_back(dof);
  }
  return rows;
}

std::vector<double> times_in(const std::filesystem::path& path) {
  CsvRows file(path);
  std::vector<double> times;
  while (file.next()) times.push_back(file.time());
  return times;
}

StateRows read_truth(const std::filesystem::path& path, const StateShape& shape) {
  CsvRows file(path);
  const std::vector<std::size_t> fields = truth_fields(file.columns(), shape, file.place());
  StateRows rows{shape, {}, {}, {}, {}, {}};
  while (file.next()) {
    rows.time.push_back(file.time());
    rows.state.push_back(state_in(file, fields, shape));
  }
  file.require_some();
  return rows;
}

}  // namespace montecarta::experiments
