// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/csv_file.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {

/// One number under the name it has in files.
struct NamedNumber {
  std::string name;
  std::string units;  ///< UDUNITS style, "1" where there is none
  double value = 0.0;
};

/// A number of every scan, under the name it has in files.
struct NamedSeries {
  std::string name;   ///< e.g. "anees_pose_mixture"
  std::string units;  ///< UDUNITS style, "1" where there is none
  std::vector<double> values;
};

/// The unit belongs to the name where there is one: position_rmse_mean [m].
std::string heading(const std::string& name, const std::string& units);

/// A CSV file of rows that begin with texts and go on with numbers, all under names: the first row
/// gives the headings, and every row has the same ones.
class NamedRows {
 public:
  explicit NamedRows(const std::filesystem::path& path) : file_(path) {}
  /// `texts` are (name, text).
  void row(const std::vector<std::pair<std::string, std::string>>& texts,
           const std::vector<NamedNumber>& numbers);
  /// Throws RunError where the disk did not take it all.
  void close() { file_.close(); }

 private:
  CsvFile file_;
  bool is_headed_ = false;
};

}  // namespace montecarta::analysis
