// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/page.hpp"

#include "analysis/page/html.hpp"
#include "analysis/tables/csv_file.hpp"
#include "analysis/tables/latex.hpp"
#include "engine/errors.hpp"

#include <fstream>
#include <iterator>

namespace montecarta {
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

/// Where a figure and its numbers can be had.
std::string links_of(const Figure& figure) {
  const std::string files = "figures/" + figure.name;
  std::string links = "<a href=\"" + files + ".pdf\">PDF</a> &middot; <a href=\"" + files +
                      ".svg\">SVG</a> &middot; numbers:";
  for (const FigureData& data : figure.data) {
    if (data.rows.empty()) continue;
    links += " <a href=\"data/" + html_escape(data.name) + "\">" + html_escape(data.name) + "</a>";
  }
  return links;
}

std::string html_figure(const Figure& figure, const fs::path& directory) {
  const std::string svg = read_text(directory / "figures" / (figure.name + ".svg"));
  return html_section(figure.title, "<figure>\n" + inline_svg(svg, figure.name, figure.title) +
                                        "<figcaption>" + html_escape(figure.sentence) + "<br>" +
                                        links_of(figure) + "</figcaption>\n</figure>\n");
}

std::string html_of(const Section& section, const fs::path& directory) {
  std::string html = section.body.empty() ? "" : html_section(section.title, section.body);
  for (const Figure& figure : section.figures) {
    draw(figure, directory);
    html += html_figure(figure, directory);
  }
  return html;
}

}  // namespace

void write_page(const StudyAnalysis& study, const std::vector<Section>& sections,
                const fs::path& directory) {
  make_directory(directory / "tables");
  std::string body;
  for (const Section& section : sections) {
    for (const auto& [name, table] : section.tables) {
      write_text(directory / "tables" / (name + ".tex"), latex_table(study, table));
    }
    body += html_of(section, directory);
  }
  write_text(directory / "index.html", html_page(study.study_name + ": report", body));
}

}  // namespace montecarta
