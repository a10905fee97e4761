// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/errors.hpp"

#include <string>

namespace montecarta::engine {

/// The message of the error that `act` throws; "nothing" if it succeeds.
template <class Error = StudyError>
std::string complaint_of(const auto& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing";
}

}  // namespace montecarta::engine
