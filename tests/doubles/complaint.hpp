// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"

#include <string>

namespace montecarta::engine {

/// What the user is told when `act` is tried; "nothing" where it succeeds.
std::string complaint_of(const auto& act) {
  try {
    act();
  } catch (const StudyError& error) {
    return error.what();
  }
  return "nothing";
}

}  // namespace montecarta::engine
