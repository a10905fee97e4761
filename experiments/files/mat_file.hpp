// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace montecarta::experiments {

/// The variables of a MATLAB file of level 5 (MATLAB 5 to 7, `save -v6` or `-v7`), compressed or
/// not, as MATLAB, Octave and SciPy write it on today's machines (little-endian). Read here and not
/// by matio, which takes gigabytes for a file of a hundred bytes whose name length is damaged.
/// [mat5] MathWorks, "MAT-File Format", chapter 1.
class MatFile {
 public:
  /// Throws StudyError where the file is missing, damaged or of another kind.
  explicit MatFile(const std::filesystem::path& path);

  bool has(const std::string& name) const { return matrices_.contains(name); }
  /// A real matrix of numbers of any class, as doubles. Throws StudyError where there is none of
  /// that name.
  const Eigen::MatrixXd& matrix(const std::string& name) const;
  /// Likewise one row or one column.
  std::vector<double> series(const std::string& name) const;
  /// The path, for errors.
  const std::string& place() const { return place_; }

 private:
  std::string place_;
  std::map<std::string, Eigen::MatrixXd> matrices_;
};

}  // namespace montecarta::experiments
