// SPDX-License-Identifier: BSD-3-Clause
// The verdict on each cell as a card: word, sentence, three numbers and the NEES over time.
#include "analysis/render/page/verdict_cards.hpp"

#include "analysis/render/page/html.hpp"
#include "analysis/render/page/page.hpp"
#include "analysis/statistics/interval.hpp"
#include "analysis/statistics/nees_bounds.hpp"
#include "analysis/study/figure.hpp"
#include "analysis/study/imported_notes.hpp"
#include "analysis/study/prose.hpp"
#include "analysis/study/verdict_table.hpp"
#include "analysis/verdict/sentence.hpp"
#include "engine/numbers/angle.hpp"
#include "engine/text/number_text.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace montecarta::analysis {
namespace {

/// [px] The box of a curve; the numbers of the axis are left of it.
constexpr double kSparkLeft = 32.0, kSparkWidth = 240.0, kSparkHeight = 64.0;
/// Powers of ten: the axis extends at least from the first to the second, and at most to the third.
constexpr int kLeastDecade = -1, kUsualDecade = 1, kMostDecade = 5;

const NeesSeries* judged_series(const CellAnalysis& cell) {
  const NeesResult* pose = cell.find_nees(ErrorBlock::pose, cell.leading);
  return pose == nullptr || !pose->is_tested() ? nullptr : &pose->series;
}

/// Returns the power of ten at the upper end of the axis, which all cards share.
int highest_decade(const StudyAnalysis& study) {
  int highest = kUsualDecade;
  for (const CellAnalysis& cell : study.cells) {
    const NeesSeries* series = judged_series(cell);
    if (series == nullptr) continue;
    for (const double value : series->average) {
      const double decade = std::ceil(std::log10(value / static_cast<double>(series->dimension)));
      if (decade > highest) highest = static_cast<int>(std::min(decade, double{kMostDecade}));
    }
  }
  return highest;
}

/// A curve over time, on a logarithmic axis, of the NEES divided by its dimension.
struct Sparkline {
  int highest;      ///< power of ten at the upper end
  double duration;  ///< [s] time at the right end

  double y(double ratio) const {
    const double share = (highest - std::log10(ratio)) / (highest - kLeastDecade);
    return 4.0 + kSparkHeight * std::clamp(share, 0.0, 1.0);
  }
  double x(double time) const { return kSparkLeft + kSparkWidth * time / std::max(duration, 1e-9); }

  std::string path(const Frame& thinned, double dimension) const {
    std::string path;
    bool is_drawn = false;
    for (std::size_t i = 0; i < thinned.rows(); ++i) {
      const double ratio = thinned.columns[1].numbers[i] / dimension;
      const bool is_known = ratio > 0.0;
      if (is_known) {
        path += (is_drawn ? "L" : "M") + pixels(x(thinned.columns[0].numbers[i])) + " " +
                pixels(y(ratio));
      }
      is_drawn = is_known;
    }
    return path;
  }

  std::string grid() const {
    std::string html;
    for (int decade = kLeastDecade; decade <= highest; ++decade) {
      const double ratio = std::pow(10.0, decade);
      html += "<path class=\"grid\" d=\"M" + pixels(kSparkLeft) + " " + pixels(y(ratio)) + "h" +
              pixels(kSparkWidth) + "\"/>";
      if (decade != 0 && decade != highest) continue;
      html += "<text x=\"" + pixels(kSparkLeft - 5.0) + "\" y=\"" + pixels(y(ratio) + 4.0) + "\">" +
              (decade > 3 ? "1e" + std::to_string(decade) : exact_text(ratio)) + "</text>";
    }
    return html;
  }

  std::string band(const Interval& bounds, double dimension) const {
    const double top = y(bounds.upper / dimension);
    return "<rect class=\"band\" x=\"" + pixels(kSparkLeft) + "\" y=\"" + pixels(top) +
           "\" width=\"" + pixels(kSparkWidth) + "\" height=\"" +
           pixels(y(bounds.lower / dimension) - top) + "\"/>";
  }

  /// Draws bars below the eighths of the drive in which a deviation is shown; if there are none,
  /// below the scans in which one is shown.
  std::string bars(const Verdict& verdict) const {
    for (const Family family : {Family::stretch, Family::scan}) {
      const FamilyTest* test = verdict.find(family);
      std::string html = test == nullptr ? "" : bars_of(*test);
      if (!html.empty()) return html;
    }
    return "";
  }

  /// Draws bars for one family, with the first and the last time unless these are the ends of the
  /// drive.
  std::string bars_of(const FamilyTest& test) const {
    constexpr double kLeastWidth = 2.0;
    const bool is_scan = test.family == Family::scan;
    const auto& all = test.members;
    const auto words = [&](double t) {
      const double since = t - all.front().origin;
      return is_scan ? fixed_seconds(since) : clock_text(since);
    };
    std::string path, from, to;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!test.is_shown(all[k])) continue;
      const bool is_last = k + 1 == all.size();
      const double left = x(all[k].from), right = x(is_last ? all[k].to : all[k + 1].from);
      if (path.empty() && k > 0) from = text_at(all[k].from, words(all[k].from), "from");
      to = is_last || is_scan ? "" : text_at(all[k].to, words(all[k].to), "to");
      path += "M" + pixels(left) + " " + pixels(kSparkHeight + 9.0) + "H" +
              pixels(std::max(right, left + kLeastWidth));
    }
    return path.empty() ? "" : "<path class=\"shown\" d=\"" + path + "\"/>" + from + to;
  }

  std::string text_at(double time, const std::string& words, const std::string& side) const {
    return "<text class=\"" + side + "\" x=\"" + pixels(x(time)) + "\" y=\"" +
           pixels(kSparkHeight + 21.0) + "\">" + words + "</text>";
  }
};

