// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/study_of_log.hpp"

#include "engine/errors.hpp"
#include "experiments/study/setting.hpp"

#include <algorithm>
#include <sstream>

namespace montecarta::experiments {
namespace {

/// Whether "key = value" is a setting that a scenario of kind log does not have.
bool is_foreign(const std::string& line) {
  return std::ranges::any_of(study_settings(), [&](const Setting& setting) {
    return setting.section == "scenario" && !setting.is_for("log") &&
           line.starts_with(setting.key + " = ");
  });
}

}  // namespace

std::string study_of_log(const Study& study) {
  expect(study.log != nullptr, "a log is asked for where nothing was recorded");
  std::istringstream resolved(resolved_text(study));
  std::string text, section;
  for (std::string line; std::getline(resolved, line);) {
    if (line.starts_with("[")) section = line;
    if (section == "[scenario]") {
      if (is_foreign(line)) continue;
      if (line.starts_with("kind = ")) line = "kind = log";
      if (line.starts_with("path = ")) line = "path = .";
    }
    text += line + "\n";
  }
  return text;
}

}  // namespace montecarta::experiments
