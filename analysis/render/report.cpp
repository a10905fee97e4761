// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/render/report.hpp"

#include "analysis/render/figures/ancestry_figure.hpp"
#include "analysis/render/figures/gnuplot.hpp"
#include "analysis/render/figures/path_figure.hpp"
#include "analysis/render/page/page.hpp"
#include "analysis/render/page/replay/replay.hpp"
#include "analysis/render/page/replay/replay_still.hpp"
#include "analysis/render/page/verdict_cards.hpp"
#include "analysis/render/tables/files.hpp"
#include "analysis/study/frame.hpp"
#include "analysis/study/metric.hpp"
#include "analysis/study/registry.hpp"
#include "analysis/study/section.hpp"
#include "analysis/study/study_analysis.hpp"
#include "analysis/study/study_comparison.hpp"
#include "engine/text/wrapped_text.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace montecarta::analysis {
namespace {

namespace fs = std::filesystem;

/// Removes the element of this name from `all` and returns it; nullopt if there is none.
template <class Named>
std::optional<Named> take(const std::string& name, std::vector<Named>& all) {
  const auto found = std::ranges::find(all, name, &Named::name);
  if (found == all.end()) return std::nullopt;
  std::optional<Named> taken(std::move(*found));
  all.erase(found);
  return taken;
}

/// The section with a heading: a folded one without a heading takes that of its first figure.
Section titled(Section section) {
  const bool is_open = section.shown == Section::Shown::open;
  if (is_open || !section.title.empty() || section.figures.empty()) return section;
  const Figure& first = section.figures.front();
  section.title = first.title;
  section.summary = engine::first_sentence(first.sentence);
  return section;
}

/// Sections in the order of reading, each with its figures. Those without a place come last.
std::vector<Section> arranged(std::vector<Section> sections, std::vector<Figure> figures) {
  std::vector<SectionPlace> places = reading_order();
  for (const Section& section : sections) places.push_back({section.name});
  for (const Figure& figure : figures) places.push_back({figure.name});
  std::vector<Section> page;
  for (SectionPlace& place : places) {
    Section section = take(place.section, sections).value_or(Section{place.section, ""});
    if (section.shown == Section::Shown::folded) section.shown = place.shown;
    for (const Figure& figure : figures) {
      if (!place.prefix.empty() && figure.name.starts_with(place.prefix))
        place.figures.push_back(figure.name);
    }
    place.figures.push_back(place.section);
    for (const std::string& name : place.figures) {
      if (auto figure = take(name, figures)) section.figures.push_back(std::move(*figure));
    }
    page.push_back(titled(std::move(section)));
  }
  return page;
}

/// All sections of the page.
std::vector<Section> all_sections(const ResultFile& file, const StudyAnalysis& study,
                                  const StudyComparison& comparison, const Replay& replay,
                                  const ReportOptions& options) {
  std::vector<Section> sections = sections_of(study);
  sections.insert(sections.end(),
                  {title_section(study), verdict_cards(study), failure_section(study),
                   replay_section(file, replay), comparison_section(study, comparison)});
  std::vector<Figure> figures = figures_of(study);
  figures.insert(figures.end(),
                 {path_figure(file, options.run), ancestry_figure(file, options.run)});
  std::erase_if(figures, [](const Figure& figure) { return figure.data.empty(); });
  std::vector<Section> page = arranged(std::move(sections), std::move(figures));
  Section missing = missing_section(page);
  page.push_back(std::move(missing));
  page.push_back(origin_section(file, study));
  return page;
}

/// Writes the tables and draws the figures, four of them by each gnuplot. The number is fixed
/// because the bytes of a drawing depend on the one before it, but must not depend on the number of
/// threads.
void write_files(const StudyAnalysis& study, const StudyComparison& comparison,
                 const std::vector<Section>& sections, const fs::path& directory,
                 const Parallel& parallel) {
  std::vector<const Figure*> figures;
  for (const Section& section : sections) {
    for (const Figure& figure : section.figures) figures.push_back(&figure);
  }
  constexpr std::size_t kFiguresOfProcess = 4;
  const std::size_t processes = (figures.size() + kFiguresOfProcess - 1) / kFiguresOfProcess;
  parallel.for_each(processes + 1, [&](std::size_t i) {
    if (i == processes) {
      write_csv(study, directory / "tables");
      return write_comparison_csv(comparison, directory / "tables");
    }
    const auto from = std::span(figures).subspan(i * kFiguresOfProcess);
    draw(from.first(std::min(from.size(), kFiguresOfProcess)), directory);
  });
}

}  // namespace

const std::vector<std::string>& report_names() {
  static const std::vector<std::string> names = {"index.html", "summary.md", "figures", "data",
                                                 "tables"};
  return names;
}

void write_report(const ResultFile& file, const fs::path& directory, const ReportOptions& options) {
  const StudyAnalysis study = analyze(file, options.level, *options.parallel, options.within);
  const StudyComparison comparison = compare_study(
      study, study.cells.front().label, usual_scores(study.has_truth), *options.parallel);
  const Replay replay = chosen_replay(file, options.run);
  const std::vector<Section> sections = all_sections(file, study, comparison, replay, options);
  write_files(study, comparison, sections, directory, *options.parallel);
  write_page(study, sections, directory);
  if (!replay.cells.empty()) {
    write_text(directory / "figures" / "replay.svg", replay_still(replay));
  }
  write_text(directory / "summary.md", markdown_page(study, sections, file.provenance()));
}

}  // namespace montecarta::analysis
