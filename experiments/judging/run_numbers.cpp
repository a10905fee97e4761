// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/run_numbers.hpp"

#include "engine/text/list_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <optional>
#include <set>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

/// Words before the number of a run, those before numbers that a cluster gives to runs, and that
/// before the number of a whole batch. Words of an earlier list come first.
const std::array<std::vector<std::string>, 3> kWords = {{
    {"run", "seed", "trial", "rep", "repetition", "mc", "sim", "sample", "realization",
     "realisation", "iteration", "episode"},
    {"task", "proc", "process", "rank", "array", "worker", "thread", "node"},
    {"job"},
}};

/// A number in a path.
struct NumberSlot {
  std::uint64_t value = 0;
  std::string word;       ///< letters before it, in lower case
  std::size_t part = 0;   ///< index of the folder, or of the file behind the folders
  std::size_t begin = 0;  ///< first of its digits in the part
  std::size_t end = 0;
};

/// A path in parts, with its numbers.
struct ParsedPath {
  std::vector<std::string> parts;  ///< folders, then the file without ending
  std::vector<NumberSlot> slots;
  std::string pattern;  ///< the path with # instead of each number
};

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }
bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_separator(char c) { return c == '_' || c == '-' || c == '.' || c == '='; }

/// Whether the character at `i` divides numbers: a separator, or the T of 2024-01-02T10-20-30.
bool divides(std::string_view part, std::size_t i) {
  const bool is_time = part[i] == 'T' && i > 0 && i + 1 < part.size() && is_digit(part[i - 1]) &&
                       is_digit(part[i + 1]);
  return is_time || is_separator(part[i]);
}

/// Rank of a word in kWords; its size for other words.
std::size_t rank_of(const std::string& word) {
  const auto list = std::ranges::find_if(kWords, [&](const std::vector<std::string>& words) {
    return std::ranges::find(words, word) != words.end();
  });
  return static_cast<std::size_t>(list - kWords.begin());
}

/// The letters that end `text`, in lower case.
std::string last_word(std::string_view text) {
  std::size_t begin = text.size();
  while (begin > 0 && is_letter(text[begin - 1])) --begin;
  std::string word(text.substr(begin));
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
  return word;
}

std::string_view without_last_separators(std::string_view text) {
  while (!text.empty() && is_separator(text.back())) text.remove_suffix(1);
  return text;
}

/// The number at `begin` in a part, if it stands by itself or behind a word of runs: 12 in "12",
/// "run_12", "run12" and "ekf_12", none in "ekf2" and "3rd".
std::optional<NumberSlot> slot_at(const std::string& part, std::size_t begin) {
  std::size_t end = begin;
  while (end < part.size() && is_digit(part[end])) ++end;
  const std::string_view before = std::string_view(part).substr(0, begin);
  const bool is_apart = before.empty() || divides(part, begin - 1);
  NumberSlot slot{0, last_word(without_last_separators(before)), 0, begin, end};
  if (!is_apart && rank_of(slot.word) == kWords.size()) return std::nullopt;
  if (end < part.size() && !divides(part, end)) return std::nullopt;
  const auto value = to_count(part.substr(begin, end - begin));
  if (!value) return std::nullopt;
  slot.value = *value;
  return slot;
}

void add_part(const std::string& part, ParsedPath& path) {
  path.parts.push_back(part);
  path.pattern += '/';
  for (std::size_t k = 0; k < part.size();) {
    if (!is_digit(part[k])) {
      path.pattern += part[k++];
      continue;
    }
    auto slot = slot_at(part, k);
    const std::size_t begin = k;
    while (k < part.size() && is_digit(part[k])) ++k;
    if (!slot) {
      path.pattern += part.substr(begin, k - begin);
      continue;
    }
    slot->part = path.parts.size() - 1;
    path.slots.push_back(*slot);
    path.pattern = without_last_separators(path.pattern);
    path.pattern += '#';
  }
}

ParsedPath parsed(const fs::path& path) {
  ParsedPath result;
  for (const fs::path& part : path.parent_path().lexically_normal()) {
    add_part(part.string(), result);
  }
  add_part(path.stem().string(), result);
  return result;
}

using Group = std::vector<const ParsedPath*>;

/// {file} values of a slot in paths of one pattern.
std::vector<std::uint64_t> values_of(const Group& group, std::size_t slot) {
  std::vector<std::uint64_t> values;
  for (const ParsedPath* path : group) values.push_back(path->slots[slot].value);
  return values;
}

std::size_t distinct(const std::vector<std::uint64_t>& values) {
  return std::set(values.begin(), values.end()).size();
}

/// Number of different keys that slots give to the files of a group.
std::size_t distinct_keys(const Group& group, const std::vector<std::size_t>& slots) {
  std::set<RunKey> keys;
  for (const ParsedPath* path : group) {
    RunKey key;
    for (const std::size_t k : slots) key.push_back(path->slots[k].value);
    keys.insert(key);
  }
  return keys.size();
}

