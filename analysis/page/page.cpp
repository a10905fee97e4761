// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/page.hpp"

#include "analysis/output/csv_file.hpp"
#include "analysis/page/chart_json.hpp"
#include "analysis/page/html.hpp"
#include "analysis/tables/latex.hpp"
#include "engine/errors.hpp"

#include <fstream>
#include <iterator>

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

}  // namespace montecarta::analysis
