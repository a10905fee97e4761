// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/run_files.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/judging/run_numbers.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <map>
#include <set>
#include <span>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// Largest number of runs, as in a study.
constexpr std::uint64_t kMostRuns = 10'000'000;

/// The number in the name of a single truth or of its folder. With a number, the truth belongs to
/// that run only.
RunKey own_run_of(const fs::path& path) {
  RunKey by_name = numbered_files({path.filename()}).front().run;
  const fs::path folder = path.parent_path().filename();
  if (!by_name.empty() || !folder.string().starts_with("run")) return by_name;
  return numbered_files({folder / "truth.csv"}).front().run;
}

/// The files that an argument of --truth stands for.
std::vector<fs::path> truths_in(const std::string& word) {
  std::error_code ignored;
  const auto is_folder = [&](const fs::path& path) { return fs::is_directory(path, ignored); };
  if (!is_folder(word)) return {word};
  const fs::path inner = fs::path(word) / "truth";
  const fs::path folder = is_folder(inner) ? inner : fs::path(word);
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end;
       entry.increment(ignored)) {
    const fs::path file = entry->path() / "reference.csv";
    std::error_code missing;
    if (fs::is_regular_file(file, missing)) files.push_back(file);
  }
  std::ranges::sort(files);
  if (!files.empty()) return files;
  throw StudyError(word +
                   ": no truth in it (a folder of 'montecarta export' has "
                   "truth/run_0000/reference.csv, ...): name that folder, or the files themselves");
}

using FilesByRun = std::map<RunKey, fs::path>;

enum class RunFile : std::uint8_t { estimate, truth };

void add_run(const NumberedFile& file, RunFile kind, FilesByRun& files) {
  const bool is_truth = kind == RunFile::truth;
  if (file.run.empty()) {
    throw StudyError(
        "{}: has no run number (neither the file nor a folder is named after one; a number behind "
        "other letters belongs to the name): name it or its folder e.g. {}",
        file.path,
        is_truth ? "run_0007"
                 : "run_0007 or ekf_7, or give --cell NAME if all are runs of one estimator");
  }
  const auto [there, is_new] = files.try_emplace(file.run, file.path);
  if (is_new) return;
  throw StudyError("{}: run {} again ({} has the same number{}): {}", file.path, to_text(file.run),
                   there->second, is_truth ? "" : " and the same estimator",
                   is_truth ? "give each truth the number of its run"
                            : "give each run a number, each estimator a folder or a name, or "
                              "--cell NAME if all are runs of one estimator");
}

/// The words in which a cell's path differs from those of the other cells, joined to a label.
std::string label_of(const std::vector<std::string>& rest,
                     const std::vector<std::vector<std::string>>& all) {
  if (all.size() == 1) return rest.empty() ? "estimate" : rest.back();
  const auto is_common = [&](std::size_t k, bool from_the_end) {
    return std::ranges::all_of(all, [&](const std::vector<std::string>& other) {
      if (k >= other.size()) return false;
      return from_the_end ? other[other.size() - 1 - k] == rest[rest.size() - 1 - k]
                          : other[k] == rest[k];
    });
  };
  std::size_t first = 0, last = 0;
  while (first < rest.size() && is_common(first, false)) ++first;
  while (last + first < rest.size() && is_common(last, true)) ++last;
  const std::vector<std::string> own(rest.begin() + static_cast<std::ptrdiff_t>(first),
                                     rest.end() - static_cast<std::ptrdiff_t>(last));
  return own.empty() ? "estimate" : joined(own, "_");
}

std::map<std::string, FilesByRun> cells_of(const std::vector<NumberedFile>& files,
                                           const std::optional<std::string>& cell) {
  std::map<std::vector<std::string>, FilesByRun> by_path;
  for (const NumberedFile& file : files) {
    add_run(file, RunFile::estimate, by_path[cell ? std::vector<std::string>{*cell} : file.rest]);
  }
  std::vector<std::vector<std::string>> paths;
  for (const auto& [path, runs] : by_path) paths.push_back(path);
  std::map<std::string, FilesByRun> cells;
  for (auto& [path, runs] : by_path) {
    const std::string label = label_of(path, paths);
    check_label(label);
    if (!cells.try_emplace(label, std::move(runs)).second) {
      throw StudyError(label +
                       ": two estimators would have this name: put each into a folder of "
                       "its own name");
    }
  }
  return cells;
}

void require_same_runs(const FilesByRun& wanted, const FilesByRun& given, const std::string& of,
                       const std::string& remedy) {
  for (const auto& [run, file] : wanted) {
    if (given.contains(run)) continue;
    const auto runs_of = [](const FilesByRun& files) {
      return std::to_string(files.size()) + (files.size() == 1 ? " run" : " runs");
    };
    throw StudyError("{}: run {} has no {} ({} there, {} here): {}", file, to_text(run), of,
                     runs_of(wanted), runs_of(given), remedy);
  }
}

