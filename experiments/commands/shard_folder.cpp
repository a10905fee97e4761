// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/commands/shard_folder.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/open_result.hpp"
#include "engine/records/posix_file.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/known_filters.hpp"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <system_error>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

fs::path plan_in(const fs::path& folder) { return folder / "plan.json"; }
fs::path study_in(const fs::path& folder) { return folder / "study.ini"; }

std::string json_text(const ShardPlan& plan) {
  const nlohmann::ordered_json json = {{"sha256", plan.study_sha256}, {"runs", plan.runs},
                                       {"cells", plan.cells},         {"shards", plan.shards},
                                       {"program", plan.program},     {"settings", plan.settings}};
  return json.dump(1) + "\n";
}

ShardPlan read_plan(const fs::path& folder) {
  const fs::path path = plan_in(folder);
  if (!is_there(path)) {
    throw StudyError(folder.string() +
                     ": holds no plan (no plan.json): begin with --study STUDY.ini --shards N");
  }
  try {
    const nlohmann::json json = nlohmann::json::parse(text_file(path));
    return {json.at("sha256"), json.at("runs"),    json.at("cells"),
            json.at("shards"), json.at("program"), json.at("settings")};
  } catch (const nlohmann::json::exception& error) {
    throw StudyError("{}: cannot be read ({}): work in another folder", path, error.what());
  }
}

/// Writes a file that gets its name only when it is complete. Keeps the one that is there: another
/// process writes the same, or require_same() sees the difference.
void write_whole(const fs::path& path, const std::string& text) {
  const fs::path draft = name_of_attempt(path);
  PosixFile file(draft, PosixFile::Mode::create);
  file.write_at(0, std::as_bytes(std::span(text)));
  file.sync();
  try {
    file.rename(path, Existing::refuse);
  } catch (const StudyError&) {
    fs::remove(draft);
  }
}

void require_same(const fs::path& folder, const ShardPlan& before, const ShardPlan& plan) {
  if (before.study_sha256 != plan.study_sha256) {
    throw StudyError(
        "{}: holds another study (SHA-256 {}, not {}: a setting, a world or --set differs): give "
        "the study as it was, or another folder",
        folder, before.study_sha256.substr(0, 12), plan.study_sha256.substr(0, 12));
  }
  if (before.shards == plan.shards) return;
  throw StudyError("--shards {}: {} is cut into {}: give --shards {}, or another folder",
                   plan.shards, folder, before.shards, before.shards);
}

/// Throws StudyError if a folder without a plan holds another study.ini than the one of the plan.
void require_own_study(const fs::path& folder, const std::string& text) {
  if (text_file(study_in(folder)) == text) return;
  throw StudyError(study_in(folder).string() +
                   ": is there without a plan.json and is not the text of this study (a file of "
                   "yours, or of a worker that was killed): move it away, or choose another "
                   "folder");
}

void make_folders(const fs::path& folder) {
  std::error_code failed;
  fs::create_directories(folder / "shards", failed);
  if (!failed) return;
  throw StudyError("{}: cannot be made ({}): choose a folder where you may write", folder,
                   failed.message());
}

std::string shard_name(std::uint64_t index) {
  const std::string number = std::to_string(index);
  return formatted("shard_{}{}.h5", std::string(4 - std::min<std::size_t>(4, number.size()), '0'),
                   number);
}

}  // namespace

ShardFolder::ShardFolder(fs::path folder) : folder_(std::move(folder)), plan_(read_plan(folder_)) {}

ShardFolder ShardFolder::make(const fs::path& folder, const Study& study, ShardPlan plan) {
  const std::string text = resolved_text(study);
  plan.study_sha256 = sha256(text);
  if (!is_there(plan_in(folder))) {
    make_folders(folder);
    write_whole(study_in(folder), text);
    require_own_study(folder, text);
    write_whole(plan_in(folder), json_text(plan));
  }
  ShardFolder made(folder);
  require_same(folder, made.plan_, plan);
  return made;
}

Study ShardFolder::study() const {
  Study study = read_study(study_in(folder_), known_filters(), plan_.settings);
  if (sha256(resolved_text(study)) == plan_.study_sha256) return study;
  throw StudyError(study_in(folder_).string() +
                   ": is not the study of plan.json (somebody changed it, or another version of "
                   "montecarta reads it otherwise): work in another folder");
}

std::vector<fs::path> ShardFolder::shards() const {
  std::vector<fs::path> paths;
  for (std::uint64_t i = 0; i < plan_.shards; ++i)
    paths.push_back(folder_ / "shards" / shard_name(i));
  return paths;
}

std::uint64_t ShardFolder::index_of(const fs::path& shard) const {
  const std::vector<fs::path> all = shards();
  return static_cast<std::uint64_t>(std::ranges::find(all, shard) - all.begin());
}

std::vector<fs::path> ShardFolder::missing() const {
  if (is_there(result())) return {};
  std::vector<fs::path> missing = shards();
  std::erase_if(missing, [](const fs::path& shard) { return is_there(shard); });
  return missing.empty() ? std::vector{result()} : missing;
}

}  // namespace montecarta::experiments
