// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_description.hpp"
#include "experiments/judging/state_rows.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The estimates of another program and their truths, which are read run by run.
class EstimateSource {
 public:
  EstimateSource(const EstimateSource&) = delete;
  EstimateSource& operator=(const EstimateSource&) = delete;
  virtual ~EstimateSource() = default;

  /// {cell} Labels of the estimators, in alphabetical order.
  virtual const std::vector<std::string>& cells() const = 0;
  /// Settings of a cell that others may not have, such as its sensor.
  virtual TextPairs settings(std::size_t /*cell*/) const { return {}; }
  /// {run} Numbers of the runs, consecutive and increasing.
  virtual const std::vector<std::uint64_t>& runs() const = 0;
  /// The file (or the array) with the estimates of a run, for messages.
  virtual std::filesystem::path place(std::size_t cell, std::size_t run) const = 0;
  virtual std::filesystem::path truth_place(std::size_t cell, std::size_t run) const = 0;

  /// {row} Times [s] of the estimates of a run.
  virtual std::vector<double> times(std::size_t cell, std::size_t run) const = 0;
  /// A state without components is that of innovations alone, which have no truth.
  virtual StateRows estimates(std::size_t cell, std::size_t run) const = 0;
  /// The truth of the estimates of a run, of states of this shape. Sources of errors are not asked.
  virtual StateRows truth(std::size_t cell, std::size_t run, const StateShape& shape) const = 0;
  /// Whether all cells have the same truth of a run, which may go on after their estimates end.
  /// Otherwise it is at the times of each cell's own.
  virtual bool has_common_truths() const = 0;
  /// Whether states are errors already, so that no convention needs to be stated.
  virtual bool has_errors() const = 0;

  /// (name, value) What identifies the contents: the same of the same estimates.
  virtual TextPairs contents() const = 0;
  /// Sentences on how the estimates were found.
  virtual std::vector<std::string> notes() const = 0;

 protected:
  EstimateSource() = default;
};

}  // namespace montecarta::experiments