/// Whether keys are numbers of runs without a gap. Throws StudyError if they have a gap, but are
/// numbers of runs: most are there, and they start at 0 or 1 or are called runs.
bool are_consecutive(const FilesByRun& runs, bool are_called_runs) {
  const bool are_numbers = std::ranges::all_of(
      runs, [](const auto& run) { return run.first.size() == 1 && run.first[0] < kMostRuns; });
  if (!are_numbers) return false;
  const std::uint64_t first = runs.begin()->first[0];
  const std::uint64_t span = runs.rbegin()->first[0] - first + 1;
  if (span == runs.size()) return true;
  if (2 * runs.size() <= span || (first > 1 && !are_called_runs)) return false;
  std::uint64_t next = first;
  for (const auto& [run, file] : runs) {
    if (run[0] == next) {
      ++next;
      continue;
    }
    const std::uint64_t last = run[0] - 1;
    throw StudyError(
        "{}: {} missing (run numbers must be consecutive; a failed run is a result): give a failed "
        "run the file that it wrote, the header at least",
        file,
        next == last ? formatted("run {} is", next) : formatted("runs {} to {} are", next, last));
  }
  return true;
}

/// All files that --truth names.
std::vector<fs::path> all_truths(const std::vector<std::string>& truths) {
  std::vector<fs::path> files;
  for (const std::string& word : truths) {
    for (fs::path& file : truths_in(word)) files.push_back(std::move(file));
  }
  return files;
}

/// The truth of each run. `is_unnumbered` says that there is one estimate without a number.
FilesByRun truths_of(const FilesByRun& first, const std::vector<std::string>& truths,
                     bool is_unnumbered) {
  const std::vector<fs::path> truth_files = all_truths(truths);
  FilesByRun truth_of;
  if (truth_files.size() != 1) {
    for (const NumberedFile& file : numbered_files(truth_files))
      add_run(file, RunFile::truth, truth_of);
    return truth_of;
  }
  const RunKey of_run = own_run_of(truth_files.front());
  const bool is_of_all = of_run.empty() || (first.size() == 1 && is_unnumbered);
  for (const auto& [run, file] : first) {
    if (is_of_all || run == of_run) truth_of.emplace(run, truth_files.front());
  }
  return truth_of;
}

/// Whether each file has a run number that no other one has.
bool have_own_numbers(const std::vector<NumberedFile>& files) {
  std::set<RunKey> runs;
  for (const NumberedFile& file : files) runs.insert(file.run);
  return runs.size() == files.size() && !runs.contains(RunKey());
}

/// Files by the words in which their paths differ, e.g. MH_01_easy and V1_01_easy.
std::map<std::string, fs::path> by_words(const std::vector<fs::path>& paths) {
  std::vector<std::vector<std::string>> parts;
  for (const fs::path& path : paths) {
    std::vector<std::string>& own = parts.emplace_back();
    for (const fs::path& part : path.lexically_normal().parent_path()) own.push_back(part.string());
    own.push_back(path.stem().string());
  }
  std::map<std::string, fs::path> files;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const auto [there, is_new] = files.try_emplace(label_of(parts[k], parts), paths[k]);
    if (is_new) continue;
    throw StudyError("{}: is named twice ({} is it too): give each run once", paths[k],
                     there->second);
  }
  return files;
}

/// The runs of one estimator by their names, each with the truth of its name or that of all.
JudgedFiles pair_by_words(const std::vector<fs::path>& estimates,
                          const std::vector<fs::path>& truths, const std::string& cell) {
  JudgedFiles judged;
  EstimatorFiles& one = judged.cells.emplace_back(EstimatorFiles{cell, {}});
  const auto truth_of = by_words(truths);
  for (const auto& [name, file] : by_words(estimates)) {
    const auto truth = truth_of.size() == 1 ? truth_of.begin() : truth_of.find(name);
    if (!truths.empty() && truth == truth_of.end()) {
      throw StudyError(
          "{}: no truth is called {} (runs without numbers are paired by the words in which their "
          "paths differ): call files or folders of --truth like those of the estimates",
          file, excerpt(name));
    }
    judged.runs.push_back(judged.runs.size());
    judged.names.push_back(name);
    judged.truth.push_back(truths.empty() ? file : truth->second);
    one.of_run.push_back(file);
  }
  if (truth_of.size() <= 1 || truth_of.size() == judged.runs.size()) return judged;
  throw StudyError(
      "--truth: {} truths for {} runs (a failed run is a result): give a failed run the file that "
      "it wrote, the header at least; for fewer runs name only their truths",
      truth_of.size(), judged.runs.size());
}

