// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/tuning.hpp"
#include "engine/core/plan.hpp"
#include "engine/threads/parallel.hpp"
#include "experiments/study/study.hpp"

#include <cstdint>

namespace montecarta::experiments {

/// The study whose two cells are the cell as it is and, as CELL_tuned, with other noise, on runs of
/// another seed.
Study confirming_study(const Study& study, const CellSpec& cell, const TunedNoise& noise,
                       std::uint64_t seed);

/// Compares both cells of confirming_study() on its runs, and adds the covering factors of the
/// second one (STATISTICS 23), by the scans that are judged. The verdict is left to the caller, who
/// runs the study.
TuningConfirmation confirm_on_runs(const Study& study, const StudyPlan& plan,
                                   const Parallel& parallel);

/// Compares both cells by their innovations in the second half of each recorded drive, with a
/// verdict on those of the second cell. `plan` is that of `study`.
TuningConfirmation confirm_by_innovations(const Study& study, const StudyPlan& plan,
                                          const Parallel& parallel);

/// Compares both cells by their errors at the fixes of a reference in the second half of each
/// recorded drive, with a verdict on those of the second cell (STATISTICS 20).
TuningConfirmation confirm_by_reference(const Study& study, const StudyPlan& plan,
                                        const Parallel& parallel);

}  // namespace montecarta::experiments
