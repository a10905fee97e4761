// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/columns.hpp"
#include "engine/records/fingerprint.hpp"
#include "engine/records/h5.hpp"
#include "engine/records/provenance.hpp"
#include "engine/records/read_description.hpp"
#include "engine/records/result_format.hpp"
#include "engine/records/result_schema.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/matchers.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>

namespace montecarta::engine {
namespace {

bool is_scale(const h5::Handle& dataset) {
  return h5::find_text(dataset, "CLASS") == "DIMENSION_SCALE";
}

void list_attributes(const h5::Handle& object, const std::string& indent, std::ostream& out) {
  for (const auto& [name, value] : h5::texts(object)) {
    if (name != "CLASS" && name != "NAME") out << indent << "  @" << name << " = " << value << "\n";
  }
}

void list(const h5::Handle& group, const std::string& path, std::ostream& out) {
  out << path << "/\n";
  list_attributes(group, "", out);
  for (const std::string& name : h5::members(group)) {
    if (h5::is_group(group, name)) {
      list(h5::open_group(group, name), path + "/" + name, out);
      continue;
    }
    const h5::Handle dataset = h5::open_dataset(group, name);
    out << path << "/" << name << " " << (h5::element(dataset) ? h5::type_name(dataset) : "text");
    for (auto length : h5::shape(dataset)) out << " x " << length;
    out << (is_scale(dataset) ? " (scale)\n" : "\n");
    list_attributes(dataset, "", out);
  }
}

/// Every column there is, of a particle filter, a Kalman filter and an imported estimate.
StudyPlan plan_of_every_column() {
  StudyPlan plan = small_result_plan();
  plan.columns.association = true;
  plan.columns.final_map = true;
  plan.columns.joint = true;
  plan.columns.joint_scans = 2;
  plan.columns.observability = true;
  Cell& kalman = plan.cells[1];
  kalman.particles = 0;
  kalman.reports.mixture = false;
  kalman.reports.joint = true;
  kalman.reports.own_columns = {{"rotation_information", "observability", "rad-2",
                                 "information about the heading of the whole that detections since "
                                 "the start are taken for"}};
  Cell imported;
  imported.label = imported.filter = "imported";
  imported.imported = ImportedError{.components = 3,
                                    .has_innovations = true,
                                    .conventions = kErrorConventions.size(),
                                    .has_pose = true};
  plan.cells.push_back(imported);
  return plan;
}

std::string version_of(const h5::Handle& file) {
  const auto version = h5::numbers(file, "format_version");
  return std::to_string(version.at(0)) + "." + std::to_string(version.at(1));
}

/// Renewed on purpose only: MONTECARTA_UPDATE_GOLDEN=1 rewrites and fails.
TEST(ResultLayout, IsThatOfTheGoldenFile) {
  const std::filesystem::path golden =
      std::filesystem::path(MONTECARTA_SOURCE_DIR) / "tests/engine/records/golden/result.txt";
  const ScratchFolder folder;
  lay_out(folder / "out.h5", describe(plan_of_every_column(), {{"host", "nowhere"}}));
  const h5::Handle file = h5::open_file(folder / "out.h5");
  std::ostringstream listing;
  listing << "version " << version_of(file) << "\n";
  list(file, "", listing);
  if (std::getenv("MONTECARTA_UPDATE_GOLDEN") != nullptr) {
    std::ofstream(golden) << listing.str();
    FAIL() << golden
           << " was rewritten: look at the difference, then test again without "
              "MONTECARTA_UPDATE_GOLDEN";
  }
  std::ifstream stream(golden);
  const std::string expected((std::istreambuf_iterator<char>(stream)), {});
  EXPECT_EQ(listing.str(), expected) << "the format changed: raise its version (analysis/FORMAT.md "
                                        "says which part), then renew the golden file";
}

TEST(ResultLayout, TheGoldenFileHasEveryColumn) {
  const StudyPlan plan = plan_of_every_column();
  for (const ColumnKind& kind : column_table()) {
    const bool is_there = std::ranges::any_of(plan.cells, [&](const Cell& cell) {
      return is_selected(kind.group, plan.columns) &&
             (kind.applies == nullptr || kind.applies(cell));
    });
    EXPECT_TRUE(is_there) << kind.name;
  }
}

TEST(ResultLayout, EveryNumberHasUnitNameAndAxes) {
  const ScratchFolder folder;
  const StudyPlan plan = small_result_plan();
  lay_out(folder / "out.h5", describe(plan, {}));
  const h5::Handle file = h5::open_file(folder / "out.h5");
  const h5::Handle cell = h5::open_group(file, "cells/scripted_m4");
  for (const std::string& name : h5::members(cell)) {
    if (name == "settings") continue;
    const h5::Handle dataset = h5::open_dataset(cell, name);
    EXPECT_FALSE(h5::text(dataset, "units").empty()) << name;
    EXPECT_FALSE(h5::text(dataset, "long_name").empty()) << name;
    if (!is_scale(dataset)) {
      EXPECT_EQ(h5::text(dataset, "dimension_order").substr(0, 3), "run") << name;
    }
    EXPECT_TRUE(h5::place(dataset)) << name << " must lie in one piece";
  }
}

/// The row of a table of FORMAT.md that describes a column; empty where there is none.
std::string described(const std::string& column) {
  std::ifstream file(std::filesystem::path(MONTECARTA_SOURCE_DIR) / "analysis/FORMAT.md");
  for (std::string line; std::getline(file, line);) {
    const std::size_t end = line.find(" | ", 2);
    const bool is_row = line.starts_with("| ") && end != std::string::npos;
    if (is_row && line.substr(0, end).find("`" + column + "`") != std::string::npos) return line;
  }
  return {};
}

TEST(ColumnTable, IsThatOfTheFormat) {
  for (const ColumnKind& kind : column_table()) {
    const std::string row = described(kind.name);
    ASSERT_FALSE(row.empty()) << kind.name << " is not in analysis/FORMAT.md";
    std::string axes = "{run";
    for (const Axis axis : kind.axes) axes += ", " + std::string(name_of(axis));
    EXPECT_THAT(row, HasSubstr(axes + "}"));
    EXPECT_THAT(row, HasSubstr("| " + std::string(kind.units) + " |"));
    const bool is_chosen = std::string(kind.group) != "pose";
    EXPECT_EQ(row.starts_with("| + "), is_chosen) << row;
  }
}

/// The complaint about an HDF5 file of this type and version that holds nothing else.
std::string said_of(const std::string& filetype, std::uint64_t major) {
  const ScratchFolder folder;
  const h5::Handle file = h5::create_file(folder / "some.h5");
  h5::put_text(file, "filetype", filetype);
  h5::put_numbers(file, "format_version", std::array{major, format::kMinor});
  return complaint_of([&] { read_description(file, "some.h5"); });
}

TEST(ReadDescription, RefusesFilesOfOthersAndOfOtherMajorVersions) {
  const std::string ours(format::kFiletype);
  EXPECT_THAT(said_of("somebody's", format::kMajor), HasSubstr("some.h5: not a montecarta result"));
  EXPECT_THAT(said_of(ours, format::kMajor + 1), HasSubstr("some.h5: format version 2 (this"));
  EXPECT_THROW(said_of(ours, format::kMajor), RunError) << "of a known version, but empty";
}

TEST(Provenance, KnowsBuildAndMachine) {
  const TextPairs pairs = collect_provenance();
  const std::map<std::string, std::string> facts(pairs.begin(), pairs.end());
  for (const auto& [name, value] : facts) EXPECT_FALSE(value.empty()) << name;
  EXPECT_THAT(facts.at("date"), ::testing::MatchesRegex("20..-..-..T..:..:..Z"));
  EXPECT_THAT(facts.at("git"), ::testing::MatchesRegex("unknown|[0-9a-f]{40}(-dirty)?"));
  EXPECT_THAT(facts.at("flags"), ::testing::HasSubstr("-ffp-contract=off"));
  EXPECT_THAT(facts.at("version"), ::testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
}

TEST(Sha256, KnownAnswers) {  // FIPS 180-2, appendix B.1, and the empty text
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

}  // namespace
}  // namespace montecarta::engine
