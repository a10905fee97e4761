// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace montecarta::engine {

/// The estimates of a filter besides the spread of its pose. The filter declares them; a study
/// stores the columns of a mixture, a joint estimate or the rotation information if they are there.
struct Capabilities {
  bool particles = false;
  bool mixture = false;               ///< estimate() has a mixture before sampling
  bool joint = false;                 ///< joint() has an estimate
  bool rotation_information = false;  ///< ScanReport has it
  bool map = true;                    ///< map() has landmarks
};

}  // namespace montecarta::engine
