// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"

namespace montecarta::engine {

/// The error of a filter that could not begin a single run. It ends the study. The runs that failed
/// before are no results, and other workers would end by the same error until the filter is mended.
class UnusableFilter : public RunError {
 public:
  using RunError::RunError;
};

}  // namespace montecarta::engine
