// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/result_layout.hpp"

#include "engine/records/columns.hpp"
#include "engine/records/h5.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/doubles/scripted_result.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace montecarta::engine {
namespace {

std::string type_name(const h5::Handle& dataset) {
  const auto element = h5::element(dataset);
  if (!element) return "text";
  constexpr const char* names[] = {"f64", "u8", "u16", "u32", "u64"};
  return names[static_cast<std::size_t>(*element)];
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
    out << path << "/" << name << " " << type_name(dataset);
    for (auto length : h5::shape(dataset)) out << " x " << length;
    out << (h5::is_scale(dataset) ? " (scale)\n" : "\n");
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
  kalman.mixture = false;
  kalman.joint = true;
  kalman.rotation_information = true;
  Cell imported;
  imported.label = imported.filter = "imported";
  imported.error_components = 3;
  imported.several_conventions = true;
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
      return is_selected(kind, plan.columns) && (kind.applies == nullptr || kind.applies(cell));
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
    if (!h5::is_scale(dataset)) {
      EXPECT_EQ(h5::text(dataset, "dimension_order").substr(0, 3), "run") << name;
    }
    EXPECT_TRUE(h5::place(dataset)) << name << " must lie in one piece";
  }
}

}  // namespace
}  // namespace montecarta::engine
