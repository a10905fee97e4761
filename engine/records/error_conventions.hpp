// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <array>

namespace montecarta::engine {

/// What error the covariance of an imported pose may be the covariance of (STATISTICS 19).
struct StoredConvention {
  const char* name;     ///< as users type it
  const char* column;   ///< of the NEES by it
  const char* meaning;  ///< of that column
};

/// All of them, in the order of files and tables.
inline constexpr std::array kErrorConventions = {
    StoredConvention{"world", "nees_world",
                     "imported: NEES if the covariance were of the error world"},
    StoredConvention{"body", "nees_body",
                     "imported: NEES if the covariance were of the error body"},
    StoredConvention{"right-invariant", "nees_right_invariant",
                     "imported: NEES if the covariance were of the error right-invariant"}};

}  // namespace montecarta::engine
