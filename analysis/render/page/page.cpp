// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/page/page.hpp"

#include "analysis/render/page/first_paragraph.hpp"
#include "analysis/render/page/html.hpp"
#include "analysis/render/tables/files.hpp"
#include "analysis/study/drive_facts.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/reference_sums.hpp"
#include "analysis/study/verdict_table.hpp"
#include "engine/errors.hpp"
#include "engine/text/list_text.hpp"
#include "engine/text/number_text.hpp"
#include "engine/text/wrapped_text.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>
#include <variant>

namespace montecarta::analysis {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw RunError(path.string() + ": cannot be read (gnuplot should have written it)");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string html_heading(int level, const std::string& title) {
  const std::string name = "h" + std::to_string(level);
  return title.empty() ? "" : "<" + name + ">" + html_escape(title) + "</" + name + ">\n";
}

/// Links to a figure's numbers, folded away if there are many files.
std::string links_to_numbers(const Figure& figure) {
  constexpr std::size_t kFew = 4;
  std::string links;
  std::size_t count = 0;
  for (const FigureData& data : figure.data) {
    if (data.frame.rows() == 0) continue;
    const std::string name = html_escape(data.name);
    links += " <a href=\"data/" + name + "\">" + name + "</a>";
    ++count;
  }
  if (count <= kFew) return " &middot; numbers:" + links;
  return "<details><summary>numbers: " + std::to_string(count) + " files</summary>" + links +
         "</details>";
}

/// The links to a figure and its numbers.
std::string links_of(const Figure& figure) {
  const std::string files = "figures/" + figure.name;
  return "<a href=\"" + files + ".pdf\">PDF</a> &middot; <a href=\"" + files + ".svg\">SVG</a>" +
         links_to_numbers(figure);
}

/// The drawing, and the numbers from which the script makes an interactive drawing.
std::string html_drawing(const Figure& figure, const fs::path& directory) {
  const std::string svg = read_text(directory / "figures" / (figure.name + ".svg"));
  const std::string chart =
      figure.chart.panels.empty() ? "" : html_data("chart-data", chart_json(figure.chart));
  return "<figure id=\"figure_" + figure.name + "\">\n<div class=\"scroll\">" +
         inline_svg(svg, figure.name, figure.title) + "</div>\n" + chart + "<figcaption>" +
         links_of(figure) + "</figcaption>\n</figure>\n";
}

/// Figures, each with a heading that does not repeat that of the section, and a sentence with a "?"
/// that opens the others.
std::string html_figures(const Section& section, const fs::path& directory) {
  const int level = section.title.empty() ? 2 : 3;
  std::string html;
  for (const Figure& figure : section.figures) {
    const std::string first = engine::first_sentence(figure.sentence);
    const std::string others = figure.sentence.substr(first.size());
    const std::string stop = others.empty() ? "" : ".";
    const bool is_said = first == section.summary;
    if (figure.title != section.title) html += html_heading(level, figure.title);
    html += html_explained(
        is_said ? "" : "<span class=\"soft\">" + html_escape(first + stop) + "</span>",
        others.empty() ? "" : html_paragraphs({others.substr(2)}));
    html += html_drawing(figure, directory);
  }
  return html;
}

/// HTML of a block that is a table or HTML. Notes are opened by a "?", and leads are shown on
/// cards.
std::string html_of(const Section::Block& block) {
  if (const auto* table = std::get_if<Section::Table>(&block)) return html_table(table->table);
  const auto* html = std::get_if<Section::Html>(&block);
  return html == nullptr ? "" : html->text;
}

std::vector<std::string> notes_of(const Section& section) {
  std::vector<std::string> notes;
  for (const auto& note : section.all<Section::Note>()) notes.push_back(note.text);
  return notes;
}

/// HTML of the heading of a folded section: "Is it so? Hardly.", "Map: landmark RMSE 0.1 m".
std::string folded_heading(const Section& section) {
  const std::string colon = section.title.ends_with('?') || section.summary.empty() ? "" : ":";
  return "<h2>" + html_escape(section.title) + colon + "</h2> <span class=\"says\">" +
         html_escape(section.summary) + "</span>";
}

std::string html_of(const Section& section, const fs::path& directory) {
  if (!section.has_content()) return "";
  const bool is_open = section.shown == Section::Shown::open;
  const std::string notes = html_paragraphs(notes_of(section));
  std::string body = html_explained(is_open ? html_heading(2, section.title) : "", notes);
  for (const auto& block : section.blocks) body += html_of(block);
  body += html_figures(section, directory);
  const std::string begin = "<section id=\"" + section.name + "\">\n";
  if (is_open) return begin + body + "</section>\n";
  return begin + "<details class=\"folded\"><summary>" + folded_heading(section) + "</summary>\n" +
         body + "</details>\n</section>\n";
}

/// Largest number of rows of a table on the page, since a study may fail a thousand times.
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

/// Returns the value of a key; "unknown" if there is none.
std::string value_of(const TextPairs& pairs, std::string_view key) {
  const auto found = std::ranges::find(pairs, key, [](const auto& pair) { return pair.first; });
  return found == pairs.end() ? "unknown" : found->second;
}

std::string study_lines(const StudyAnalysis& study, const TextPairs& provenance) {
  return "\n- study `" + study.study_name + "`, seed " + std::to_string(study.seed) + ": " +
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
  for (const auto& table : section.all<Section::Table>()) {
    tables += "\n" + markdown_table(table.table);
  }
  const std::string heading =
      section.title.empty() ? "" : "\n## " + markdown_escape(section.title) + "\n";
  return tables.empty() ? "" : heading + tables;
}

/// The figure that answers what the study asks, as Markdown: what its options change, if it varies
/// any, or else the NEES ratio or the distance to a reference over time. Empty if there is none.
std::string markdown_leading_figure(const std::vector<Section>& sections) {
  for (const Section& section : sections) {
    for (const Figure& figure : section.figures) {
      if (figure.name.starts_with("sweep_") || figure.name == "anees" ||
          figure.name == "reference_error")
        return markdown_figure(figure);
    }
  }
  return "";
}

std::string details(const std::string& summary, const std::string& content) {
  return "<details><summary>" + summary + "</summary>" + content + "</details>\n";
}

/// Text of the numbers of comparisons that are better and worse.
std::string comparison_summary(const Comparisons& all) {
  std::size_t better = 0, worse = 0;
  for (const CellComparison& row : all.rows) {
    const std::string verdict = row.verdict(all.level);
    better += verdict.starts_with("better") ? 1 : 0;
    worse += verdict.starts_with("worse") ? 1 : 0;
  }
  return std::to_string(all.rows.size()) + " comparisons, better in " + std::to_string(better) +
         ", worse in " + std::to_string(worse);
}

std::string title_line(const StudyAnalysis& study) {
  return html_escape(study.study_name) + " &middot; " + std::to_string(study.runs_here) + " of " +
         std::to_string(study.study_runs) + " runs &middot; " + study.scans_text() +
         " &middot; seed " + std::to_string(study.seed) + " &middot; " + html_escape(study.file);
}

}  // namespace

