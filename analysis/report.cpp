// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/report.hpp"

#include "analysis/figures/path_figure.hpp"
#include "analysis/figures/reference_figures.hpp"
#include "analysis/figures/time_figures.hpp"
#include "analysis/html.hpp"
#include "analysis/printed/comparison.hpp"
#include "analysis/study_analysis.hpp"
#include "analysis/tables.hpp"
#include "analysis/tables/csv_file.hpp"
#include "analysis/tables/latex.hpp"
#include "analysis/tables/reference_table.hpp"
#include "engine/errors.hpp"

#include <fstream>
#include <iterator>
#include <utility>

namespace montecarta {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw RunError(path.string() + ": cannot be read (gnuplot should have written it)");
  return {std::istreambuf_iterator<char>(file), {}};
}

void refuse_existing(const fs::path& directory, ExistingReport existing) {
  if (existing == ExistingReport::replace) return;
  for (const char* name : {"index.html", "figures", "data", "tables"}) {
    if (!fs::exists(directory / name)) continue;
    throw StudyError((directory / name).string() +
                     ": is there already (nothing is overwritten unasked): add --force, or choose "
                     "another directory");
  }
}

std::string section(const std::string& title, const std::string& body) {
  return "<section>\n<h2>" + html_escape(title) + "</h2>\n" + body + "</section>\n";
}

std::string paragraphs(const std::vector<std::string>& sentences) {
  std::string html;
  for (const std::string& sentence : sentences) {
    html += "<p class=\"soft\">" + html_escape(sentence) + "</p>\n";
  }
  return html;
}

std::string head(const StudyAnalysis& study) {
  return "<h1>" + html_escape(study.title.empty() ? study.study_name : study.title) +
         "</h1>\n<p class=\"soft\">" + html_escape(study.study_name) + " &middot; " +
         std::to_string(study.runs_here) + " of " + std::to_string(study.study_runs) +
         " runs &middot; " + std::to_string(study.times.size()) + " scans each &middot; seed " +
         std::to_string(study.seed) + " &middot; " + html_escape(study.file) + "</p>\n";
}

std::string failures(const StudyAnalysis& study) {
  if (!study.has_failures()) return "";
  return section("Failed runs",
                 html_table(failure_table(study)) +
                     paragraphs({"These runs ended early and are left out of everything below; the "
                                 "step counts from 0. If they failed because the filter diverged, "
                                 "what is left looks better than the filter is."}));
}

std::string figure_section(const Figure& figure, const fs::path& directory) {
  const std::string files = "figures/" + figure.name;
  std::string links = "<a href=\"" + files + ".pdf\">PDF</a> &middot; <a href=\"" + files +
                      ".svg\">SVG</a> &middot; numbers:";
  for (const FigureData& data : figure.data) {
    if (data.rows.empty()) continue;
    links += " <a href=\"data/" + html_escape(data.name) + "\">" + html_escape(data.name) + "</a>";
  }
  return section(figure.title, "<figure>\n" +
                                   inline_svg(read_text(directory / (files + ".svg")), figure.name,
                                              figure.title) +
                                   "<figcaption>" + html_escape(figure.sentence) + "<br>" + links +
                                   "</figcaption>\n</figure>\n");
}

std::string association_section(const StudyAnalysis& study) {
  const TextTable table = association_table(study);
  if (table.rows.empty()) return "";
  return section("Association", html_table(table) + paragraphs(association_notes()));
}

std::string consistency_section(const StudyAnalysis& study) {
  if (!study.has_truth) return "";
  return section(
      "The whole test",
      html_table(consistency_table(study)) +
          paragraphs(
              {"Each row is one test: of the pose or of a part of it, with the covariance "
               "of the particle mixture or of the particle spread. The spread of few "
               "particles is too small by construction, so the mixture decides where there "
               "is one.",
               "'ideal' is the ANEES of a perfect filter: the number of components; with the "
               "spread of M particles that are independent draws from the truth's "
               "distribution it is larger, since so few draws cannot tell their covariance "
               "better.",
               "'median' is the middle run instead of the average one: far below ANEES it "
               "says that few bad runs make the average. 'floored' counts covariances that "
               "were singular (0.1 mm and 0.00001 rad were added), 'undefined' those that "
               "were not a number and left out."}));
}

