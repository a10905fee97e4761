// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/metrics/diversity.hpp"

#include "engine/errors.hpp"

#include <numeric>

namespace montecarta::analysis {
/// Walks from resampling to resampling; between them everyone is their own parent.
std::uint32_t DiversityCounter::ancestors_before(std::size_t first, std::size_t s) {
  set_.start(particles_);
  for (std::size_t next = resampled_[s]; next > first;) {
    set_.step_back(parents(next - 1));
    next = next > 1 ? resampled_[next - 2] : 0;
  }
  return static_cast<std::uint32_t>(set_.size());
}

void DiversityCounter::count_last_resampling() {
  for (std::size_t s = 0; s < resampled_.size(); ++s) {
    auto& distinct = result_.last_resampling[s];
    if (resampled_[s] == s + 1) {
      distinct = ancestors_before(s, s);
    } else if (s > 0) {
      distinct = result_.last_resampling[s - 1];
    }
  }
}

void DiversityCounter::count_lag(std::span<const double> times) {
  std::size_t first = 0;  // the first scan later than kDiversityLag ago
  for (std::size_t s = 0; s < times.size(); ++s) {
    const std::size_t first_before = first;
    while (times[first] <= times[s] - kDiversityLag + 1e-9) ++first;
    const auto outside = [&](std::size_t f) { return f == 0 ? 0 : resampled_[f - 1]; };
    const bool same =
        s > 0 && resampled_[s] == resampled_[s - 1] && outside(first) == outside(first_before);
    result_.lag[s] = same ? result_.lag[s - 1] : ancestors_before(first, s);
  }
}

void DiversityCounter::count_root() {
  set_.start(particles_);
  root_.resize(particles_);
  std::iota(root_.begin(), root_.end(), 0u);
  for (std::size_t s = 0; s < resampled_.size(); ++s) {
    if (resampled_[s] == s + 1) {
      previous_ = root_;
      for (std::size_t i = 0; i < particles_; ++i) root_[i] = previous_[parents(s)[i]];
      set_.assign(root_);
      result_.root[s] = static_cast<std::uint32_t>(set_.size());
    } else if (s > 0) {
      result_.root[s] = result_.root[s - 1];
    }
  }
}

const Diversity& DiversityCounter::count(Row ancestor, std::size_t particles,
                                         std::span<const double> times) {
  expect(ancestor.size() == times.size() * particles, "ancestors are {scan, particle}");
  ancestor_ = ancestor;
  particles_ = particles;
  for (auto* column : {&result_.last_resampling, &result_.lag, &result_.root}) {
    column->assign(times.size(), static_cast<std::uint32_t>(particles));
  }
  find_resamplings(ancestor, particles, resampled_);
  count_last_resampling();
  count_lag(times);
  count_root();
  return result_;
}

}  // namespace montecarta::analysis
