// SPDX-License-Identifier: BSD-3-Clause
// Rules that a compiler does not enforce: who may include whom, sizes, licence lines.
#include "tests/source_tree.hpp"

#include "tests/doubles/matchers.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace montecarta::sources {
namespace {

/// "path:line: message" for every line of C++ outside tests that is `broken`.
std::vector<std::string> faults(const Tree& tree, const std::string& what,
                                const std::function<bool(const std::string&)>& broken) {
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path) || top_folder_of(path) == "tests") continue;
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
      const bool ours = std::ranges::count(kFolders, top_folder_of(name)) > 0;
      if (name.starts_with(".") ||
          (ours && !allowed.at(library_of(path)).contains(library_of(name)))) {
        found.push_back(path + " includes " + name);
      }
    }
  }
  return found;
}

std::string folder_of(const std::string& path) { return fs::path(path).parent_path().string(); }

/// The header and the source of one name, without their extension.
std::string module_of(const std::string& path) {
  return fs::path(path).replace_extension().string();
}

/// Folders or modules outside tests, as `unit_of` names them, that lie on a cycle of includes, of
/// any length, or between two cycles. They are left when all units are removed, one after the
/// other, that use none or are used by none.
std::set<std::string> include_cycles(const Tree& tree, std::string (*unit_of)(const std::string&)) {
  std::set<std::pair<std::string, std::string>> uses;
  std::set<std::string> left;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path) || top_folder_of(path) == "tests") continue;
    for (const std::string& name : includes_of(lines)) {
      if (unit_of(path) != unit_of(name)) uses.emplace(unit_of(path), unit_of(name));
    }
    left.insert(unit_of(path));
  }
  const auto is_free = [&](const std::string& unit) {
    const auto to = [&](const auto& use) { return use.first == unit && left.contains(use.second); };
    const auto from = [&](const auto& use) {
      return use.second == unit && left.contains(use.first);
    };
    return std::ranges::none_of(uses, to) || std::ranges::none_of(uses, from);
  };
  while (std::erase_if(left, is_free) > 0) continue;
  return left;
}

/// The rooms of `analysis` from the lowest to the highest; an include goes down only.
constexpr std::array kRooms = {"statistics", "run", "verdict", "study", "metrics", "render"};

/// Index in kRooms; -1 if the path is in none of them.
std::ptrdiff_t room_of(const std::string& path) {
  const auto is_in = [&](const std::string& room) {
    return path.starts_with("analysis/" + room + "/");
  };
  const auto found = std::ranges::find_if(kRooms, is_in);
  return found == kRooms.end() ? -1 : found - kRooms.begin();
}

/// Includes of `analysis` that go up. Nobody includes a metric: the list of metrics names them all.
std::vector<std::string> upward_includes(const Tree& tree) {
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path) || room_of(path) < 0) continue;
    for (const std::string& name : includes_of(lines)) {
      if (room_of(name) > room_of(path) || name.starts_with("analysis/metrics/"))
        found.push_back(path + " includes " + name);
    }
  }
  return found;
}

/// Names of functions, or of the classes of member functions, whose declarations or definitions
/// begin at the margin, and names of classes that are defined there. Leaves out unnamed namespaces.
std::set<std::string> names_at_margin(const Lines& lines) {
  static const std::regex function(R"(^(?!using |typedef |namespace |extern |return )[\w\[].*?)"
                                   R"(\b(?!void\b|bool\b)(\w+)(::~?\w+)?\()");
  static const std::regex type(R"(^(?:class|struct) (\w+)[^;]*\{)");
  std::set<std::string> names;
  bool is_unnamed = false;
  std::smatch match;
  for (const std::string& line : lines) {
    if (line == "namespace {") is_unnamed = true;
    if (line == "}  // namespace") is_unnamed = false;
    if (is_unnamed || line.starts_with(' ')) continue;
    if (std::regex_search(line, match, type) || std::regex_search(line, match, function))
      names.insert(match[1]);
  }
  return names;
}

/// "path: name" for every function that is defined in a .cpp file and declared in headers, of the
/// same library, but not in that of the same name.
std::vector<std::string> defined_elsewhere(const Tree& tree) {
  std::map<std::pair<std::string, std::string>, std::set<std::string>> declared;
  for (const auto& [path, lines] : tree) {
    if (!path.ends_with(".hpp")) continue;
    for (const std::string& name : names_at_margin(lines))
      declared[{library_of(path), name}].insert(path);
  }
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    if (!path.ends_with(".cpp") || top_folder_of(path) == "tests") continue;
    for (const std::string& name : names_at_margin(lines)) {
      const auto headers = declared.find({library_of(path), name});
      const std::string own = fs::path(path).replace_extension(".hpp").generic_string();
      if (headers != declared.end() && !headers->second.contains(own))
        found.push_back(path + ": " + name);
    }
  }
  return found;
}

