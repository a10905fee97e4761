// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/markdown.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <variant>

namespace montecarta::analysis {
namespace {

/// Failures of a study that fails a thousand times are not worth a thousand lines.
constexpr std::size_t kMostTableRows = 60;

std::string markdown_escape(const std::string& text) {
  std::string markdown;
  for (const char c : text) {
    if (std::string_view("\\|*_<>[]`").find(c) != std::string_view::npos) markdown += '\\';
    markdown += c;
  }
  return markdown;
}

std::string markdown_row(const std::vector<std::string>& texts) {
  std::string row = "|";
  for (const std::string& text : texts) row += " " + markdown_escape(text) + " |";
  return row + "\n";
}

/// The value of a pair, "unknown" where there is none.
std::string value_of(const TextPairs& pairs, std::string_view key) {
  const auto found = std::ranges::find(pairs, key, [](const auto& pair) { return pair.first; });
  return found == pairs.end() ? "unknown" : found->second;
}

std::string study_lines(const StudyAnalysis& study, const TextPairs& provenance) {
  return "# " + markdown_escape(study.title.empty() ? study.study_name : study.title) + "\n\n" +
         "- study `" + study.study_name + "`, seed " + std::to_string(study.seed) + ": " +
         std::to_string(study.runs_here) + " of " + std::to_string(study.study_runs) + " runs, " +
         study.scans_text() + "\n- run on " + value_of(provenance, "date") + " by montecarta " +
         value_of(provenance, "version") + ", commit " + value_of(provenance, "git") + "\n- on " +
         value_of(provenance, "cpu") + ", " + value_of(provenance, "compiler") + ", " +
         value_of(provenance, "libm") + "\n";
}

std::string markdown_figure(const Figure& figure) {
  return "\n## " + markdown_escape(figure.title) + "\n\n![" + markdown_escape(figure.title) +
         "](figures/" + figure.name + ".svg)\n\n" + markdown_escape(figure.sentence) + "\n";
}

std::string markdown_section(const Section& section) {
  std::string tables;
  for (const Section::Block& block : section.blocks) {
    const auto* table = std::get_if<Section::Table>(&block);
    if (table != nullptr) tables += "\n" + markdown_table(table->table);
  }
  const std::string heading =
      section.title.empty() ? "" : "\n## " + markdown_escape(section.title) + "\n";
  return tables.empty() ? "" : heading + tables;
}

std::string markdown_assumptions(const StudyAnalysis& study) {
  if (study.printed.assumptions.empty()) return "";
  std::string list = "\nWhat the paper leaves open, and what is assumed:\n\n";
  for (const std::string& each : study.printed.assumptions) {
    list += "- " + markdown_escape(each) + "\n";
  }
  return list;
}

bool is_leading_figure(const Section& section) {
  constexpr std::array kLeading = {"figure_anees", "figure_reference_error"};
  return std::ranges::find(kLeading, section.name) != kLeading.end();
}

}  // namespace

std::string markdown_table(const TextTable& table) {
  std::vector<std::string> headings;
  std::string rule = "|";
  for (const TextTable::Heading& heading : table.headings) {
    headings.push_back(heading.text);
    rule += heading.align == Align::left ? "---|" : "---:|";
  }
  std::string markdown = markdown_row(headings) + rule + "\n";
  const std::size_t shown = std::min(table.rows.size(), kMostTableRows);
  for (std::size_t i = 0; i < shown; ++i) markdown += markdown_row(table.rows[i]);
  const std::size_t hidden = table.rows.size() - shown;
  return hidden == 0 ? markdown : markdown + "\n... and " + std::to_string(hidden) + " rows more\n";
}

std::string markdown_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                          const TextPairs& provenance) {
  std::string page = study_lines(study, provenance);
  bool has_figure = false;
  for (const Section& section : sections) {
    if (section.is_for_terminal) page += markdown_section(section);
    if (has_figure || !is_leading_figure(section)) continue;
    page += markdown_figure(section.figures.front());
    has_figure = true;
  }
  return page + markdown_assumptions(study);
}

}  // namespace montecarta::analysis
