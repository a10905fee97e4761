// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/estimate_files.hpp"
#include "experiments/judging/gate.hpp"
#include "experiments/judging/passed_innovations.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// Innovations alone in CSV files, one for each run, without states and truths. Their columns are
/// those of read_innovations(). If they name several sensors, each is a cell, called CELL.SENSOR.
class InnovationFiles final : public EstimateFiles {
 public:
  /// `gates` are those of the filter. Throws StudyError if one is that of an unknown sensor.
  InnovationFiles(JudgedFiles files, const std::optional<Gates>& gates);

  const std::vector<std::string>& cells() const override { return labels_; }
  TextPairs settings(std::size_t cell) const override { return parts_[cell].settings; }
  std::filesystem::path place(std::size_t cell, std::size_t run) const override {
    return EstimateFiles::place(parts_[cell].files, run);
  }
  /// The times of the file; rows of one time are one scan.
  std::vector<double> times(std::size_t cell, std::size_t run) const override;
  /// Rows whose states are the innovations if their components are known, and else rows without a
  /// state.
  StateRows estimates(std::size_t cell, std::size_t run) const override;
  bool has_common_truths() const override { return false; }
  bool has_errors() const override { return true; }
  std::vector<std::string> notes() const override;

 private:
  using Sensors = std::map<std::string, PassedInnovations>;
  /// The innovations of one cell.
  struct Part {
    std::size_t files;   ///< index of the cell whose files it is read from
    std::string sensor;  ///< empty if the files name at most one
    std::optional<Gate> gate;
    TextPairs settings;
  };
  /// The innovations of all runs of an estimator.
  Sensors innovations_of(std::size_t files) const;
  void add_parts(std::size_t files, const Sensors& sensors, const std::optional<Gates>& gates);

  std::vector<std::string> labels_;  ///< {cell}
  std::vector<Part> parts_;          ///< {cell}
  std::vector<std::string> signs_of_gates_;
};

}  // namespace montecarta::experiments
