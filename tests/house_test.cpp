// SPDX-License-Identifier: BSD-3-Clause
// The laws of the house that a compiler does not enforce: who may include whom, sizes, licence
// lines.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;
using Tree = std::map<std::string, Lines>;  // path from the top, with '/', and what stands there
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::vector<std::string> kRooms = {"analysis",    "cluster", "engine",
                                         "experiments", "filters", "tests"};

Lines read_lines(const fs::path& path) {
  std::ifstream file(path);
  Lines lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

std::string room_of(const std::string& path) { return path.substr(0, path.find('/')); }

/// The library that a file belongs to: its room, but the models of vehicle and sensor, which are no
/// filter, are one of their own.
std::string library_of(const std::string& path) {
  return path.starts_with("filters/models/") ? "models" : room_of(path);
}

bool is_cpp(const std::string& path) { return path.ends_with(".cpp") || path.ends_with(".hpp"); }

bool is_script(const Lines& lines) { return !lines.empty() && lines[0].starts_with("#!"); }

bool is_source(const std::string& path, const Lines& lines) {
  return is_cpp(path) || path.ends_with("CMakeLists.txt") || path.ends_with(".py") ||
         path.ends_with(".js") || path.ends_with(".css") || is_script(lines);
}

/// Every source file below the rooms of the house.
Tree read_house(const fs::path& top) {
  Tree tree;
  for (const std::string& room : kRooms) {
    for (const auto& entry : fs::recursive_directory_iterator(top / room)) {
      if (!entry.is_regular_file()) continue;
      const std::string path = fs::relative(entry.path(), top).generic_string();
      Lines lines = read_lines(entry.path());
      if (is_source(path, lines)) tree.emplace(path, std::move(lines));
    }
  }
  return tree;
}

const Tree& house() {
  static const Tree tree = read_house(MONTECARTA_SOURCE_DIR);
  return tree;
}

/// What a file includes, as written between the quotes or angle brackets.
std::vector<std::string> includes_of(const Lines& lines) {
  static const std::regex include(R"rx(^\s*#\s*include\s*[<"]([^>"]+)[>"])rx");
  std::vector<std::string> names;
  std::smatch match;
  for (const std::string& line : lines) {
    if (std::regex_search(line, match, include)) names.push_back(match[1]);
  }
  return names;
}

/// "path:line: what" for every line of C++ outside tests that `broken` finds fault with.
std::vector<std::string> faults(const Tree& tree, const std::string& what,
                                const std::function<bool(const std::string&)>& broken) {
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path) || room_of(path) == "tests") continue;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (broken(lines[i])) found.push_back(path + ":" + std::to_string(i + 1) + ": " + what);
    }
  }
  return found;
}

std::vector<std::string> forbidden_includes(const Tree& tree) {
  const std::map<std::string, std::set<std::string>> allowed = {
      {"engine", {"engine"}},
      {"models", {"engine", "models"}},
      {"filters", {"engine", "models", "filters"}},
      {"analysis", {"engine", "models", "analysis"}},
      {"experiments", {"engine", "models", "filters", "analysis", "experiments"}},
      {"tests", {"engine", "models", "filters", "analysis", "experiments", "tests"}}};
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path)) continue;
    for (const std::string& name : includes_of(lines)) {
      const bool ours = std::ranges::count(kRooms, room_of(name)) > 0;
      if (name.starts_with(".") ||
          (ours && !allowed.at(library_of(path)).contains(library_of(name)))) {
        found.push_back(path + " includes " + name);
      }
    }
  }
  return found;
}

std::string folder_of(const std::string& path) { return fs::path(path).parent_path().string(); }

/// Folders outside tests that lie on a cycle of includes, of any length, or between two cycles:
/// what is left when those that use none that is left, and those that none uses, are taken away.
std::set<std::string> include_cycles(const Tree& tree) {
  std::set<std::pair<std::string, std::string>> uses;
  std::set<std::string> left;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path) || room_of(path) == "tests") continue;
    for (const std::string& name : includes_of(lines)) {
      if (folder_of(path) != folder_of(name)) uses.emplace(folder_of(path), folder_of(name));
    }
    left.insert(folder_of(path));
  }
  const auto is_free = [&](const std::string& folder) {
    const auto to = [&](const auto& use) {
      return use.first == folder && left.contains(use.second);
    };
    const auto from = [&](const auto& use) {
      return use.second == folder && left.contains(use.first);
    };
    return std::ranges::none_of(uses, to) || std::ranges::none_of(uses, from);
  };
  while (std::erase_if(left, is_free) > 0) continue;
  return left;
}

