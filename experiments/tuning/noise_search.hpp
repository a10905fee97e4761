// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "analysis/study/tuning.hpp"
#include "experiments/tuning/noise_landscape.hpp"

namespace montecarta::experiments {

/// Finds the factors at which the score of a cell is least (STATISTICS 23): a grid of octaves, a
/// descent by halves of the step, and cubic surfaces at steps of an eighth of an octave. Throws
/// StudyError if the score has no minimum.
TuningResult find_noise(const Study& study, const CellSpec& cell, TuningScore score,
                        const Parallel& parallel);

}  // namespace montecarta::experiments
