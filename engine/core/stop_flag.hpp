// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

namespace montecarta::engine {

/// Whether somebody has asked the workers to stop. For a filter that waits for something outside of
/// the process; any other ends its step soon enough.
class StopFlag {
 public:
  virtual ~StopFlag() = default;
  virtual bool is_set() const = 0;
};

}  // namespace montecarta::engine
