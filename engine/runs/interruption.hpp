// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <csignal>

namespace montecarta::engine {

/// While one lives, the first SIGINT or SIGTERM is only noted, so that the program can close its
/// file; the second ends the program at once with exit code 128 + signal. A scheduler, unlike a
/// person, repeats itself: from it a second SIGTERM says nothing new. One at a time: signals belong
/// to the process.
class Interruption {
 public:
  enum class From { person, scheduler };
  explicit Interruption(From from = From::person);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// SIGINT, SIGTERM, or 0 where none has come since construction.
  int signal() const;

 private:
  struct sigaction before_int_ {};
  struct sigaction before_term_ {};
};

}  // namespace montecarta::engine
