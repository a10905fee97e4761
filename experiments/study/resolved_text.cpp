// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/inline_world.hpp"
#include "experiments/study/setting.hpp"
#include "experiments/study/study.hpp"

namespace montecarta::experiments {
namespace {

/// The text of studies that make all runs, store no joint estimates, or have the usual margin, is
/// what it was before a study could do otherwise.
bool is_default_noted(const Study& study, const std::string& key, const std::string& value) {
  if (key == "joint_scans") return study.settings.lists("record", "columns", "joint");
  if (key == "within") return value != kUsualWithin;
  return key != "until" || !value.empty();
}

}  // namespace

std::string resolved_text(const Study& study) {
  std::string text;
  for (const std::string& section : study_sections()) {
    if (section == "printed" && study.printed.empty()) continue;
    if (section == "world" && study.log != nullptr) continue;
    text += "[" + section + "]\n";
    for (const auto& [key, value] : study.settings.section(section)) {
      if (is_default_noted(study, key, value)) text += key + " = " + value + "\n";
    }
    if (section == "cells") {
      for (const CellSpec& cell : study.cells) text += "cell = " + cell_line(cell) + "\n";
    }
    if (section == "printed") text += printed_text(study.printed);
    if (section == "world") text += inline_world_text(study.world);
  }
  return text;
}

}  // namespace montecarta::experiments
