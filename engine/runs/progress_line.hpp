// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engine/namespaces.hpp"

#include <cstdint>
#include <string>

namespace montecarta::engine {

/// How far a study has come; a run counts once for every cell.
struct RunCounts {
  std::uint64_t done = 0;    ///< complete, those of earlier sittings included
  std::uint64_t failed = 0;  ///< likewise
  std::uint64_t total = 0;
  std::uint64_t earlier = 0;  ///< done or failed before this session

  std::uint64_t ended() const { return done + failed; }
};

/// Seconds in words of at most 8 characters: "12 s", "3:05 min", "12:40 h", "3.4 d".
std::string duration_in_words(double seconds);

/// "1350/3000 runs, 2 failed, 85.2/s, 19 s left" after `seconds` of this session.
std::string progress_words(const RunCounts& counts, double seconds);

/// A bar, the share and the words, at most `width` characters; where they do not fit, the bar goes
/// first.
std::string progress_bar(const RunCounts& counts, double seconds, std::size_t width);

}  // namespace montecarta::engine
