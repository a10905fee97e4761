// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::experiments {

/// A limit of the NIS beyond which a filter leaves out an innovation.
class Gate {
 public:
  /// Reads "9", a limit for all innovations, or "99%", the value that innovations of any number of
  /// components exceed with the remaining probability. Throws StudyError that names --gate.
  explicit Gate(const std::string& text);

  const std::string& text() const { return text_; }
  /// The limit of the NIS of so many components.
  double limit(std::uint32_t components) const;
  /// The NIS that has the probability among all innovations which `nis` has among those that pass.
  /// 0 components have 0.
  double without_gate(double nis, std::uint32_t components) const;

 private:
  std::string text_;
  double limit_ = 0.0;
  double share_ = 0.0;  ///< of innovations that pass; 0: limit_ is the same for all
};

/// The gates of the sensors of a filter.
class Gates {
 public:
  /// Reads a gate, of all innovations, or those of sensors by their names: "lidar=9,gps=99%".
  /// Throws StudyError that names --gate.
  explicit Gates(std::string text);

  const std::string& text() const { return text_; }
  /// The gate of a sensor; nullopt if its innovations pass none.
  std::optional<Gate> of(const std::string& sensor) const;
  /// Throws StudyError if a gate is that of a sensor which is not among these.
  void require_sensors(const std::vector<std::string>& known) const;

 private:
  std::string text_;
  std::optional<Gate> of_all_;
  std::vector<std::pair<std::string, Gate>> of_sensors_;
};

}  // namespace montecarta::experiments
