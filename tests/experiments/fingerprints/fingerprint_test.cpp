// SPDX-License-Identifier: BSD-3-Clause
// Same study, same bits: every filter computes the bits that are stored with the sources, on every
// processor.
#include "engine/records/h5.hpp"
#include "engine/records/provenance.hpp"
#include "engine/records/result_file.hpp"
#include "filters/factory.hpp"
#include "tests/experiments/commands/program.hpp"

#include <gmock/gmock.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <sys/utsname.h>
#include <vector>

namespace montecarta::experiments {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = fs::path(MONTECARTA_SOURCE_DIR) / "tests/experiments/fingerprints";

const std::string kAllColumns =
    "pose, covariance, ancestry, particles, association, map, final_map, joint";

/// One setting in which all cells of every_filter.ini run.
struct FingerprintedWorld {
  std::string name;
  std::vector<std::string> overrides;
};

const std::vector<FingerprintedWorld> kSettings = {
    {"known", {}},
    {"nearest", {"association.kind=nearest"}},
    {"large_map", {"association.kind=nearest", "scenario.world=dense_loop"}},
    {"measured_control",
     {"scenario.noise=measured-control", "scenario.vehicle=rear_wheel",
      "record.columns=" + kAllColumns}}};

using Fingerprints = std::map<std::string, std::string>;  ///< {setting/cell} hexadecimal

std::string hexadecimal(std::uint64_t value) {
  std::ostringstream text;
  text << std::hex << value;
  return text.str();
}

std::uint64_t fingerprint_in(const h5::Handle& group) {
  std::uint64_t value = 0;
  h5::read(h5::open_dataset(group, "fingerprint"), Element::u64,
           std::as_writable_bytes(std::span(&value, 1)));
  return value;
}

void collect(const fs::path& result, const std::string& setting, Fingerprints& found) {
  const h5::Handle file = h5::open_file(result), cells = h5::open_group(file, "cells");
  found[setting + "/truth"] = hexadecimal(fingerprint_in(h5::open_group(file, "truth")));
  for (const std::string& cell : h5::members(cells)) {
    found[setting + "/" + cell] = hexadecimal(fingerprint_in(h5::open_group(cells, cell)));
  }
}

/// The first line names the toolchain.
struct Stored {
  std::string toolchain;
  Fingerprints fingerprints;
};

Stored read_stored(const fs::path& path) {
  std::ifstream file(path);
  Stored stored;
  std::getline(file, stored.toolchain);
  for (std::string line; std::getline(file, line);) {
    const std::size_t comma = line.find(',');
    stored.fingerprints[line.substr(0, comma)] = line.substr(comma + 1);
  }
  return stored;
}

/// The cells that are in one file only, or have other bits.
std::vector<std::string> differing(const Fingerprints& a, const Fingerprints& b) {
  Fingerprints all = a;
  all.insert(b.begin(), b.end());
  std::vector<std::string> found;
  for (const auto& [cell, any] : all) {
    const auto in_a = a.find(cell), in_b = b.find(cell);
    if (in_a == a.end() || in_b == b.end() || in_a->second != in_b->second) found.push_back(cell);
  }
  return found;
}

void write_stored(const fs::path& path, const std::string& toolchain,
                  const Fingerprints& fingerprints) {
  std::ofstream file(path);
  file << toolchain << "\n";
  for (const auto& [cell, fingerprint] : fingerprints) file << cell << "," << fingerprint << "\n";
}

/// The environment on which the bits of a result depend, besides the study and the sources, e.g.
/// "GNU 12.2.0, glibc 2.36, x86_64".
std::string toolchain() {
  std::string facts;
  for (const auto& [name, value] : collect_provenance()) {
    if (name == "compiler" || name == "libm") facts += value + ", ";
  }
  utsname system{};
  return facts + (::uname(&system) == 0 ? system.machine : "unknown");
}

using SameBits = Program;

TEST(SameBitsStudy, HasEveryFilter) {
  std::ifstream file(kFolder / "every_filter.ini");
  const std::string study((std::istreambuf_iterator<char>(file)), {});
  for (const filters::FilterKind& kind : filters::filter_kinds()) {
    if (kind.name.starts_with("plain_")) continue;  // tests compare it with the fast filter
    EXPECT_NE(study.find("cell = " + kind.name + " "), std::string::npos) << kind.name;
  }
}

TEST_F(SameBits, OfEveryFilterOnEveryProcessor) {
  const std::string here = toolchain();
  Fingerprints computed;
  for (const auto& [name, overrides] : kSettings) {
    std::vector<std::string> words{"run", (kFolder / "every_filter.ini").string(), "-o",
                                   name + ".h5", "--quiet"};
    for (const std::string& text : overrides) words.insert(words.end(), {"--set", text});
    const Called called = call(words);
    ASSERT_EQ(called.code, 0) << name << ": " << called.err;
    collect(folder_ / (name + ".h5"), name, computed);
  }
  const Stored stored = read_stored(kFolder / "fingerprints.csv");
  const fs::path actual = fs::path(program_under_test()).parent_path() / "fingerprints.csv";
  write_stored(actual, here, computed);
  if (stored.toolchain != here) {
    GTEST_SKIP() << "the stored bits are those of " << stored.toolchain << ", this build is of "
                 << here;
  }
  EXPECT_THAT(differing(computed, stored.fingerprints), testing::IsEmpty())
      << "if the arithmetic was meant to change, or a column was added, copy " << actual << " to "
      << kFolder;
}

}  // namespace
}  // namespace montecarta::experiments
