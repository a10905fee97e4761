// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/innovation_rows.hpp"

#include "engine/errors.hpp"
#include "engine/numbers/angle.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cmath>

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
  file.refuse("no estimate in " + estimates.string() + " has time " + to_text(time) +
              " s (the nearest has " + to_text(rows.time[k]) +
              " s): give innovations the times of the estimates after them, or leave out "
              "innovations without an estimate");
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
    rows.first_unwrapped = file.place() + ": " + fields.shape.columns[k] + " " + to_text(angle);
    return;
  }
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
  const EstimateFields fields = innovation_fields(file.columns(), file.place());
  std::vector<double> nis(rows.time.size());
  std::vector<std::uint32_t> dof(rows.time.size());
  while (file.next()) {
    const double time = file.time(CsvRows::Order::not_earlier);
    const auto [row_nis, row_dof] = nis_in(file, fields);
    count_unwrapped(file, fields, rows);
    if (rows.time.empty()) continue;
    const std::size_t k = place_in(rows, time, tolerance, file, estimates);
    nis[k] += row_nis;
    dof[k] += row_dof;
  }
  rows.nis = std::move(nis);
  rows.nis_dof = std::move(dof);
}

}  // namespace montecarta::experiments