/// The slots before `last` in its part that only separators divide from it, if no word comes before
/// them, as in 123_4_0: a job, a task and a process.
std::vector<std::size_t> bare_numbers(const ParsedPath& path,
                                      const std::vector<std::size_t>& varying) {
  const std::size_t last = varying.back(), part = path.slots[last].part;
  std::vector<std::size_t> found;
  for (const std::size_t k : varying) {
    if (path.slots[k].part == part) found.push_back(k);
  }
  const std::string& text = path.parts[part];
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!is_digit(text[i]) && !divides(text, i)) return {last};
  }
  return found;
}

/// The slots that name the run, in the order of the path.
std::vector<std::size_t> slots_of_run(const Group& group) {
  const ParsedPath& path = *group.front();
  std::vector<std::size_t> varying, candidates;
  for (std::size_t k = 0; k < path.slots.size(); ++k) {
    candidates.push_back(k);
    if (distinct(values_of(group, k)) > 1) varying.push_back(k);
  }
  if (candidates.empty()) return {};
  const std::vector<std::size_t>& from = varying.empty() ? candidates : varying;
  std::vector<std::size_t> chosen;
  for (std::size_t rank = 0; rank < kWords.size() && chosen.empty(); ++rank) {
    for (const std::size_t k : from) {
      if (rank_of(path.slots[k].word) == rank) chosen.push_back(k);
    }
  }
  if (varying.empty()) {
    if (!chosen.empty()) return {chosen.back()};
    // The bare number of a folder counts other things than runs.
    const bool is_of_file = path.slots.back().part + 1 == path.parts.size();
    return is_of_file ? std::vector{candidates.back()} : std::vector<std::size_t>();
  }
  if (chosen.empty()) chosen = bare_numbers(path, varying);
  for (const std::size_t k : chosen) {  // one slot may be enough
    if (distinct_keys(group, {k}) == distinct_keys(group, chosen)) return {k};
  }
  return chosen;
}

/// Whether a slot does not name the estimator: every run has one value there, and it has a word of
/// runs, repeats the number of the run, or varies in the same part of the path.
bool goes_with_run(const Group& group, std::size_t slot, const std::vector<std::size_t>& run) {
  std::vector<std::size_t> both = run;
  both.push_back(slot);
  if (group.size() < 2 || distinct_keys(group, both) != distinct_keys(group, run)) return false;
  const NumberSlot& own = group.front()->slots[slot];
  if (rank_of(own.word) < kWords.size()) return true;
  if (distinct(values_of(group, slot)) < 2) return false;
  return std::ranges::any_of(run, [&](std::size_t k) {
    return group.front()->slots[k].part == own.part ||
           values_of(group, k) == values_of(group, slot);
  });
}

/// The parts of a path without some of its numbers, and without their words of runs.
std::vector<std::string> rest_of(const ParsedPath& path, const std::vector<std::size_t>& removed) {
  std::vector<std::string> parts = path.parts;
  for (std::size_t k = path.slots.size(); k-- > 0;) {
    if (std::ranges::find(removed, k) == removed.end()) continue;
    const NumberSlot& slot = path.slots[k];
    std::string& part = parts[slot.part];
    std::string_view before = without_last_separators(std::string_view(part).substr(0, slot.begin));
    if (rank_of(slot.word) < kWords.size()) before.remove_suffix(slot.word.size());
    std::string shorter(without_last_separators(before));
    shorter += part.substr(slot.end);
    part = shorter;
  }
  std::vector<std::string> rest;
  for (std::string& part : parts) {
    part.erase(0, std::min(part.find_first_not_of("_-."), part.size()));
    if (!part.empty()) rest.push_back(std::move(part));
  }
  return rest;
}

}  // namespace

std::string to_text(const RunKey& key) {
  std::string text;
  for (const std::uint64_t number : key) append_part(text, std::to_string(number), "/");
  return text;
}

std::vector<NumberedFile> numbered_files(const std::vector<fs::path>& paths) {
  std::vector<ParsedPath> all;
  for (const fs::path& path : paths) all.push_back(parsed(path));
  std::map<std::string, std::vector<std::size_t>> by_pattern;
  for (std::size_t i = 0; i < all.size(); ++i) by_pattern[all[i].pattern].push_back(i);
  std::vector<NumberedFile> files(paths.size());
  for (const auto& [pattern, members] : by_pattern) {
    Group group;
    for (const std::size_t i : members) group.push_back(&all[i]);
    const std::vector<std::size_t> run = slots_of_run(group);
    std::vector<std::size_t> removed = run;
    for (std::size_t k = 0; k < group.front()->slots.size(); ++k) {
      if (std::ranges::find(run, k) == run.end() && goes_with_run(group, k, run)) {
        removed.push_back(k);
      }
    }
    for (const std::size_t i : members) {
      files[i] = {paths[i], {}, rest_of(all[i], removed), false};
      for (const std::size_t k : run) {
        files[i].run.push_back(all[i].slots[k].value);
        files[i].is_called_run = all[i].slots[k].word == "run";
      }
    }
  }
  return files;
}

}  // namespace montecarta::experiments