std::string spark_html(const StudyAnalysis& study, const CellAnalysis& cell, std::size_t style,
                       int highest) {
  const NeesSeries* series = judged_series(cell);
  if (series == nullptr || study.times.empty()) return "";
  constexpr std::size_t kSparkColumns = 80;
  const Sparkline line{highest, study.times.back()};
  const auto dimension = static_cast<double>(series->dimension);
  const Frame thinned =
      thin({{{"time", "s", study.times}, {"anees", "1", series->average}}}, kSparkColumns);
  const Interval bounds = nees_bounds(cell.complete, series->dimension, study.level);
  const std::string bars = line.bars(cell.verdict);
  return html_explained(
             std::string(study.imported.name_of_ratio()) + " from 0 to " +
                 readable(study.times.back()) + " s",
             html_paragraphs({prose("cards", "curve", {{"level", level_text(study.level)}})})) +
         "<svg class=\"spark\" role=\"img\" viewBox=\"0 0 " +
         pixels(kSparkLeft + kSparkWidth + 2.0) + " " +
         pixels(kSparkHeight + (bars.empty() ? 8.0 : 24.0)) +
         "\" aria-label=\"NEES ratio over time, at the end " +
         compact(series->average.back() / dimension) + "\">" + line.band(bounds, dimension) +
         line.grid() + "<path class=\"curve\" stroke=\"" + line_colour(style) + "\" d=\"" +
         line.path(thinned, dimension) + "\"/>" + bars + "</svg>\n";
}

/// HTML of a number with its name; empty if the number is not known.
std::string number_html(const std::string& name, const std::string& value,
                        const std::vector<std::string>& notes) {
  if (value == "-") return "";
  return html_explained(
      "<span class=\"name\">" + html_escape(name) + "</span> <b>" + html_escape(value) + "</b>",
      html_paragraphs(notes));
}

std::string rmse_html(const StudyAnalysis& study, const std::string& name, const MeanText& value) {
  std::vector<std::string> notes = {prose("cards", "rmse", {{"level", level_text(study.level)}})};
  if (!value.median.empty()) {
    notes.push_back(prose("cards", "heavy tail", {{"median", value.median}}));
  }
  return number_html(name, value.mean, notes);
}

std::vector<std::string> ratio_notes(const StudyAnalysis& study, const CellAnalysis& cell) {
  const double ratio = cell.verdict.ratio_estimate();
  std::vector<std::string> notes = {
      prose("cards", "deviations",
            {{"root", compact(std::sqrt(ratio))}, {"ratio", compact(ratio)}}),
      ratio_note(study)};
  if (cell.leading == Moments::corrected) {
    const std::string particles = std::to_string(cell.particles);
    notes.push_back(prose("cards", "particles", {{"particles", particles}}));
  }
  std::ranges::copy(cautions({&cell, 1}, study.imported), std::back_inserter(notes));
  return notes;
}

std::string numbers_html(const StudyAnalysis& study, const CellAnalysis& cell) {
  std::string html =
      number_html(study.imported.name_of_ratio(), ratio_text(cell), ratio_notes(study, cell));
  if (study.imported.is_imported() && study.imported.state != "pose") return html;
  return html +
         rmse_html(study, "position RMSE [m]", score_text(cell, "position_rmse", study.level)) +
         rmse_html(study, "heading RMSE [deg]",
                   score_text(cell, "heading_rmse", study.level, 180.0 / kPi));
}

std::string runs_html(const CellAnalysis& cell) {
  const std::string runs = "Runs: " + html_escape(runs_in_words(cell));
  return cell.failures.empty() ? "<p class=\"soft\">" + runs + "</p>\n"
                               : "<p class=\"bad\"><a href=\"#failures\">" + runs + "</a></p>\n";
}

std::string card_html(const StudyAnalysis& study, std::size_t i, int highest) {
  const CellAnalysis& cell = study.cells[i];
  const std::string answer = name_of(cell.verdict.answer);
  const std::string word = cell.verdict.answer == Answer::untested ? "not tested" : answer;
  return "<article class=\"card " + answer + "\">\n<h3>" + html_escape(cell.label) +
         "</h3>\n<p class=\"word\">" + word + "</p>\n" + runs_html(cell) +
         "<p class=\"sentence\">" + html_escape(sentence(cell.label, cell.verdict)) + "</p>\n" +
         numbers_html(study, cell) + spark_html(study, cell, i, highest) + "</article>\n";
}

}  // namespace

Section verdict_cards(const StudyAnalysis& study) {
  Section section{"cards", "Verdict"};
  if (!study.has_truth) return section;
  section.add(std::vector{ratio_note(study), answers_note(study)});
  section.add_html(html_paragraphs(imported_notes(study)));
  constexpr std::size_t kMany = 6;
  const int highest = highest_decade(study);
  std::string cards;
  for (std::size_t i = 0; i < study.cells.size(); ++i) cards += card_html(study, i, highest);
  section.add_html("<div class=\"cards" + std::string(study.cells.size() > kMany ? " many" : "") +
                   "\">\n" + cards + "</div>\n");
  return section;
}

}  // namespace montecarta::analysis
