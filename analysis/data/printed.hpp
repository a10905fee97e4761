// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace montecarta::analysis {

/// A number that a paper printed, and what of ours it is compared with.
struct PrintedValue {
  std::string cell;         ///< label
  std::string metric;       ///< one of printed_metrics()
  std::string relative_to;  ///< label of the cell it is a multiple of; empty: the number itself
  std::string printed;      ///< in the paper's digits
  std::uint64_t runs = 0;   ///< of which it is the mean; 0: as the section says
  std::string note;         ///< where it stands: "Table 1"

  double number() const;
  /// Half a unit of the last printed digit.
  double rounding() const;
};

/// Which of two cells a paper says is better, or that they are alike.
struct PrintedClaim {
  std::string metric;
  std::string left;     ///< label
  char relation = '<';  ///< '<', '>' or '~'
  std::string right;    ///< label
  std::string note;
};

/// The band that a paper drew for its average NEES.
struct PrintedBand {
  std::string error;  ///< "pose", "position" or "heading"
  double lower = 0.0;
  double upper = 0.0;
};

/// What a study repeats: section [printed] of a study file.
struct Printed {
  std::string source;      ///< which paper
  std::uint64_t runs = 0;  ///< of the paper; 0: it does not say
  std::string baseline;    ///< label of the cell without which no other number can be compared
  std::vector<PrintedBand> bands;
  std::vector<PrintedValue> values;
  std::vector<PrintedClaim> claims;
  std::vector<std::string> assumptions;  ///< what the paper leaves open, and what is taken instead

  bool empty() const { return values.empty() && claims.empty() && assumptions.empty(); }
  /// nullptr where the paper has none for this error.
  const PrintedBand* find_band(std::string_view error) const;
};

/// Adds one line `key = text` of the section. Throws StudyError, without a place, where it cannot
/// be understood. Whether cells and metrics exist is the caller's to check.
void take_printed_line(const std::string& key, const std::string& text, Printed& printed);

/// The lines that read back as this, without the section's name.
std::string printed_text(const Printed& printed);

/// The section of a resolved study, as a result file holds it; empty where there is none.
Printed printed_in(const std::string& study_text);

}  // namespace montecarta::analysis
