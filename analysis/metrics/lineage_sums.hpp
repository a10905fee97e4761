// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/metrics/cell_analysis.hpp"

namespace montecarta {

/// Adds up Lineages over runs; what a run does not have is not averaged.
class LineageSums {
 public:
  void add(const Lineages& lineages);
  bool empty() const { return runs_ == 0; }
  LineageSummary result() const;

 private:
  struct Mean {
    double sum = 0.0, n = 0.0;
    void add(double value);
    double value() const { return sum / n; }
  };
  std::size_t runs_ = 0;
  std::array<Mean, kLineageLags.size()> ancestors_;
  Mean coalescence_, coalesced_, variance_, squared_error_;
};

}  // namespace montecarta
