// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/joint_nees.hpp"

#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/statistics/spread.hpp"

#include <algorithm>
#include <cstddef>

namespace montecarta::analysis {
namespace {

constexpr double kJointFamilies = 2.0;  // number of families: size and scans

}  // namespace

JointNeesSums::JointNeesSums(std::span<const double> times)
    : times_(times.begin(), times.end()), nees_(times.size()), all_dimensions_(times.size()) {}

void JointNeesSums::add(std::span<const JointScore> run) {
  if (run.empty()) return;
  ++n_runs_;
  std::vector<double> nees(times_.size(), kNaN), dimensions(times_.size());
  for (std::size_t k = 0; k < run.size(); ++k) {
    nees[k] = run[k].nees;
    dimensions[k] = static_cast<double>(run[k].dimension);
    all_dimensions_[k] += dimensions[k];
  }
  nees_.add(nees, dimensions);
}

JointConsistency JointNeesSums::result(double level, bool identities_known, double within) const {
  JointConsistency found;
  found.stored = n_runs_ > 0;
  if (!found.stored) return found;
  if (!identities_known) {
    found.missing = "nobody knows which landmark is which";
    return found;
  }
  found.verdict = judge(nees_.families(level, times_), level, within, n_runs_);
  const auto judged = std::ranges::count_if(
      nees_.scans(), [](const SummedError::Scan& row) { return row.dimensions > 0.0; });
  const double of_each = 1.0 - (1.0 - level) / (kJointFamilies * static_cast<double>(judged));
  for (std::size_t k = 0; k < times_.size(); ++k) {
    const SummedError::Scan& row = nees_.scans()[k];
    const bool is_defined = row.n() > 0.0;
    found.samples += n_runs_;
    found.undefined += n_runs_ - static_cast<std::uint64_t>(row.n());
    found.runs.push_back(static_cast<std::uint32_t>(row.n()));
    found.dimension.push_back(all_dimensions_[k] / static_cast<double>(n_runs_));
    found.average.push_back(row.ratio());
    found.bounds.push_back({kNaN, kNaN});
    if (!is_defined) continue;
    found.bounds.back() = nees_bounds(static_cast<std::uint64_t>(row.dimensions), 1, of_each);
  }
  return found;
}

}  // namespace montecarta::analysis