void write_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                const fs::path& directory) {
  make_directory(directory / "tables");
  std::string body;
  for (const Section& section : sections) {
    for (const auto& table : section.all<Section::Table>()) {
      write_text(directory / "tables" / (table.name + ".tex"), latex_table(study, table.table));
    }
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
  std::string page = "# " + markdown_escape(study.title.empty() ? study.study_name : study.title) +
                     "\n\n" + markdown_escape(first_paragraph(study)) + "\n" +
                     markdown_leading_figure(sections);
  for (const std::string& fact : drive_facts(study)) page += "\n" + markdown_escape(fact) + "\n";
  for (const Section& section : sections) {
    if (section.is_for_terminal) page += markdown_section(section);
  }
  return page + study_lines(study, provenance);
}

Section title_section(const StudyAnalysis& study) {
  Section section{"title", ""};
  section.add_html(html_heading(1, study.title.empty() ? study.study_name : study.title) +
                   html_paragraphs({studied_sentence(study)}) +
                   html_paragraphs(drive_facts(study)) + "<p class=\"soft\">" + title_line(study) +
                   "</p>\n");
  return section;
}

Section failure_section(const StudyAnalysis& study) {
  if (!study.has_failures()) return {};
  std::size_t failed = 0;
  for (const CellAnalysis& cell : study.cells) failed += cell.failures.size();
  Section section{"failures", "Failed runs"};
  section.summary = std::to_string(failed) + " of " +
                    std::to_string(study.runs_here * study.cells.size()) +
                    " runs ended early, with step and reason";
  section.add("failures", failure_table(study));
  section.add(paragraphs("cards", "failures"));
  return section;
}

Section comparison_section(const StudyAnalysis& study, const StudyComparison& comparison) {
  const Comparisons& all = comparison.comparisons;
  if (!study.has_truth || all.rows.empty()) return {};
  Section section{"comparison", "Compared with " + all.baseline};
  section.summary = comparison_summary(all);
  section.is_for_terminal = false;
  section.add_html(html_paragraphs(comparison_sentences(all)));
  section.add("comparison", comparison_table(all));
  section.add(comparison_notes(study, all));
  for (const WinMatrix& matrix : comparison.matrices) {
    section.add("wins_" + std::string(matrix.score->name), win_table(matrix, all.level));
  }
  section.add(std::vector{win_note(all.level)});
  return section;
}

Section missing_section(const std::vector<Section>& sections) {
  Section missing{"missing", "What this page cannot show"};
  for (const Section& section : sections) {
    if (section.has_content() || section.blocks.empty()) continue;
    append_part(missing.summary, section.title);
    missing.add_html(html_paragraphs(notes_of(section)));
  }
  return missing;
}

Section origin_section(const ResultFile& file, const StudyAnalysis& study) {
  const TextPairs& provenance = file.provenance();
  Section section{"origin", "Where this comes from"};
  section.summary =
      "montecarta " + value_of(provenance, "version") + ", " + value_of(provenance, "date");
  section.add_html(
      html_paragraphs({"Same study, same build, same numbers: study " + study.study_sha256 +
                       ". Tables are in tables/ as CSV and LaTeX."}));
  section.add_html(details("Scenario", html_pairs(file.scenario())) +
                   details("Provenance", html_pairs(provenance)) +
                   details("Study file, with everything filled in",
                           "<pre>" + html_escape(file.study_text()) + "</pre>"));
  return section;
}

}  // namespace montecarta::analysis
