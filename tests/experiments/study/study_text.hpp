// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/known_filters.hpp"
#include "experiments/study/study.hpp"
#include "tests/doubles/complaint.hpp"

#include <string>
#include <vector>

namespace montecarta::experiments {

/// A small study that is right, for tests to change.
inline const std::string kGoodStudy = R"([study]
name = trial
runs = 20
[scenario]
world = web_loop   # a shipped one
[cells]
cell = ekf_slam
)";

inline std::string with(const std::string& old, const std::string& fresh) {
  std::string text = kGoodStudy;
  return text.replace(text.find(old), old.size(), fresh);
}

inline Study parsed(const std::string& text, const std::vector<std::string>& overrides = {}) {
  return parse_study(text, "trial.ini", ".", known_filters(), overrides);
}

/// The complaint of the parser; "nothing" if it has none.
inline std::string complaint(const std::string& text,
                             const std::vector<std::string>& overrides = {}) {
  return engine::complaint_of([&] { parsed(text, overrides); });
}

}  // namespace montecarta::experiments
