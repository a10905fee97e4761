// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

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

}  // namespace montecarta::experiments
