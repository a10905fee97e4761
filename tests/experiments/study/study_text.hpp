// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "experiments/study/known_filters.hpp"
#include "experiments/study/study.hpp"
#include "tests/doubles/complaint.hpp"

#include <map>
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

/// The settings in the text of a study: the value of each "section.key".
inline std::map<std::string, std::string> settings_in(const std::string& text) {
  std::map<std::string, std::string> all;
  for (const IniEntry& entry : read_ini(text, "text").entries) {
    all[entry.section + "." + entry.key] = entry.value;
  }
  return all;
}

/// The settings that a study states when it is written out.
inline std::map<std::string, std::string> resolved_settings(const Study& study) {
  return settings_in(resolved_text(study));
}

/// The complaint of the parser; "nothing" if it has none.
inline std::string complaint(const std::string& text,
                             const std::vector<std::string>& overrides = {}) {
  return engine::complaint_of([&] { parsed(text, overrides); });
}

}  // namespace montecarta::experiments