/// Files outside tests that include a header of which `prefix` is the beginning.
std::vector<std::string> users_of(const Tree& tree, const std::string& prefix) {
  std::vector<std::string> users;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path) || room_of(path) == "tests") continue;
    const auto names = includes_of(lines);
    const auto starts = [&](const std::string& name) { return name.starts_with(prefix); };
    if (std::ranges::any_of(names, starts)) users.push_back(path);
  }
  return users;
}

std::vector<std::string> too_long(const Tree& tree, std::size_t limit) {
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    if (lines.size() > limit) found.push_back(path);
  }
  return found;
}

std::vector<std::string> without_licence(const Tree& tree) {
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    const std::size_t at = is_script(lines) ? 1 : 0;
    if (lines.size() <= at || !lines[at].ends_with("SPDX-License-Identifier: BSD-3-Clause")) {
      found.push_back(path);
    }
  }
  return found;
}

/// What lies at the top and belongs neither there nor to a build or a result of the user's.
std::vector<std::string> strays(const std::vector<std::string>& names) {
  static const std::regex belongs(
      R"(CMakeLists\.txt|CMakePresets\.json|CMakeUserPresets\.json|LICENSE|CITATION\.cff|\..*)"
      R"(|(README|CONTRIBUTING|CHANGELOG|ARCHITECTURE)\.md)"
      R"(|build.*|.*\.h5|.*\.h5\.part(\.new)?|first_study_report|reproduction)");
  std::vector<std::string> found;
  for (const std::string& name : names) {
    const bool is_room = std::ranges::count(kRooms, name) > 0;
    if (!is_room && !std::regex_match(name, belongs)) found.push_back(name);
  }
  return found;
}

TEST(House, ARoomIncludesOnlyWhatStandsBelowIt) {
  EXPECT_THAT(forbidden_includes(house()), IsEmpty());
}

TEST(House, FoldersIncludeEachOtherInNoCycle) { EXPECT_THAT(include_cycles(house()), IsEmpty()); }

TEST(House, StatisticsKnowNumbersOnly) {
  for (const auto& [path, lines] : house()) {
    if (!path.starts_with("analysis/statistics/")) continue;
    for (const std::string& name : includes_of(lines)) {
      const bool is_ours = name.starts_with("analysis/statistics/");
      EXPECT_TRUE(is_ours || !name.starts_with("analysis/")) << path << " includes " << name;
    }
  }
}

TEST(House, LibrariesAreMetInOneOrTwoFiles) {
  for (const char* header : {"tbb/", "oneapi/", "omp.h", "boost/program_options", "matio"}) {
    const auto users = users_of(house(), header);
    EXPECT_LE(users.size(), 2u) << header << ": " << testing::PrintToString(users);
  }
}

TEST(House, Hdf5IsMetInItsWrapperOnly) {
  EXPECT_THAT(users_of(house(), "hdf5"), Each(StartsWith("engine/records/h5")));
}

TEST(House, NoFileIsLongerThan300Lines) { EXPECT_THAT(too_long(house(), 300), IsEmpty()); }

TEST(House, EverySourceNamesItsLicence) { EXPECT_THAT(without_licence(house()), IsEmpty()); }

TEST(House, NothingElseLiesAtTheTop) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(MONTECARTA_SOURCE_DIR)) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(strays(names), IsEmpty());
}

TEST(House, RandomNumbersComeFromStreamsOnly) {
  static const std::regex other(
      R"(std::(normal_distribution|uniform_\w+_distribution|random_device|mt19937)|\brand\()");
  const auto broken = [](const std::string& line) { return std::regex_search(line, other); };
  EXPECT_THAT(faults(house(), "not an RngStream", broken), IsEmpty());
}

