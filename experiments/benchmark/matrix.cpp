// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/benchmark/matrix.hpp"

#include "engine/formatted.hpp"
#include "engine/text/number_text.hpp"
#include "experiments/benchmark/benchmark_study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>

namespace montecarta::experiments {
namespace {

/// NEES ratio from which on a number says no more than that runs diverged.
constexpr double kDiverged = 1e4;

constexpr VerdictClass kClassConsistent = {"consistent", "=", "#b7dfc0"};
constexpr VerdictClass kClassSlight = {"slightly off", "~", "#f6e3a1"};
constexpr VerdictClass kClassOptimistic = {"optimistic", "+", "#ef8a76"};
constexpr VerdictClass kClassConservative = {"conservative", "-", "#92bfe4"};
constexpr VerdictClass kClassInconsistent = {"inconsistent otherwise", "!", "#c9a3d6"};
constexpr VerdictClass kClassUndecided = {"undecided: more runs are needed", "?", "#e3e3e3"};
constexpr VerdictClass kClassUntested = {"untested", "*", "#ffffff"};

using EntriesByPlace = std::map<std::pair<std::string, std::string>, const ArchiveEntry*>;

const ArchiveEntry* find(const EntriesByPlace& entries, const std::string& label,
                         const std::string& world) {
  const auto found = entries.find({label, world});
  return found == entries.end() ? nullptr : found->second;
}

/// {filter} The shipped filters that have entries, then others.
std::vector<BenchmarkFilter> filters_of(const std::vector<ArchiveEntry>& entries) {
  std::map<std::string, std::string> cells;
  for (const ArchiveEntry& entry : entries) cells.emplace(entry.label, entry.cell);
  std::vector<BenchmarkFilter> filters;
  for (const BenchmarkFilter& shipped : benchmark_filters()) {
    if (cells.erase(shipped.label) > 0) filters.push_back(shipped);
  }
  for (const auto& [label, cell] : cells) filters.push_back({label, cell});
  return filters;
}

Matrix::Place place_of(const EntriesByPlace& entries, const BenchmarkFilter& filter,
                       const std::string& world) {
  Matrix::Place place{.entry = find(entries, filter.label, world)};
  if (place.entry == nullptr) {
    place.suits = suits(world, filter.cell);
  } else if (const ArchiveEntry* smoother = find(entries, kSmootherLabel, world)) {
    place.relative_error = relative_error(*place.entry, *smoother);
  }
  return place;
}

/// A sentence that says that entries have different numbers of runs; "" if they have not.
std::string note_on_runs(const Matrix& matrix) {
  std::set<std::uint64_t> runs;
  for (const Matrix::Row& row : matrix.rows) {
    for (const Matrix::Place& place : row.places) {
      if (place.entry != nullptr) runs.insert(place.entry->runs);
    }
  }
  if (runs.size() < 2) return "";
  return formatted(
      " Filters have from {} to {} runs: 'montecarta compare FOLDER/WORLD/LABEL.h5 --archive' "
      "compares one with the others over the same runs.",
      *runs.begin(), *runs.rbegin());
}

std::string words_of(const ArchivedVerdict& verdict) {
  const std::string name = analysis::name_of(verdict.answer);
  if (verdict.answer == Answer::consistent)
    return formatted("{} within {}", name, readable(verdict.within));
  return verdict.is_slight ? "slightly " + name : name;
}

/// The name of a world as a heading: "sparse loop hard".
std::string words_of_world(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

}  // namespace

std::string ratio_text(double ratio) {
  if (std::isnan(ratio)) return "?";
  return ratio < 100.0 ? readable(ratio) : ratio < kDiverged ? readable(ratio, 2) : "> 1e4";
}

double relative_error(const ArchiveEntry& entry, const ArchiveEntry& reference) {
  double squares = 0.0, of_reference = 0.0;
  const std::vector<double>& left = entry.scores[kArchivedPositionRmse];
  const std::vector<double>& right = reference.scores[kArchivedPositionRmse];
  if (entry.drives_sha256 != reference.drives_sha256) return kNaN;
  for (std::size_t i = 0; i < std::min(left.size(), right.size()); ++i) {
    if (std::isnan(left[i]) || std::isnan(right[i])) continue;
    squares += left[i] * left[i];
    of_reference += right[i] * right[i];
  }
  return std::sqrt(squares / of_reference);
}

Matrix matrix_of(const std::vector<ArchiveEntry>& entries) {
  EntriesByPlace by_place;
  std::set<std::string> worlds;
  for (const ArchiveEntry& entry : entries) {
    by_place[{entry.label, entry.world}] = &entry;
    worlds.insert(entry.world);
  }
  Matrix matrix{.worlds = {worlds.begin(), worlds.end()}, .rows = {}};
  for (const BenchmarkFilter& filter : filters_of(entries)) {
    Matrix::Row& row = matrix.rows.emplace_back(Matrix::Row{filter.label, {}});
    for (const std::string& world : matrix.worlds)
      row.places.push_back(place_of(by_place, filter, world));
  }
  return matrix;
}

const VerdictClass& class_of(const ArchivedVerdict& verdict) {
  if (verdict.is_slight) return kClassSlight;
  switch (verdict.answer) {
    case Answer::consistent:
      return kClassConsistent;
    case Answer::optimistic:
      return kClassOptimistic;
    case Answer::conservative:
      return kClassConservative;
    case Answer::inconsistent:
      return kClassInconsistent;
    case Answer::undecided:
      return kClassUndecided;
    case Answer::untested:
      break;
  }
  return kClassUntested;
}

std::vector<VerdictClass> verdict_classes() {
  return {kClassConsistent,   kClassSlight,    kClassOptimistic, kClassConservative,
          kClassInconsistent, kClassUndecided, kClassUntested};
}

TextTable ratio_table(const Matrix& matrix) {
  TextTable table;
  for (const Matrix::Row& row : matrix.rows) {
    std::vector<TextTable::Entry> entries = {{"filter", row.label, Align::left}};
    for (std::size_t w = 0; w < matrix.worlds.size(); ++w) {
      const Matrix::Place& place = row.places[w];
      const std::string none = place.suits ? "none" : "-";
      entries.push_back({words_of_world(matrix.worlds[w]),
                         place.entry == nullptr ? none
                                                : ratio_text(place.entry->verdict.ratio) + ' ' +
                                                      class_of(place.entry->verdict).mark});
    }
    table.add(entries);
  }
  return table;
}

std::string legend_text(const Matrix& matrix) {
  std::string text = "NEES ratio, 1 if errors are as large as claimed.";
  for (const VerdictClass& one : verdict_classes())
    text += formatted("{}{} {}", one.mark == verdict_classes().front().mark ? " " : ", ", one.mark,
                      one.name);
  const auto has = [&](bool suits) {
    return std::ranges::any_of(matrix.rows, [&](const Matrix::Row& row) {
      return std::ranges::any_of(row.places, [&](const Matrix::Place& place) {
        return place.entry == nullptr && place.suits == suits;
      });
    });
  };
  text += ".";
  if (has(false)) text += " A dash: the world does not suit the filter.";
  if (has(true)) text += " none: not computed.";
  return text + note_on_runs(matrix);
}

TextTable world_table(const Matrix& matrix, std::size_t world) {
  const bool has_smoother = std::ranges::any_of(matrix.rows, [&](const Matrix::Row& row) {
    return std::isfinite(row.places[world].relative_error);
  });
  TextTable table;
  for (const Matrix::Row& row : matrix.rows) {
    const auto& [entry, suits, relative] = row.places[world];
    if (entry == nullptr) continue;
    std::vector<TextTable::Entry> entries = {
        {"filter", row.label, Align::left},
        {"verdict", words_of(entry->verdict), Align::left},
        {formatted("NEES ratio [{}]", level_text(entry->verdict.level)),
         entry->verdict.ratio >= kDiverged
             ? ratio_text(entry->verdict.ratio)
             : with_interval(entry->verdict.ratio, entry->verdict.interval)},
        {"RMSE [m]", readable(entry->position_rmse())},
        {"CPU/run [ms]", readable(1e3 * entry->cpu_seconds, 2)},
        {"runs", entry->failed == 0 ? std::to_string(entry->runs)
                                    : formatted("{}, {} FAILED", entry->runs, entry->failed)}};
    if (has_smoother)
      entries.insert(entries.begin() + 4, {"of the smoother's", readable(relative)});
    table.add(entries);
  }
  return table;
}

Frame matrix_frame(const Matrix& matrix) {
  Frame frame;
  for (std::size_t w = 0; w < matrix.worlds.size(); ++w) {
    for (const Matrix::Row& row : matrix.rows) {
      const auto& [entry, suits, relative] = row.places[w];
      if (entry == nullptr) continue;
      frame.add({{"world", entry->world},
                 {"filter", entry->label},
                 {"verdict", analysis::name_of(entry->verdict.answer)},
                 {"slight", "1", entry->verdict.is_slight ? 1.0 : 0.0},
                 {"nees_ratio", "1", entry->verdict.ratio},
                 {"interval_lower", "1", entry->verdict.interval.lower},
                 {"interval_upper", "1", entry->verdict.interval.upper},
                 {"position_rmse", "m", entry->position_rmse()},
                 {"relative_to_smoother", "1", relative},
                 {"cpu_seconds", "s", entry->cpu_seconds},
                 {"runs", "1", static_cast<double>(entry->runs)},
                 {"failed", "1", static_cast<double>(entry->failed)}});
    }
  }
  return frame;
}

}  // namespace montecarta::experiments
