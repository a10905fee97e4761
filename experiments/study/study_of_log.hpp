// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/study.hpp"

#include <string>

namespace montecarta::experiments {

/// The study file that does with the plain log beside it (scenario.kind = log) what `study` does
/// with its recorded drive. The fingerprint of the drive stays, so that reading it proves that the
/// log is the same drive.
std::string study_of_log(const Study& study);

}  // namespace montecarta::experiments
