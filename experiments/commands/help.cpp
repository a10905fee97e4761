// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/arguments.hpp"
#include "experiments/text/table.hpp"
#include "experiments/text/words.hpp"

namespace montecarta::experiments {

std::string help_text(const CommandSpec& spec) {
  std::string text = "usage: montecarta " + spec.name;
  for (const OperandSpec& operand : spec.operands)
    text += " " + operand.name + (operand.most > 1 ? "..." : "");
  text += (spec.options.empty() ? "" : " [options]") + std::string("\n\n") + spec.summary + "\n\n";
  std::vector<TableRow> rows;
  for (const OptionSpec& option : spec.options) {
    const std::string letter = option.letter.empty() ? "    " : "-" + option.letter + ", ";
    const std::string values = option.values.empty() ? "" : " " + joined(option.values, " ");
    rows.push_back({letter + "--" + option.name + values, option.meaning});
  }
  rows.push_back({"    --help", "this text"});
  text += "options:\n" + aligned(rows);
  return spec.details.empty() ? text : text + "\n" + spec.details;
}

std::string shell_quoted(const std::string& word) {
  const char* plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./:=,+@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace montecarta::experiments
