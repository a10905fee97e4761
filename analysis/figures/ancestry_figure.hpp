// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/output/figure.hpp"
#include "engine/records/result_file.hpp"

#include <cstdint>
#include <optional>

namespace montecarta::analysis {

/// Where the particles at the end of one run come from, cell by cell: the run as chosen_run()
/// chooses it. Without data where no cell has stored its ancestry.
Figure ancestry_figure(const ResultFile& file, std::optional<std::uint64_t> run);

}  // namespace montecarta::analysis
