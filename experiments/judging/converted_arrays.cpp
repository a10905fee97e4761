// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/converted_arrays.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/h5.hpp"
#include "engine/text/shell_command.hpp"
#include "engine/text/visible_text.hpp"
#include "experiments/files/files.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>
#include <string_view>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScript = "arrays.py";

/// The Python of the user, or that of the system, whichever has the modules; the second one says
/// what is missing.
constexpr const char* kChoosePython =
    "for python in python3 /usr/bin/python3; do"
    " $python -c 'import numpy, scipy, h5py' 2>/dev/null && break; done; exec $python ";

/// Whether MATLAB wrote a file, of version 5 to 7.3: its first bytes say so.
bool is_of_matlab(const fs::path& path) {
  constexpr std::string_view kFirst = "MATLAB ";
  std::string first(kFirst.size(), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  return file && first == kFirst;
}

fs::path script() {
  if (const std::optional<fs::path> found = shipped_file("convert", kScript)) return *found;
  throw StudyError(
      "convert/{}: not part of this installation (it converts .npz and .mat): take the folder "
      "experiments/convert of the sources",
      kScript);
}

}  // namespace

std::string extension_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  return extension;
}

bool are_foreign_arrays(const fs::path& path) {
  const std::string extension = extension_of(path);
  if (extension == ".npz") return true;
  return extension == ".mat" && (is_of_matlab(path) || !h5::is_hdf5(path.string()));
}

ConvertedArrays::ConvertedArrays(const fs::path& arrays) : path_(folder_.path() / "arrays.h5") {
  const std::string by = script().string();
  const CommandOutcome outcome =
      run_command(std::string(kChoosePython) + shell_quoted(by) + " " +
                      shell_quoted(arrays.string()) + " " + shell_quoted(path_.string()) + " 2>&1",
                  "python3");
  if (outcome.exit_code == CommandOutcome::kNotFound) {
    throw StudyError(
        "{}: python3 is not found (a script converts .npz and .mat): install it with NumPy, SciPy "
        "and h5py, on Debian with 'apt-get install python3-scipy python3-h5py', or write the "
        "arrays to an HDF5 file",
        arrays);
  }
  if (!outcome.has_succeeded()) {
    std::string words = outcome.last_line();
    const std::string name = std::string(kScript) + ": ";
    if (words.starts_with(name)) words.erase(0, name.size());
    throw StudyError(words.starts_with(arrays.string()) ? words : arrays.string() + ": " + words);
  }
  std::cerr << "montecarta: " << visible(arrays.string()) << " was converted by " << by << "\n";
}

}  // namespace montecarta::experiments
