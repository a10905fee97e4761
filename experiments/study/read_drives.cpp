// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/read_drives.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/recorded_drive.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScenario = "scenario";

/// Throws StudyError unless the drive has the reference that the study names.
void require_reference(const Settings& settings, const DriveLog& log) {
  const std::string& name = settings.text(kScenario, "reference");
  if (name.empty()) return;
  item_called(name, log.references, &ReferencePath::name,
              formatted("{}: reference = {} (the drive has none of that name)",
                        settings.place(kScenario, "reference"), name));
}

void require_same_drive(const Settings& settings, const std::string& expected,
                        const std::string& fingerprint, const fs::path& folder) {
  if (expected.empty() || expected == fingerprint) return;
  throw StudyError(
      "{}: the drive in {} is another one than the study was made with (its fingerprint is {}): "
      "give the same files, or remove data_sha256",
      settings.place(kScenario, "data_sha256"), folder, fingerprint);
}

/// The folders of recorded drives that the study names.
std::vector<std::string> paths_in(const Settings& settings, const fs::path& study_folder) {
  const std::string& path = settings.text(kScenario, "path");
  std::vector<std::string> paths = recordings_in(path, {study_folder});
  if (std::ranges::find(paths, "") == paths.end()) return paths;
  throw StudyError(
      "{}: path = {} names a folder that has no name (folders are separated by commas): write path "
      "= monday, tuesday",
      settings.place(kScenario, "path"), path);
}

/// Throws StudyError unless there is one run for each drive.
void require_runs_to_fit(const Settings& settings, std::size_t drives) {
  if (drives < 2 || settings.count("study", "runs") == drives) return;
  throw StudyError(
      "{}: runs = {} with {} drives in scenario.path (each drive is one run): set runs = {}",
      settings.place("study", "runs"), settings.text("study", "runs"), drives, drives);
}

/// The fingerprint of each drive as stored in the study; empty texts if it has none.
std::vector<std::string> expected_fingerprints(const Settings& settings, std::size_t drives) {
  const std::string& text = settings.text(kScenario, "data_sha256");
  if (text.empty()) return std::vector<std::string>(drives);
  std::vector<std::string> expected = split(text, ',');
  if (expected.size() == drives) return expected;
  throw StudyError(
      "{}: {} fingerprints of {} drives (the study was made with as many drives as it has "
      "fingerprints): name as many folders in scenario.path, in the same order, or remove "
      "data_sha256",
      settings.place(kScenario, "data_sha256"), expected.size(), drives);
}

/// Refuses a drive that is listed twice, because it would count as two independent ones.
void refuse_drive_again(const Settings& settings, const std::vector<std::string>& paths,
                        const std::vector<std::string>& fingerprints) {
  for (std::size_t k = 0; k < fingerprints.size(); ++k) {
    const auto first = std::ranges::find(fingerprints, fingerprints[k]) - fingerprints.begin();
    if (static_cast<std::size_t>(first) == k) continue;
    throw StudyError(
        "{}: {} holds the drive of {} again (a drive that counts twice makes any verdict too "
        "certain): remove one",
        settings.place(kScenario, "path"), paths[k], paths[static_cast<std::size_t>(first)]);
  }
}

}  // namespace

RecordedDrives read_drives_of(Settings& settings, const fs::path& study_folder) {
  const std::vector<std::string> paths = paths_in(settings, study_folder);
  require_runs_to_fit(settings, paths.size());
  const std::vector<std::string> expected = expected_fingerprints(settings, paths.size());
  RecordedDrives drives;
  std::vector<std::string> fingerprints;
  for (std::size_t k = 0; k < paths.size(); ++k) {
    const fs::path folder = at_place(settings.place(kScenario, "path"),
                                     [&] { return find_recording(paths[k], {study_folder}); });
    DriveLog log = read_log_csv(folder);
    fingerprints.push_back(fingerprint_of(log));
    require_same_drive(settings, expected[k], fingerprints.back(), folder);
    require_reference(settings, log);
    drives.logs.push_back(std::make_shared<const DriveLog>(std::move(log)));
    drives.folders.push_back(fs::absolute(folder));
  }
  refuse_drive_again(settings, paths, fingerprints);
  settings.replace(kScenario, "data_sha256", joined(fingerprints));
  settings.replace(kScenario, "path", "log");
  return drives;
}

std::size_t identities_in(const DriveLog& log) {
  std::int32_t last = -1;
  for (const LoggedScan& scan : log.scans) {
    for (const Detection& detection : scan.detections) last = std::max(last, detection.identity);
  }
  return last < 0 ? 0 : static_cast<std::size_t>(last) + 1;
}

}  // namespace montecarta::experiments
