// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace montecarta::engine {

/// Values of one run of one column, empty where the column has no values.
inline std::vector<double> values_of(const ResultFile& file, const StoredCell& cell,
                                     const Column& column, std::size_t i) {
  std::vector<double> values(column.elements());
  file.read(cell, column.name, i, values);
  return values;
}

/// Compares bit by bit, so that NaN equals NaN.
inline bool same_bits(std::span<const double> a, std::span<const double> b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

/// Names a difference between the outcomes of run index `i` of `a` and `j` of `b`; empty if equal.
inline std::string difference_of_outcome(const ResultFile& a, const StoredCell& left, std::size_t i,
                                         const ResultFile& b, const StoredCell& right,
                                         std::size_t j) {
  if (a.status(left)[i] != b.status(right)[j]) return left.label + "/status";
  if (a.failure_steps(left)[i] != b.failure_steps(right)[j]) return left.label + "/failure_step";
  if (a.failure_reasons(left)[i] != b.failure_reasons(right)[j])
    return left.label + "/failure_reason";
  return "";
}

/// Names a difference between run index `i` of `a` and `j` of `b` under /cells and /truth; empty if
/// they are equal.
inline std::string difference_of_run(const ResultFile& a, std::size_t i, const ResultFile& b,
                                     std::size_t j) {
  for (std::size_t c = 0; c < a.cells().size(); ++c) {
    const StoredCell& left = a.cells()[c];
    const StoredCell& right = b.cells()[c];
    const std::string outcome = difference_of_outcome(a, left, i, b, right, j);
    if (!outcome.empty()) return outcome;
    for (const Column& column : left.columns) {
      const bool is_held = a.holds(left, column.name, i);
      if (is_held != b.holds(right, column.name, j)) return left.label + "/" + column.name;
      if (is_held && !same_bits(values_of(a, left, column, i), values_of(b, right, column, j)))
        return left.label + "/" + column.name;
    }
  }
  if (a.has_truth() != b.has_truth()) return "truth";
  if (!a.has_truth()) return "";
  std::vector<double> truth_a(3 * a.times().size());
  std::vector<double> truth_b(3 * b.times().size());
  a.read_truth(i, truth_a);
  b.read_truth(j, truth_b);
  return same_bits(truth_a, truth_b) ? "" : "truth";
}

/// Names a difference between two files of the same runs; empty if they are equal.
inline std::string difference(const ResultFile& a, const ResultFile& b) {
  if (a.runs() != b.runs()) return "runs";
  if (a.cells().size() != b.cells().size()) return "cells";
  for (std::size_t i = 0; i < a.runs().size(); ++i) {
    const std::string found = difference_of_run(a, i, b, i);
    if (!found.empty()) return "run index " + std::to_string(i) + ": " + found;
  }
  return "";
}

}  // namespace montecarta::engine
