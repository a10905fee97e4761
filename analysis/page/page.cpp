// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/page.hpp"

#include "analysis/metrics/verdict_table.hpp"
#include "analysis/output/csv_file.hpp"
#include "analysis/page/html.hpp"
#include "analysis/tables/tables.hpp"
#include "engine/errors.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <string_view>
#include <variant>

namespace montecarta::analysis {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw RunError(path.string() + ": cannot be read (gnuplot should have written it)");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string html_section(const std::string& title, const std::string& body) {
  const std::string heading = title.empty() ? "" : "<h2>" + html_escape(title) + "</h2>\n";
  return "<section>\n" + heading + body + "</section>\n";
}

/// A figure's numbers; where there are many files, folded away.
std::string links_to_numbers(const Figure& figure) {
  constexpr std::size_t kFew = 4;
  std::string links;
  std::size_t count = 0;
  for (const FigureData& data : figure.data) {
    if (data.rows.empty()) continue;
    const std::string name = html_escape(data.name);
    links += " <a href=\"data/" + name + "\">" + name + "</a>";
    ++count;
  }
  if (count <= kFew) return " &middot; numbers:" + links;
  return "<details><summary>numbers: " + std::to_string(count) + " files</summary>" + links +
         "</details>";
}

/// Where a figure and its numbers can be had.
std::string links_of(const Figure& figure) {
  const std::string files = "figures/" + figure.name;
  return "<a href=\"" + files + ".pdf\">PDF</a> &middot; <a href=\"" + files + ".svg\">SVG</a>" +
         links_to_numbers(figure);
}

/// The drawing, and the numbers from which the script makes a drawing that can be asked.
std::string html_figure(const Figure& figure, const fs::path& directory) {
  const std::string svg = read_text(directory / "figures" / (figure.name + ".svg"));
  const std::string drawing =
      "<div class=\"scroll\">" + inline_svg(svg, figure.name, figure.title) + "</div>\n";
  const std::string chart =
      figure.chart.panels.empty() ? "" : html_data("chart-data", chart_json(figure.chart));
  return html_section(figure.title, "<figure id=\"figure_" + figure.name + "\">\n" + drawing +
                                        chart + "<figcaption>" + html_escape(figure.sentence) +
                                        "<br>" + links_of(figure) + "</figcaption>\n</figure>\n");
}

/// Of a table, a note or HTML.
struct HtmlOf {
  std::string operator()(const Section::Table& table) const { return html_table(table.table); }
  std::string operator()(const Section::Note& note) const {
    return "<p class=\"soft\">" + html_escape(note.text) + "</p>\n";
  }
  std::string operator()(const Section::Lead& lead) const {
    return "<p class=\"lead\">" + html_escape(lead.text) + "</p>\n";
  }
  std::string operator()(const Section::Html& html) const { return html.text; }
};

std::string html_of(const Section& section, const fs::path& directory) {
  std::string body;
  for (const auto& block : section.blocks) body += std::visit(HtmlOf{}, block);
  std::string html = body.empty() ? "" : html_section(section.title, body);
  for (const Figure& figure : section.figures) {
    draw(figure, directory);
    html += html_figure(figure, directory);
  }
  return html;
}

/// Its tables, for a LaTeX document.
void write_latex_tables(const StudyAnalysis& study, const Section& section,
                        const fs::path& directory) {
  for (const auto& block : section.blocks) {
    const auto* table = std::get_if<Section::Table>(&block);
    if (table == nullptr) continue;
    write_text(directory / (table->name + ".tex"), latex_table(study, table->table));
  }
}

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

bool is_leading_figure(const Section& section) {
  constexpr std::array kLeading = {"figure_anees", "figure_reference_error"};
  return std::ranges::find(kLeading, section.name) != kLeading.end();
}

}  // namespace

void write_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                const fs::path& directory) {
  make_directory(directory / "tables");
  std::string body;
  for (const Section& section : sections) {
    write_latex_tables(study, section, directory / "tables");
    body += html_of(section, directory);
  }
  write_text(directory / "index.html", html_page(study.study_name + ": report", body));
}

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
  return page;
}

namespace {

std::string details(const std::string& summary, const std::string& content) {
  return "<details><summary>" + summary + "</summary>" + content + "</details>\n";
}

}  // namespace

Section title_section(const StudyAnalysis& study) {
  Section section{"title", ""};
  section.add_html("<h1>" + html_escape(study.title.empty() ? study.study_name : study.title) +
                   "</h1>\n<p class=\"soft\">" + html_escape(study.study_name) + " &middot; " +
                   std::to_string(study.runs_here) + " of " + std::to_string(study.study_runs) +
                   " runs &middot; " + study.scans_text() + " &middot; seed " +
                   std::to_string(study.seed) + " &middot; " + html_escape(study.file) + "</p>\n");
  return section;
}

Section failure_section(const StudyAnalysis& study) {
  if (!study.has_failures()) return {};
  Section section{"failures", "Failed runs"};
  section.add("failures", failure_table(study));
  section.add(std::vector<std::string>{
      "These runs ended early and are left out of everything else; the step counts from 0. "
      "If they failed because the filter diverged, what is left looks better than the "
      "filter is."});
  return section;
}

Section comparison_section(const StudyAnalysis& study, const StudyComparison& comparison) {
  const Comparisons& all = comparison.comparisons;
  if (!study.has_truth || all.rows.empty()) return {};
  Section section{"comparison", "Compared with " + all.baseline};
  section.is_for_terminal = false;
  section.add("comparison", comparison_table(all));
  section.add(comparison_notes(study, all));
  for (const WinMatrix& matrix : comparison.matrices) {
    section.add("wins_" + std::string(matrix.score->name), win_table(matrix, all.level));
  }
  section.add(std::vector{win_note(all.level)});
  return section;
}

Section origin_section(const ResultFile& file, const StudyAnalysis& study) {
  Section section{"origin", "Where this comes from"};
  section.add(std::vector{"Same study, same build, same numbers: study " + study.study_sha256 +
                          ". Tables are in tables/ as CSV and LaTeX."});
  section.add_html(details("Scenario", html_pairs(file.scenario())) +
                   details("Provenance", html_pairs(file.provenance())) +
                   details("Study file, with everything filled in",
                           "<pre>" + html_escape(file.study_text()) + "</pre>"));
  return section;
}

}  // namespace montecarta::analysis