/// Number of lines of the files that `path` includes, directly or through others, where a header
/// brings the source of its name with it.
std::size_t lines_reached(const Tree& tree, const std::string& path) {
  std::set<std::string> reached;
  std::vector<std::string> left = {path};
  std::size_t lines = 0;
  while (!left.empty()) {
    const std::string next = left.back();
    left.pop_back();
    const auto file = tree.find(next);
    if (file == tree.end() || !reached.insert(next).second) continue;
    lines += file->second.size();
    for (const std::string& name : includes_of(file->second)) left.push_back(name);
    left.push_back(module_of(next) + ".cpp");
  }
  return lines;
}

/// Names of types that are defined in more than one module outside tests. Plain filters have the
/// names of their fast counterparts.
std::set<std::string> types_defined_twice(const Tree& tree) {
  static const std::regex type(
      R"(^\s*(?:struct|class|enum class) ([A-Z]\w*)(?: final)?(?: :.*)? \{)");
  std::map<std::string, std::set<std::string>> modules;
  std::smatch match;
  for (const auto& [path, lines] : tree) {
    const bool is_counted =
        is_cpp(path) && top_folder_of(path) != "tests" && !path.starts_with("filters/plain/");
    if (!is_counted) continue;
    for (const std::string& line : lines) {
      if (std::regex_search(line, match, type)) modules[match[1]].insert(module_of(path));
    }
  }
  std::set<std::string> twice;
  for (const auto& [name, where] : modules) {
    if (where.size() > 1) twice.insert(name);
  }
  return twice;
}

/// Files outside tests that include a header of which `prefix` is the beginning.
std::vector<std::string> users_of(const Tree& tree, const std::string& prefix) {
  std::vector<std::string> users;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path) || top_folder_of(path) == "tests") continue;
    const auto names = includes_of(lines);
    const auto starts = [&](const std::string& name) { return name.starts_with(prefix); };
    if (std::ranges::any_of(names, starts)) users.push_back(path);
  }
  return users;
}

/// Files outside tests that open a namespace of another library than their own.
std::vector<std::string> in_other_namespaces(const Tree& tree) {
  static const std::regex opening(R"(^namespace montecarta(::(\w+))?.*\{$)");
  std::vector<std::string> found;
  std::smatch match;
  for (const auto& [path, lines] : tree) {
    if (!is_cpp(path) || top_folder_of(path) == "tests" || path == "engine/namespaces.hpp")
      continue;
    for (const std::string& line : lines) {
      if (std::regex_match(line, match, opening) && match[2] != library_of(path))
        found.push_back(path);
    }
  }
  return found;
}

/// The files to which a document in Markdown links, or whose path `link` finds otherwise.
std::vector<fs::path> targets_of(
    const Lines& document, const std::regex& link = std::regex(R"(\]\(([^)#:\s]+)(#[^)]*)?\))")) {
  std::vector<fs::path> targets;
  for (const std::string& line : document) {
    for (std::sregex_iterator at(line.begin(), line.end(), link), end; at != end; ++at)
      targets.emplace_back((*at)[1].str());
  }
  return targets;
}

std::vector<std::string> too_wide(const Tree& tree, std::ptrdiff_t limit) {
  const auto is_wide = [&](const std::string& line) { return characters_in(line) > limit; };
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    if (std::ranges::any_of(lines, is_wide)) found.push_back(path);
  }
  return found;
}

std::vector<std::string> without_licence(const Tree& tree) {
  std::vector<std::string> found;
  for (const auto& [path, lines] : tree) {
    const std::size_t at = is_script(lines) ? 1 : 0;
    if (lines.size() <= at || !lines[at].ends_with("SPDX-License-Identifier: BSD-3-Clause"))
      found.push_back(path);
  }
  return found;
}

/// Files at the top that belong neither there nor to a build or a result of the user.
std::vector<std::string> strays(const std::vector<std::string>& names) {
  static const std::regex belongs(
      R"(CMakeLists\.txt|CMakePresets\.json|CMakeUserPresets\.json|pyproject\.toml|LICENSE)"
      R"(|CITATION\.cff|\..*|(README|CONTRIBUTING|CHANGELOG|ARCHITECTURE)\.md)"
      R"(|build.*|.*\.h5|.*\.h5\.part(\.new)?|first_study_report|reproduction)");
  std::vector<std::string> found;
  for (const std::string& name : names) {
    const bool is_folder = std::ranges::count(kFolders, name) > 0;
    if (!is_folder && !std::regex_match(name, belongs)) found.push_back(name);
  }
  return found;
}