// xsimd 8 rounds them differently on AVX-512, or lets one lane choose the way of another.
TEST(House, FunctionsThatDifferBetweenProcessorsAreNotTakenFromXsimd) {
  static const std::regex other(
      R"(xsimd::(f[n]?m[as]|exp\w*|log\w*|sin\w*|cos\w*|a?tan\w*|pow)\()");
  const auto broken = [](const std::string& line) { return std::regex_search(line, other); };
  EXPECT_THAT(faults(house(), "not of register_math", broken),
              Each(StartsWith("engine/numbers/registers.hpp")));
}

TEST(House, NothingIsInvertedAndNothingIsLeftToDo) {
  static const std::regex other(R"(\.inverse\(\)|\b(TODO|FIXME|XXX)\b)");
  const auto broken = [](const std::string& line) { return std::regex_search(line, other); };
  EXPECT_THAT(faults(house(), "inverse() or left to do", broken), IsEmpty());
}

TEST(House, TheTreeThatIsReadIsWhole) {
  for (const char* path : {"engine/errors.hpp", "tests/run", "filters/CMakeLists.txt",
                           "analysis/page/script/player.js"}) {
    EXPECT_TRUE(house().contains(path)) << path;
  }
}

TEST(House, IncludeCyclesAreSeen) {
  const Tree tree = {{"engine/a/one.cpp", {"#include \"engine/b/two.hpp\""}},
                     {"engine/b/three.hpp", {"#include \"engine/a/four.hpp\""}},
                     {"engine/b/two.hpp", {"#include \"engine/c/five.hpp\""}},
                     {"engine/d/six.cpp", {"#include \"engine/e/seven.hpp\""}},
                     {"engine/e/seven.hpp", {"#include \"engine/f/eight.hpp\""}},
                     {"engine/f/eight.hpp", {"#include \"engine/d/nine.hpp\""}}};
  EXPECT_THAT(include_cycles(tree),
              ElementsAre("engine/a", "engine/b", "engine/d", "engine/e", "engine/f"));
}

// The laws above can fail: a house where each is broken once.
TEST(House, BrokenLawsAreSeen) {
  const Tree broken = {
      {"engine/a.cpp", {"#include \"filters/factory.hpp\"", "#include <hdf5.h>", "rand();"}},
      {"analysis/b.hpp", Lines(301, "#include <experiments/study.hpp>")},
      {"tests/run", {"#!/bin/bash", "true"}}};
  EXPECT_THAT(forbidden_includes(broken), testing::Contains(HasSubstr("engine/a.cpp")));
  EXPECT_THAT(forbidden_includes(broken), testing::Contains(HasSubstr("analysis/b.hpp")));
  EXPECT_THAT(users_of(broken, "hdf5"), ElementsAre("engine/a.cpp"));
  EXPECT_THAT(too_long(broken, 300), ElementsAre("analysis/b.hpp"));
  EXPECT_THAT(without_licence(broken), ElementsAre("analysis/b.hpp", "engine/a.cpp", "tests/run"));
  EXPECT_THAT(strays({"engine", "notes.txt", "build-dev"}), ElementsAre("notes.txt"));
  const auto uses_rand = [](const std::string& line) { return line.starts_with("rand"); };
  EXPECT_THAT(faults(broken, "not ours", uses_rand), ElementsAre("engine/a.cpp:3: not ours"));
}

// Analysis may know how a vehicle moves and what a sensor sees, but no filter.
TEST(House, TheModelsAreALibraryOfTheirOwn) {
  const Lines model = {"#include \"filters/models/vehicle.hpp\""};
  const Lines filter = {"#include \"filters/factory.hpp\""};
  const Tree tree = {{"analysis/fine.cpp", model},
                     {"analysis/wrong.cpp", filter},
                     {"filters/models/fine.hpp", model},
                     {"filters/models/wrong.hpp", filter}};
  EXPECT_THAT(forbidden_includes(tree),
              ElementsAre(StartsWith("analysis/wrong"), StartsWith("filters/models/wrong")));
}

}  // namespace
