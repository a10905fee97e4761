// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/judging/gate.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace montecarta::experiments {

/// The innovations of a sensor, which may have passed a gate, by their numbers of components.
class PassedInnovations {
 public:
  /// Adds the NIS of a row, as it is in the file. NaN and 0 components are left out.
  void add(double nis, std::uint32_t components);
  void add(const PassedInnovations& others);

  /// The limits of a gate with the numbers of rows that passed them, as a setting of a cell
  /// (analysis::GateScale): "2714 rows of 2 up to 9". Throws StudyError that names --gate if no
  /// factor can be found behind such a limit.
  std::string limits_of(const Gate& gate) const;
  /// A sentence on a gate that they seem to have passed: their largest NIS is far smaller than the
  /// largest of so many by the law that fits the others. Empty if there is no such sign. `sensor`
  /// may be empty.
  std::string sign_of_a_gate(const std::string& sensor) const;

 private:
  struct NisSum {
    std::uint64_t count = 0;
    double sum = 0.0, largest = 0.0;  ///< of the NIS
  };
  /// {number of components}
  std::map<std::uint32_t, NisSum> rows_;
};

}  // namespace montecarta::experiments