TEST(SourceTree, FoldersIncludeOnlyThoseBelow) {
  EXPECT_THAT(forbidden_includes(sources()), IsEmpty());
}

TEST(SourceTree, NamespacesAreThoseOfTheFolders) {
  EXPECT_THAT(in_other_namespaces(sources()), IsEmpty());
}

TEST(SourceTree, FoldersIncludeEachOtherInNoCycle) {
  EXPECT_THAT(include_cycles(sources(), folder_of), IsEmpty());
}

TEST(SourceTree, ModulesIncludeEachOtherInNoCycle) {
  EXPECT_THAT(include_cycles(sources(), module_of), IsEmpty());
}

TEST(SourceTree, MeasuringARunAndReadingAStudyReachLittle) {
  EXPECT_LT(lines_reached(sources(), "analysis/run/measured_run.cpp"), 12'000U);
  EXPECT_LT(lines_reached(sources(), "experiments/study/study.cpp"), 9'000U);
  const Tree tree = {{"engine/a.cpp", {"#include \"engine/b.hpp\"", ""}},
                     {"engine/b.hpp", {"#include \"engine/a.hpp\""}},
                     {"engine/b.cpp", {"", "", ""}},
                     {"engine/c.hpp", {""}}};
  EXPECT_EQ(lines_reached(tree, "engine/a.cpp"), 6U);
}

TEST(SourceTree, FewTypesHaveTheNameOfAnother) {
  EXPECT_LT(types_defined_twice(sources()).size(), 15U)
      << testing::PrintToString(types_defined_twice(sources()));
  const Tree tree = {
      {"engine/a.hpp", {"struct One {", "  struct Two {", "class Three final : One {"}},
      {"engine/a.cpp", {"struct Two {"}},
      {"engine/b.cpp", {"class Three {", "struct One;"}}};
  EXPECT_THAT(types_defined_twice(tree), ElementsAre("Three"));
}

// Scores are declared where their table is, which must not know the list of metrics that has them.
TEST(SourceTree, FunctionsAreDefinedWhereTheyAreDeclared) {
  EXPECT_THAT(defined_elsewhere(sources()),
              ElementsAre("analysis/study/registry.cpp: all_scan_series",
                          "analysis/study/registry.cpp: all_scores"));
}

TEST(SourceTree, RoomsOfTheAnalysisIncludeOnlyThoseBelow) {
  EXPECT_THAT(upward_includes(sources()), IsEmpty());
  for (const auto& [path, lines] : sources()) {
    if (!path.starts_with("analysis/") || !is_cpp(path)) continue;
    EXPECT_GE(room_of(path), 0) << path << " is in no room";
  }
}

// A metric has a source, and its prose the same name.
TEST(SourceTree, ProseOfMetricsBelongsToASource) {
  const fs::path metrics = fs::path(MONTECARTA_SOURCE_DIR) / "analysis/metrics";
  std::size_t texts = 0;
  for (const auto& entry : fs::directory_iterator(metrics)) {
    if (entry.path().extension() != ".md") continue;
    ++texts;
    EXPECT_TRUE(fs::exists(fs::path(entry.path()).replace_extension(".cpp"))) << entry.path();
  }
  EXPECT_GT(texts, 10U);
}

TEST(SourceTree, LibrariesAreUsedInOneOrTwoFiles) {
  for (const char* header : {"tbb/", "oneapi/", "omp.h", "boost/program_options"}) {
    const auto users = users_of(sources(), header);
    EXPECT_LE(users.size(), 2u) << header << ": " << testing::PrintToString(users);
  }
}

TEST(SourceTree, Hdf5IsUsedInItsWrapperOnly) {
  EXPECT_THAT(users_of(sources(), "hdf5"), Each(StartsWith("engine/records/h5")));
}

TEST(SourceTree, NoLineIsTooLong) { EXPECT_THAT(too_wide(sources(), 100), IsEmpty()); }

TEST(SourceTree, EverySourceNamesItsLicence) { EXPECT_THAT(without_licence(sources()), IsEmpty()); }

TEST(SourceTree, NothingElseLiesAtTheTop) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(MONTECARTA_SOURCE_DIR)) {
    names.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(strays(names), IsEmpty());
}

TEST(SourceTree, WhatRoundsOtherwiseOnOtherProcessorsIsNotCalled) {
  static const std::regex other(R"(std::(hypot|erfc?|[lt]gamma)\b)");
  const auto broken = [](const std::string& line) { return std::regex_search(line, other); };
  auto tree = sources();
  std::erase_if(tree, [](const auto& file) { return file.first.starts_with("analysis/"); });
  EXPECT_THAT(faults(tree, "not the same bits everywhere", broken), IsEmpty());
}

TEST(SourceTree, RandomNumbersComeFromStreamsOnly) {
  static const std::regex other(
      R"(std::(normal_distribution|uniform_\w+_distribution|random_device|mt19937)|\brand\()");
  const auto broken = [](const std::string& line) { return std::regex_search(line, other); };
  EXPECT_THAT(faults(sources(), "not an RngStream", broken), IsEmpty());
}

// xsimd 8 rounds them differently on AVX-512, or lets one lane choose the way of another.
TEST(SourceTree, FunctionsThatDifferBetweenProcessorsAreNotTakenFromXsimd) {
  static const std::regex other(
      R"(xsimd::(f[n]?m[as]|exp\w*|log\w*|sin\w*|cos\w*|a?tan\w*|pow)\()");
  const auto broken = [](const std::string& line) { return std::regex_search(line, other); };
  EXPECT_THAT(faults(sources(), "not of register_math", broken),
              Each(StartsWith("engine/numbers/registers.hpp")));
}

TEST(SourceTree, NothingIsInvertedAndNothingIsLeftToDo) {
  static const std::regex other(R"(\.inverse\(\)|\b(TODO|FIXME|XXX)\b)");
  const auto broken = [](const std::string& line) { return std::regex_search(line, other); };
  EXPECT_THAT(faults(sources(), "inverse() or left to do", broken), IsEmpty());
}

TEST(SourceTree, EquationsHaveNumbersOfTheirOwn) {
  const Lines equations = read_lines(fs::path(MONTECARTA_SOURCE_DIR) / "filters/EQUATIONS.md");
  EXPECT_THAT(equations, testing::Contains(HasSubstr("\\tag{1.1}")));
  EXPECT_THAT(numbers_given_twice(equations), IsEmpty());
  EXPECT_THAT(numbers_given_twice({"a \\tag{1.2}", "b \\tag{1.3}", "c \\tag{1.2}"}),
              ElementsAre("1.2"));
}

TEST(SourceTree, SourcesCiteChaptersThatExist) {
  static const std::regex heading(R"(## (\d+)\..*)"), cited(R"(\b(EQUATIONS|STATISTICS) (\d+))");
  std::set<std::string> chapters;
  for (const std::string path : {"filters/EQUATIONS", "analysis/STATISTICS"}) {
    for (const std::string& line : read_lines(fs::path(MONTECARTA_SOURCE_DIR) / (path + ".md"))) {
      std::smatch found;
      if (std::regex_match(line, found, heading))
        chapters.insert(path.substr(path.find('/') + 1) + " " + found.str(1));
    }
  }
  const auto is_broken = [&](const std::string& line) {
    const std::sregex_iterator begin(line.begin(), line.end(), cited), end;
    return std::any_of(begin, end, [&](const auto& m) { return !chapters.contains(m.str()); });
  };
  EXPECT_THAT(faults(sources(), "cites a chapter that does not exist", is_broken), IsEmpty());
  EXPECT_TRUE(is_broken(std::string("// STATISTICS ") + "99"));
  EXPECT_FALSE(is_broken("// STATISTICS 5, EQUATIONS 20"));
}

TEST(SourceTree, DocumentsLinkToFilesThatExist) {
  const fs::path root = MONTECARTA_SOURCE_DIR;
  std::size_t links = 0;
  for (const char* path :
       {"README.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "engine/README.md", "filters/README.md",
        "filters/EQUATIONS.md", "analysis/README.md", "experiments/README.md", "tests/README.md"}) {
    const std::vector<fs::path> targets = targets_of(read_lines(root / path));
    links += targets.size();
    for (const fs::path& target : targets)
      EXPECT_TRUE(fs::exists(root / fs::path(path).parent_path() / target))
          << path << ": " << target;
  }
  EXPECT_GT(links, 100U);
  EXPECT_THAT(targets_of({"a [b](c/d.hpp) [e](f.md#g) [h](https://i.org) [j](#k)"}),
              ElementsAre("c/d.hpp", "f.md"));
}

// As `folder/file.cpp`, without a link.
TEST(SourceTree, ArchitectureNamesSourcesThatExist) {
  const fs::path root = MONTECARTA_SOURCE_DIR;
  const std::regex source(R"(`(\w[\w/]*/\w+\.[ch]pp)`)");
  const std::vector<fs::path> named = targets_of(read_lines(root / "ARCHITECTURE.md"), source);
  for (const fs::path& path : named) EXPECT_TRUE(fs::exists(root / path)) << path;
  EXPECT_GT(named.size(), 10U);
}

TEST(SourceTree, TheTreeThatIsReadIsWhole) {
  for (const char* path : {"engine/errors.hpp", "tests/run", "filters/CMakeLists.txt",
                           "analysis/render/page/script/player.js"}) {
    EXPECT_TRUE(sources().contains(path)) << path;
  }
}

TEST(SourceTree, IncludeCyclesAreFound) {
  const Tree tree = {{"engine/a/one.cpp", {"#include \"engine/b/two.hpp\""}},
                     {"engine/b/three.hpp", {"#include \"engine/a/four.hpp\""}},
                     {"engine/b/two.hpp", {"#include \"engine/c/five.hpp\""}},
                     {"engine/d/six.cpp", {"#include \"engine/e/seven.hpp\""}},
                     {"engine/e/seven.hpp", {"#include \"engine/f/eight.hpp\""}},
                     {"engine/f/eight.hpp", {"#include \"engine/d/nine.hpp\""}}};
  EXPECT_THAT(include_cycles(tree, folder_of),
              ElementsAre("engine/a", "engine/b", "engine/d", "engine/e", "engine/f"));
  EXPECT_THAT(include_cycles(tree, module_of), IsEmpty());
  const Tree pair = {{"engine/a/one.cpp", {"#include \"engine/a/two.hpp\""}},
                     {"engine/a/two.hpp", {"#include \"engine/a/one.hpp\""}}};
  EXPECT_THAT(include_cycles(pair, module_of), ElementsAre("engine/a/one", "engine/a/two"));
}

TEST(SourceTree, UpwardIncludesAreFound) {
  const Tree tree = {{"analysis/run/a.cpp", {"#include \"analysis/study/b.hpp\""}},
                     {"analysis/render/c.cpp",
                      {"#include \"analysis/run/d.hpp\"", "#include \"analysis/metrics/e.hpp\""}}};
  EXPECT_THAT(upward_includes(tree),
              ElementsAre("analysis/render/c.cpp includes analysis/metrics/e.hpp",
                          "analysis/run/a.cpp includes analysis/study/b.hpp"));
}

// The rules above can fail: a tree where each is broken once.
TEST(SourceTree, BrokenRulesAreFound) {
  const Tree broken = {
      {"engine/a.cpp", {"#include \"filters/factory.hpp\"", "#include <hdf5.h>", "rand();"}},
      {"engine/c.cpp", {"// SPDX-License-Identifier: BSD-3-Clause", "namespace montecarta {"}},
      {"analysis/b.hpp", Lines(1, "#include <experiments/study.hpp>")},
      {"analysis/c.py", {"# SPDX-License-Identifier: BSD-3-Clause", std::string(101, 'x')}},
      {"tests/run", {"#!/bin/bash", "true"}}};
  EXPECT_THAT(forbidden_includes(broken), testing::Contains(HasSubstr("engine/a.cpp")));
  EXPECT_THAT(forbidden_includes(broken), testing::Contains(HasSubstr("analysis/b.hpp")));
  EXPECT_THAT(users_of(broken, "hdf5"), ElementsAre("engine/a.cpp"));
  EXPECT_THAT(in_other_namespaces(broken), ElementsAre("engine/c.cpp"));
  EXPECT_THAT(too_wide(broken, 100), ElementsAre("analysis/c.py"));
  EXPECT_THAT(without_licence(broken), ElementsAre("analysis/b.hpp", "engine/a.cpp", "tests/run"));
  EXPECT_THAT(strays({"engine", "notes.txt", "build-dev"}), ElementsAre("notes.txt"));
  EXPECT_THAT(
      defined_elsewhere(
          {{"engine/a.hpp", {"int f(std::function<void(int)> g);", "class A {"}},
           {"engine/b.hpp", {"std::function<void(int)> h(int i);"}},
           {"engine/a.cpp", {"A::A() {}", "bool A::is_a() const {", "void h(int i) {"}},
           {"engine/b.cpp", {"int f(int i) {", "namespace {", "A::A(", "}  // namespace"}}}),
      ElementsAre("engine/a.cpp: h", "engine/b.cpp: f"));
  const auto uses_rand = [](const std::string& line) { return line.starts_with("rand"); };
  EXPECT_THAT(faults(broken, "not ours", uses_rand), ElementsAre("engine/a.cpp:3: not ours"));
}

// Analysis may use the models of vehicles and sensors, but no filter.
TEST(SourceTree, TheModelsAreALibraryOfTheirOwn) {
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
}  // namespace montecarta::sources
