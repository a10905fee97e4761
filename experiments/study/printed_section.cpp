// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/printed_section.hpp"

#include "analysis/printed/run_samples.hpp"
#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

void refuse_unknown(const std::string& what, const std::string& name,
                    std::span<const std::string> known) {
  if (std::ranges::find(known, name) != known.end()) return;
  throw StudyError("there is no " + what + " '" + name + "': " + nearest_spelling(name, known));
}

void check(const PrintedValue& value, std::span<const std::string> labels) {
  refuse_unknown("metric", value.metric, printed_metrics());
  refuse_unknown("cell", value.cell, labels);
  if (value.relative_to.empty()) return;
  refuse_unknown("cell", value.relative_to, labels);
  if (is_run_metric(value.metric)) return;
  throw StudyError("relative_to=" + value.relative_to + " (runs have no " + value.metric +
                   " each): remove it");
}

void check(const PrintedClaim& claim, std::span<const std::string> labels) {
  refuse_unknown("metric", claim.metric, printed_metrics());
  refuse_unknown("cell", claim.left, labels);
  refuse_unknown("cell", claim.right, labels);
}

void take(const IniEntry& entry, std::span<const std::string> labels, Printed& printed) {
  try {
    take_printed_line(entry.key, entry.value, printed);
    if (entry.key == "value") check(printed.values.back(), labels);
    if (entry.key == "claim") check(printed.claims.back(), labels);
    if (entry.key == "baseline") refuse_unknown("cell", printed.baseline, labels);
  } catch (const StudyError& error) {
    throw StudyError(entry.place + ": " + entry.key + ": " + error.what());
  }
}

}  // namespace

Printed read_printed(std::span<const IniEntry> entries, std::span<const CellSpec> cells) {
  std::vector<std::string> labels;
  for (const CellSpec& cell : cells) labels.push_back(cell.label);
  Printed printed;
  for (const IniEntry& entry : entries) {
    if (entry.section == "printed") take(entry, labels, printed);
  }
  return printed;
}

}  // namespace montecarta::experiments
