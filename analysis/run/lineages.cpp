// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/run/lineages.hpp"

#include "analysis/statistics/spread.hpp"
#include "engine/errors.hpp"

#include <cmath>
#include <string>

namespace montecarta::analysis {
namespace {

constexpr std::size_t kMostScansOfLineages = 32;

constexpr double kSameTime = 1e-9;

/// Throws RunError where a parent does not exist.
void expect_parents(std::span<const std::uint32_t> parents) {
  std::uint32_t largest = 0;
  for (const std::uint32_t parent : parents) largest = std::max(largest, parent);
  if (largest < parents.size()) return;
  throw RunError("ancestor: parent {} of {} particles (the column is damaged): run the study again",
                 largest, parents.size());
}

}  // namespace

void find_resamplings(std::span<const std::uint32_t> ancestor, std::size_t particles,
                      std::vector<std::size_t>& resampled) {
  resampled.resize(particles == 0 ? 0 : ancestor.size() / particles);
  std::vector<std::uint32_t> themselves(particles);
  std::iota(themselves.begin(), themselves.end(), 0u);
  std::size_t latest = 0;
  for (std::size_t s = 0; s < resampled.size(); ++s) {
    const auto parents = ancestor.subspan(s * particles, particles);
    if (!std::ranges::equal(parents, themselves)) {
      expect_parents(parents);
      latest = s + 1;
    }
    resampled[s] = latest;
  }
}

struct LineageWalker::Sums {
  std::array<SummaryOf, kLineageLags.size()> ancestors;
  SummaryOf coalescence, coalesced, variance, squared_error;
};

/// Estimates the variance that comes from few particles at scan `s`. `ancestor_` assigns every
/// particle to the family of its ancestor.
double LineageWalker::family_variance(const RunRows& rows, std::size_t s) {
  const std::size_t particles = ancestor_.size();
  const double* const pose = rows.particle_pose.data() + 3 * particles * s;
  const double* const log_weight = rows.log_weight.data() + particles * s;
  double x = 0.0, y = 0.0;
  for (std::size_t i = 0; i < particles; ++i) {
    x += std::exp(log_weight[i]) * pose[3 * i];
    y += std::exp(log_weight[i]) * pose[3 * i + 1];
  }
  families_.assign(2 * particles, 0.0);
  for (std::size_t i = 0; i < particles; ++i) {
    const double weight = std::exp(log_weight[i]);
    families_[2 * ancestor_[i]] += weight * (pose[3 * i] - x);
    families_[2 * ancestor_[i] + 1] += weight * (pose[3 * i + 1] - y);
  }
  return std::inner_product(families_.begin(), families_.end(), families_.begin(), 0.0);
}

/// Walks from resampling to resampling; between them every particle is its own parent.
void LineageWalker::walk_from(std::size_t s, const RunRows& rows,
                              std::span<const std::size_t> resampled, std::span<const double> times,
                              Sums& sums) {
  const std::size_t particles = ancestor_.size();
  bool is_before_family_lag = !rows.particle_pose.empty();
  set_.start(particles);
  std::iota(ancestor_.begin(), ancestor_.end(), 0u);
  std::size_t lag = 0;
  const auto count_until = [&](double back) {
    for (; lag < kLineageLags.size() && back >= kLineageLags[lag]; ++lag) {
      sums.ancestors[lag].add(static_cast<double>(set_.size()));
    }
    if (!is_before_family_lag || back < kDiversityLag) return;
    is_before_family_lag = false;
    if (set_.size() > 1) sums.variance.add(family_variance(rows, s));
  };
  for (std::size_t next = resampled[s]; next > 0 && set_.size() > 1;) {
    const std::size_t scan = next - 1;
    count_until(times[s] - times[scan] + kSameTime);
    const std::span parents(rows.ancestor.data() + particles * scan, particles);
    set_.step_back(parents);
    if (is_before_family_lag) {
      for (std::uint32_t& ancestor : ancestor_) ancestor = parents[ancestor];
    }
    next = scan > 0 ? resampled[scan - 1] : 0;
    if (set_.size() > 1) continue;
    sums.coalescence.add(times[s] - (scan == 0 ? 0.0 : times[scan - 1]) + kSameTime);
  }
  sums.coalesced.add(set_.size() == 1 ? 1.0 : 0.0);
  // If one ancestor is left, it is left at every longer lag of the run too.
  count_until(times[s] + kSameTime);
}

Lineages LineageWalker::walk(const RunRows& rows, std::span<const std::size_t> resampled,
                             std::span<const double> times,
                             std::span<const double> squared_position) {
  ancestor_.resize(rows.ancestor.size() / times.size());
  Sums sums;
  const std::size_t every = (times.size() + kMostScansOfLineages - 1) / kMostScansOfLineages;
  for (std::size_t s = every - 1; s < times.size(); s += every) {
    walk_from(s, rows, resampled, times, sums);
    if (!squared_position.empty()) sums.squared_error.add(squared_position[s]);
  }
  Lineages lineages;
  for (std::size_t lag = 0; lag < kLineageLags.size(); ++lag) {
    lineages.ancestors[lag] = sums.ancestors[lag].result().mean;
  }
  lineages.coalescence = sums.coalescence.result().mean;
  lineages.coalesced_share = sums.coalesced.result().mean;
  lineages.monte_carlo_variance = sums.variance.result().mean;
  lineages.squared_error = sums.squared_error.result().mean;
  return lineages;
}

/// Walks from resampling to resampling until one ancestor is left; between them every particle is
/// its own parent.
void DiversityCounter::walk_back(std::size_t first, std::size_t s) {
  path_.clear();
  set_.start(particles_);
  for (std::size_t next = s + 1; next > first && set_.size() > 1;) {
    set_.step_back(parents(next - 1));
    path_.push_back({next - 1, static_cast<std::uint32_t>(set_.size())});
    next = next > 1 ? resampled_[next - 2] : 0;
  }
}

void DiversityCounter::count_back(std::span<const double> times) {
  auto all = static_cast<std::uint32_t>(particles_), last = all;
  path_.clear();
  std::size_t first = 0;  // the first scan later than kDiversityLag ago
  for (std::size_t s = 0; s < times.size(); ++s) {
    while (times[first] <= times[s] - kDiversityLag + 1e-9) ++first;
    if (resampled_[s] == s + 1) {
      walk_back(first, s);
      last = path_.front().ancestors;
    }
    while (!path_.empty() && path_.back().scan < first) path_.pop_back();
    result_.last_resampling[s] = last;
    result_.lag[s] = path_.empty() ? all : path_.back().ancestors;
  }
}

void DiversityCounter::count_root() {
  set_.start(particles_);
  root_.resize(particles_);
  std::iota(root_.begin(), root_.end(), 0u);
  for (std::size_t s = 0; s < resampled_.size(); ++s) {
    if (resampled_[s] == s + 1 && set_.size() > 1) {
      previous_ = root_;
      for (std::size_t i = 0; i < particles_; ++i) root_[i] = previous_[parents(s)[i]];
      set_.assign(root_);
    }
    result_.root[s] = static_cast<std::uint32_t>(set_.size());
  }
}

const Diversity& DiversityCounter::count(Row ancestor, std::size_t particles,
                                         std::span<const double> times) {
  expect(ancestor.size() == times.size() * particles, "ancestors are {scan, particle}");
  ancestor_ = ancestor;
  particles_ = particles;
  for (auto* column : {&result_.last_resampling, &result_.lag, &result_.root}) {
    column->resize(times.size());
  }
  find_resamplings(ancestor, particles, resampled_);
  count_back(times);
  count_root();
  return result_;
}

}  // namespace montecarta::analysis
