// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/run_files.hpp"

#include "engine/errors.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <cctype>
#include <map>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

using RunNumber = std::optional<std::uint64_t>;

/// Largest number of runs, as in a study.
constexpr std::uint64_t kMostRuns = 10'000'000;

/// Number of the run in a name: 12 for "12", "run_12", "run12" and "ekf_12", nullopt for "ekf2" and
/// "estimate".
RunNumber run_in(const std::string& name) {
  const std::size_t end = name.find_last_not_of("0123456789");
  const std::size_t begin = end == std::string::npos ? 0 : end + 1;
  if (begin == name.size()) return std::nullopt;
  const std::string before = name.substr(0, begin);
  const bool is_apart = before.empty() || before.ends_with('_') || before.ends_with('-');
  if (!is_apart && before != "run") return std::nullopt;
  const RunNumber run = to_count(name.substr(begin));
  return run && *run < kMostRuns ? run : std::nullopt;
}

/// The file of one run, and the rest of its path.
struct FoundFile {
  fs::path path;
  RunNumber run;
  std::vector<std::string> rest;  ///< names of folders and file without the number of the run
};

FoundFile file_of_run(const fs::path& path) {
  FoundFile file{path, std::nullopt, {}};
  std::vector<std::string> names;
  for (const fs::path& part : path.parent_path().lexically_normal()) names.push_back(part.string());
  names.push_back(path.stem().string());
  for (std::size_t k = names.size(); k > 0 && !file.run; --k) {
    std::string& name = names[k - 1];
    file.run = run_in(name);
    if (!file.run) continue;
    name.erase(name.find_last_not_of("0123456789") + 1);
    while (name.ends_with('_') || name.ends_with('-')) name.pop_back();
    if (name == "run") name.clear();
  }
  for (std::string& name : names) {
    if (!name.empty()) file.rest.push_back(std::move(name));
  }
  return file;
}

/// Number of the run in the name of a single truth or of its folder. With a number, the truth
/// belongs to that run only.
RunNumber own_run_of(const fs::path& path) {
  const RunNumber by_name = run_in(path.stem().string());
  const std::string folder = path.parent_path().filename().string();
  return by_name || !folder.starts_with("run") ? by_name : run_in(folder);
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

using FilesByRun = std::map<std::uint64_t, fs::path>;

void add_run(const FoundFile& file, FilesByRun& files) {
  if (!file.run) {
    throw StudyError(file.path.string() +
                     ": has no run number (neither the file nor a folder is named after one): " +
                     "name it or its folder e.g. run_0007");
  }
  const auto [there, is_new] = files.try_emplace(*file.run, file.path);
  if (is_new) return;
  throw StudyError(file.path.string() + ": run " + std::to_string(*file.run) + " again (" +
                   there->second.string() + " has the same number and the same estimator): " +
                   "give each run a number, each estimator a folder or a name");
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

void check_label(const std::string& label) {
  const bool is_good = std::ranges::all_of(label, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
  });
  if (is_good && !label.empty() && label.size() <= 100 && label != "." && label != "..") return;
  throw StudyError("'" + excerpt(label) +
                   "' cannot label a cell (up to 100 letters, digits, _ - . can): rename the "
                   "folder, or give --cell NAME");
}

std::map<std::string, FilesByRun> cells_of(const std::vector<FoundFile>& files,
                                           const std::optional<std::string>& cell) {
  std::map<std::vector<std::string>, FilesByRun> by_path;
  for (const FoundFile& file : files) {
    add_run(file, by_path[cell ? std::vector<std::string>{*cell} : file.rest]);
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
    throw StudyError(file.string() + ": run " + std::to_string(run) + " has no " + of + " (" +
                     std::to_string(wanted.size()) + " runs there, " +
                     std::to_string(given.size()) + " here): " + remedy);
  }
}

void require_no_gap(const FilesByRun& runs) {
  const std::uint64_t first = runs.begin()->first;
  std::uint64_t next = first;
  for (const auto& [run, file] : runs) {
    if (run != next++) {
      throw StudyError(file.string() + ": runs " + std::to_string(next - 1) + " to " +
                       std::to_string(run - 1) +
                       " are missing (run numbers must be consecutive; a failed run is a "
                       "result): give a failed run the file that it wrote, the header at least");
    }
  }
}

/// The truth of each run. `is_unnumbered` says that there is one estimate without a number.
FilesByRun truths_of(const FilesByRun& first, const std::vector<std::string>& truths,
                     bool is_unnumbered) {
  std::vector<fs::path> truth_files;
  for (const std::string& word : truths) {
    for (fs::path& file : truths_in(word)) truth_files.push_back(std::move(file));
  }
  FilesByRun truth_of;
  for (const fs::path& file : truth_files) {
    if (truth_files.size() > 1) add_run(file_of_run(file), truth_of);
  }
  if (truth_files.size() == 1) {
    const RunNumber of_run = own_run_of(truth_files.front());
    const bool is_of_all = !of_run || (first.size() == 1 && is_unnumbered);
    for (const auto& [run, file] : first) {
      if (is_of_all || run == of_run) truth_of.emplace(run, truth_files.front());
    }
  }
  return truth_of;
}

}  // namespace

JudgedFiles pair_files(const std::vector<std::string>& estimates,
                       const std::vector<std::string>& truths,
                       const std::optional<std::string>& cell) {
  std::vector<FoundFile> files;
  for (const std::string& name : estimates) files.push_back(file_of_run(name));
  const bool is_unnumbered = files.size() == 1 && !files.front().run;
  if (is_unnumbered) files.front().run = 0;
  const std::map<std::string, FilesByRun> cells = cells_of(files, cell);
  const FilesByRun& first = cells.begin()->second;
  require_no_gap(first);
  const FilesByRun truth_of = truths_of(first, truths, is_unnumbered);
  require_same_runs(first, truth_of, "truth", "name its truth after --truth too");
  require_same_runs(truth_of, first, "estimate",
                    "give a failed run, which is a result, the file that it wrote, the header at "
                    "least; for fewer runs name only their truths");
  JudgedFiles judged;
  for (const auto& [run, file] : truth_of) {
    judged.runs.push_back(run);
    judged.truth.push_back(file);
  }
  for (const auto& [label, of_run] : cells) {
    require_same_runs(first, of_run, "estimate in cell " + label,
                      "estimators are paired by run: "
                      "judge the same runs of all");
    require_same_runs(of_run, first, "estimate in cell " + cells.begin()->first,
                      "estimators are paired by run: judge the same runs of all");
    EstimatorFiles& one = judged.cells.emplace_back(EstimatorFiles{label, {}});
    for (const auto& [run, file] : of_run) one.of_run.push_back(file);
  }
  return judged;
}

}  // namespace montecarta::experiments