std::string printed_section(const StudyAnalysis& study) {
  if (study.printed.empty()) return "";
  std::string body;
  if (!study.printed.source.empty()) {
    body += "<p>" + html_escape(study.printed.source) + "</p>\n";
  }
  for (const TextTable& table : {printed_value_table(study), printed_claim_table(study)}) {
    if (!table.rows.empty()) body += html_table(table);
  }
  body += paragraphs(printed_notes(study));
  if (study.printed.assumptions.empty()) return section("Printed and measured", body);
  body += "<p>What the paper leaves open, and what we assume:</p>\n<ul>\n";
  for (const std::string& each : study.printed.assumptions) {
    body += "<li>" + html_escape(each) + "</li>\n";
  }
  return section("Printed and measured", body + "</ul>\n");
}

std::string origin(const ResultFile& file, const StudyAnalysis& study) {
  return section("Where this comes from",
                 paragraphs({"Same study, same build, same numbers: study " + study.study_sha256 +
                             ". Tables are in tables/ as CSV and LaTeX."}) +
                     "<details><summary>Scenario</summary>" + html_pairs(file.scenario()) +
                     "</details>\n<details><summary>Provenance</summary>" +
                     html_pairs(file.provenance()) +
                     "</details>\n<details><summary>Study file, with everything filled in"
                     "</summary><pre>" +
                     html_escape(file.study_text()) + "</pre></details>\n");
}

std::string verdict_section(const StudyAnalysis& study) {
  if (!study.has_truth) return "";
  return section("Verdict", html_table(verdict_table(study)) + html_table(accuracy_table(study)) +
                                paragraphs(verdict_notes(study)));
}

std::string reference_section(const StudyAnalysis& study) {
  if (study.has_truth && study.references.empty()) return "";
  std::string body;
  if (!study.has_truth) body += "<p>" + html_escape(no_truth_sentence()) + "</p>\n";
  for (const TextTable& table : {reference_table(study), baseline_table(study), map_table(study)}) {
    if (!table.rows.empty()) body += html_table(table);
  }
  return section("Judged by references", body + paragraphs(reference_notes(study)));
}

void write_latex(const TextTable& table, const fs::path& path) {
  if (!table.rows.empty()) write_text(path, latex_tabular(table));
}

void write_tables(const StudyAnalysis& study, const fs::path& directory) {
  write_csv(study, directory);
  if (study.has_truth) {
    write_text(directory / "verdict.tex", latex_table(study));
    write_text(directory / "accuracy.tex", latex_tabular(accuracy_table(study)));
    write_text(directory / "consistency.tex", latex_tabular(consistency_table(study)));
  }
  if (!study.has_truth || !study.references.empty()) {
    write_latex(reference_table(study), directory / "reference.tex");
    write_latex(baseline_table(study), directory / "baseline.tex");
    write_latex(map_table(study), directory / "map.tex");
  }
  if (!study.printed.empty()) {
    write_text(directory / "printed.tex", latex_tabular(printed_value_table(study)));
    write_text(directory / "claims.tex", latex_tabular(printed_claim_table(study)));
  }
  write_latex(association_table(study), directory / "association.tex");
}

}  // namespace

void write_report(const ResultFile& file, const fs::path& directory, const ReportOptions& options) {
  refuse_existing(directory, options.existing);
  const StudyAnalysis study = analyze(file, options.level, *options.parallel);
  std::vector<Figure> figures = reference_figures(study);
  for (Figure& figure : time_figures(study)) figures.push_back(std::move(figure));
  Figure paths = path_figure(file, options.run);
  if (!paths.data.empty()) figures.insert(figures.begin(), std::move(paths));
  make_directory(directory);
  write_tables(study, directory / "tables");
  std::string body =
      head(study) + failures(study) + verdict_section(study) + reference_section(study);
  for (const Figure& figure : figures) {
    draw(figure, directory);
    body += figure_section(figure, directory);
  }
  body += association_section(study) + consistency_section(study) + origin(file, study) +
          printed_section(study);
  write_text(directory / "index.html", html_page(study.study_name + ": report", body));
}

}  // namespace montecarta
