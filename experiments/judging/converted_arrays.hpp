// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/files/passing_folder.hpp"

#include <filesystem>
#include <string>

namespace montecarta::experiments {

/// The extension of a file's name in small letters, such as ".npz".
std::string extension_of(const std::filesystem::path& path);

/// Whether a file is called like arrays of NumPy (.npz), or is one of MATLAB (.mat). A .mat that
/// another program wrote as HDF5 is none of MATLAB: its axes are not turned round.
bool are_foreign_arrays(const std::filesystem::path& path);

/// The arrays of NumPy or MATLAB as an HDF5 file among temporary files, which is removed in the
/// end.
class ConvertedArrays {
 public:
  /// Calls the script that converts them, and says so on stderr. Throws StudyError with its words
  /// if it cannot, and if Python or one of its modules is missing, with what to install.
  explicit ConvertedArrays(const std::filesystem::path& arrays);
  const std::filesystem::path& path() const { return path_; }

 private:
  PassingFolder folder_;
  std::filesystem::path path_;
};

}  // namespace montecarta::experiments
