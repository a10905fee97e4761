// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace montecarta::analysis {

/// Runs gnuplot on the script `name` in `directory`, which is its working directory. Throws
/// StudyError where gnuplot is not installed and RunError, with what it says, where it fails.
/// `program` is looked up in PATH.
void run_gnuplot(const std::filesystem::path& directory, const std::string& name,
                 const std::string& program = "gnuplot");

/// A text constant of gnuplot: quoted, printed as it stands.
std::string gnuplot_quoted(const std::string& text);

}  // namespace montecarta::analysis
