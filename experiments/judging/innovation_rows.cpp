// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/innovation_rows.hpp"

#include "analysis/metrics/nees.hpp"
#include "engine/errors.hpp"
#include "experiments/files/csv_rows.hpp"
#include "experiments/judging/state_columns.hpp"
#include "experiments/text/numbers.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// Squares and components of one row.
struct RowOfInnovations {
  double nis = 0.0;
  std::uint32_t dof = 0;
};

/// Which estimate a row belongs to.
std::size_t place_in(const StateRows& rows, double time, double tolerance, const CsvRows& file,
                     const fs::path& estimates) {
  const auto after = std::ranges::lower_bound(rows.time, time);
  auto k = static_cast<std::size_t>(after - rows.time.begin());
  if (k == rows.time.size() || (k > 0 && time - rows.time[k - 1] < rows.time[k] - time)) --k;
  if (std::abs(rows.time[k] - time) <= tolerance) return k;
  throw StudyError(file.place() + ": no estimate in " + estimates.string() + " is of time " +
                   to_text(time) + " s (the nearest is of " + to_text(rows.time[k]) +
                   " s): give innovations the times of the estimates after them, or leave out "
                   "those of scans that have none");
}

/// From the innovation itself, where the file has no NIS.
RowOfInnovations squares_of(const CsvRows& file, const EstimateFields& fields) {
  const auto d = static_cast<Eigen::Index>(fields.shape.dimension());
  Eigen::VectorXd innovation(d);
  Eigen::MatrixXd S(d, d);
  for (Eigen::Index i = 0; i < d; ++i) {
    const auto row = static_cast<std::size_t>(i);
    innovation(i) = file.number(fields.state[row], "number");
    for (Eigen::Index j = 0; j < d; ++j) {
      const auto element = static_cast<std::size_t>(i * d + j);
      S(i, j) = file.number(fields.covariance[element], "number");
    }
  }
  return {analysis::strict_nees(innovation, S), static_cast<std::uint32_t>(d)};
}

}  // namespace

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
                      StateRows& rows) {
  if (!rows.nis.empty()) {
    throw StudyError(path.string() + ": innovations, and " + estimates.string() +
                     " has nis too (which one is it?): remove one");
  }
  CsvRows file(path);
  const InnovationFields fields = innovation_fields(file.columns(), file.place());
  std::vector<double> nis(rows.time.size());
  std::vector<std::uint32_t> dof(rows.time.size());
  double before = -INFINITY;
  while (file.next()) {
    const double time = file.number(0, "time");
    if (time < before) {
      throw StudyError(file.place() + ": time " + to_text(time) +
                       " s is before that of the row above (rows go forward in time): sort them");
    }
    before = time;
    RowOfInnovations row;
    if (fields.whole) {
      row = squares_of(file, *fields.whole);
    } else {
      row.nis = file.number(fields.nis, "number");
      row.dof = checked_dof(row.nis, file.number(fields.nis_dof, "number"), file.place());
    }
    if (rows.time.empty()) continue;
    const std::size_t k = place_in(rows, time, tolerance, file, estimates);
    nis[k] += row.nis;
    dof[k] += row.dof;
  }
  rows.nis = std::move(nis);
  rows.nis_dof = std::move(dof);
}

}  // namespace montecarta::experiments
