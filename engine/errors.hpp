// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/formatted.hpp"
#include "engine/namespaces.hpp"

#include <stdexcept>
#include <string>

namespace montecarta::engine {

/// An error whose message is a text, or a text with {} that are replaced by values: see
/// formatted().
class WordedError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  template <typename First, typename... Others>
  WordedError(FormatOf<First, Others...> text, const First& first, const Others&... others)
      : std::runtime_error(formatted<First, Others...>(text, first, others...)) {}
};

/// The user's input is wrong (exit code 2). The wording is "place: problem (why): remedy", for
/// instance "sim3.ini:12: particles = 0 (a filter needs at least one): give particles = 1 or more".
class StudyError : public WordedError {
 public:
  using WordedError::WordedError;
};

/// A failure that is not due to the user's input, such as a full disk or a missing file (exit code
/// 1).
class RunError : public WordedError {
 public:
  using WordedError::WordedError;
};

/// Checks for our own mistakes, in every build. It is not used inside the particle loop.
inline void expect(bool condition, const char* what) {
  if (!condition) throw std::logic_error(std::string("internal error, please report: ") + what);
}

}  // namespace montecarta::engine
