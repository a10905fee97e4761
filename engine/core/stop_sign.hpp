// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

namespace montecarta::engine {

/// Whether somebody has asked the workers to stop. For a filter that waits for something outside of
/// the process; any other ends its step soon enough.
class StopSign {
 public:
  virtual ~StopSign() = default;
  virtual bool made() const = 0;
};

}  // namespace montecarta::engine
