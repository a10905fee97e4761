// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <stdexcept>
#include <string>

namespace montecarta::engine {

/// The user's input is wrong (exit code 2). Worded "place: problem (why): remedy", e.g.
/// "sim3.ini:12: particles = 0 (a filter needs at least one): give particles = 1 or more".
class StudyError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Something failed while running that is not the user's input: a full disk, a file that vanished
/// (exit code 1).
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Our own mistake: on in every build outside the particle loop.
inline void expect(bool condition, const char* what) {
  if (!condition) throw std::logic_error(std::string("internal error, please report: ") + what);
}

}  // namespace montecarta::engine
