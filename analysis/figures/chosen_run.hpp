// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/records/result_file.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace montecarta::analysis {

/// Index in the file of the run that is shown: `run`, or else the first that is complete in every
/// cell, else in most; none where no cell is complete. Throws StudyError where the file does not
/// hold `run`.
std::optional<std::size_t> chosen_run(const ResultFile& file, std::optional<std::uint64_t> run);

}  // namespace montecarta::analysis
