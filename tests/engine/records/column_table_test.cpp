// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/columns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

namespace montecarta::engine {
namespace {

using testing::HasSubstr;

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

TEST(ColumnTable, HasEveryNameOnceAndKnownGroups) {
  std::set<std::string> names;
  for (const ColumnKind& kind : column_table()) {
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
    EXPECT_NO_THROW(is_selected(kind, {})) << kind.name;
  }
}

TEST(AxisNames, AreReadBack) {
  for (const ColumnKind& kind : column_table()) {
    for (const Axis axis : kind.axes) EXPECT_EQ(axis_named(name_of(axis)), axis);
  }
  EXPECT_EQ(axis_named("colour"), std::nullopt);
}

}  // namespace
}  // namespace montecarta::engine