/// The names of runs whose numbers are not consecutive, in the order in which they are numbered.
std::vector<std::string> names_of(const FilesByRun& runs) {
  std::vector<std::string> names;
  for (const auto& [run, file] : runs) names.push_back(to_text(run));
  return names;
}

}  // namespace

void check_label(const std::string& label, const std::string& remedy) {
  const bool is_good = std::ranges::all_of(label, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
  if (is_good && !label.empty() && label.size() <= 100 && label != "." && label != "..") return;
  throw StudyError("'{}' cannot label a cell (up to 100 letters, digits, _ - . can): {}",
                   excerpt(label), remedy);
}

JudgedFiles pair_files(const std::vector<std::string>& estimates,
                       const std::vector<std::string>& truths,
                       const std::optional<std::string>& cell) {
  std::vector<NumberedFile> files =
      numbered_files(std::vector<fs::path>(estimates.begin(), estimates.end()));
  if (cell) check_label(*cell, "give another --cell NAME");
  if (cell && files.size() > 1 && !have_own_numbers(files)) {
    return pair_by_words({estimates.begin(), estimates.end()}, all_truths(truths), *cell);
  }
  const bool is_unnumbered = files.size() == 1 && files.front().run.empty();
  if (is_unnumbered) files.front().run = {0};
  const std::map<std::string, FilesByRun> cells = cells_of(files, cell);
  const FilesByRun& first = cells.begin()->second;
  const bool are_called_runs = std::ranges::all_of(files, &NumberedFile::is_called_run);
  const bool has_numbers = are_consecutive(first, are_called_runs);
  const FilesByRun truth_of = truths.empty() ? first : truths_of(first, truths, is_unnumbered);
  require_same_runs(first, truth_of, "truth", "name its truth after --truth too");
  require_same_runs(truth_of, first, "estimate",
                    "give a failed run, which is a result, the file that it wrote, the header at "
                    "least; for fewer runs name only their truths");
  JudgedFiles judged;
  if (!has_numbers) judged.names = names_of(first);
  for (const auto& [run, file] : truth_of) {
    judged.runs.push_back(has_numbers ? run[0] : judged.runs.size());
    judged.truth.push_back(file);
  }
  const std::string remedy =
      "estimators are paired by run: judge the same runs of all, or give --cell NAME if all are "
      "runs of one estimator";
  for (const auto& [label, of_run] : cells) {
    require_same_runs(first, of_run, "estimate in cell " + label, remedy);
    require_same_runs(of_run, first, "estimate in cell " + cells.begin()->first, remedy);
    EstimatorFiles& one = judged.cells.emplace_back(EstimatorFiles{label, {}});
    for (const auto& [run, file] : of_run) one.of_run.push_back(file);
  }
  return judged;
}

JudgedFiles files_of_pair(const std::vector<std::string>& files) {
  if (files.size() != 2) return pair_files(files, {}, std::nullopt);
  const fs::path a = files[0], b = files[1];
  if (a == b) {
    throw StudyError(
        "--pair: {} is named twice (two estimators are compared): name the files of both", a);
  }
  const std::vector<NumberedFile> numbered = numbered_files({a, b});
  if (numbered[0].rest == numbered[1].rest) return pair_files(files, {}, std::nullopt);
  fs::path of_a = a, of_b = b;
  while (of_a.stem() == of_b.stem() && of_a.has_parent_path() && of_b.has_parent_path()) {
    of_a = of_a.parent_path();
    of_b = of_b.parent_path();
  }
  if (of_a.stem() == of_b.stem()) {
    throw StudyError(
        "--pair: {} and {} have the same names (two estimators are compared): give them other "
        "names",
        a, b);
  }
  JudgedFiles judged;
  judged.runs = {0};
  for (const auto& [of, file] : {std::pair(of_a, a), std::pair(of_b, b)}) {
    check_label(of.stem().string(), "rename the file or its folder");
    judged.cells.push_back({of.stem().string(), {file}});
  }
  judged.truth = judged.cells.back().of_run;
  return judged;
}

std::string note_on_names(const JudgedFiles& files) {
  constexpr std::size_t kMostNames = 8;  // shown
  if (files.names.empty()) return "";
  const std::size_t shown = std::min(files.names.size(), kMostNames);
  std::string names = joined(std::span(files.names).first(shown));
  if (shown < files.names.size()) names += ", ... to " + files.names.back();
  return formatted(
      "the names of the runs are no consecutive numbers ({}): in this order, the runs are called "
      "{} to {}",
      names, files.runs.front(), files.runs.back());
}

}  // namespace montecarta::experiments
