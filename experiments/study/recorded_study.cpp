// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/study/recorded_study.hpp"

#include "engine/errors.hpp"
#include "experiments/recordings/car_park.hpp"
#include "experiments/recordings/find_recording.hpp"
#include "experiments/recordings/log_csv.hpp"
#include "experiments/recordings/victoria_park.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

constexpr const char* kScenario = "scenario";

fs::path folder_of(const Settings& settings, const fs::path& study_folder) {
  const std::string& path = settings.text(kScenario, "path");
  try {
    return find_recording(path, {study_folder});
  } catch (const StudyError& error) {
    throw StudyError(settings.place(kScenario, "path") + ": " + error.what());
  }
}

DriveLog read_drive(const Settings& settings, const fs::path& folder) {
  const std::string kind = settings.scenario_kind();
  if (kind == "car_park") return read_car_park(folder);
  if (kind == "log") return read_log_csv(folder);
  const bool is_raw = settings.text(kScenario, "steering") == "raw";
  return read_victoria_park(folder, is_raw ? Steering::raw : Steering::calibrated);
}

/// The drive has the reference that the study judges by, if it names one.
void expect_reference(const Settings& settings, const DriveLog& log) {
  const std::string& name = settings.text(kScenario, "reference");
  if (name.empty()) return;
  std::vector<std::string> known;
  for (const ReferencePath& path : log.references) known.push_back(path.name);
  if (std::ranges::find(known, name) != known.end()) return;
  throw StudyError(settings.place(kScenario, "reference") + ": reference = " + name +
                   " (the drive has none of that name): " + nearest_spelling(name, known));
}

void expect_same_drive(const Settings& settings, const std::string& fingerprint,
                       const fs::path& folder) {
  const std::string& expected = settings.text(kScenario, "data_sha256");
  if (expected.empty() || expected == fingerprint) return;
  throw StudyError(settings.place(kScenario, "data_sha256") + ": the drive in " + folder.string() +
                   " is another one than the study was made with (its fingerprint is " +
                   fingerprint + "): give the same files, or remove data_sha256");
}

}  // namespace

std::shared_ptr<const DriveLog> read_drive_of(Settings& settings, const fs::path& study_folder) {
  const fs::path folder = folder_of(settings, study_folder);
  DriveLog log = read_drive(settings, folder);
  const std::string fingerprint = fingerprint_of(log);
  expect_same_drive(settings, fingerprint, folder);
  expect_reference(settings, log);
  settings.replace(kScenario, "data_sha256", fingerprint);
  settings.replace(kScenario, "path", settings.scenario_kind());
  return std::make_shared<const DriveLog>(std::move(log));
}

}  // namespace montecarta::experiments
