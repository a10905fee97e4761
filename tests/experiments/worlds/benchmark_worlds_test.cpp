// SPDX-License-Identifier: BSD-3-Clause
// The worlds of the benchmark are frozen: a number that changes would make archived results those
// of another world.
#include "engine/records/fingerprint.hpp"
#include "experiments/files/files.hpp"
#include "experiments/study/known_filters.hpp"
#include "experiments/study/study.hpp"

#include <gmock/gmock.h>

#include <map>
#include <string>

namespace montecarta::experiments {
namespace {

constexpr const char* kFrozenFolder = "studies/benchmark/1";

/// {name} SHA-256 of the resolved text of each study, which contains its world.
const std::map<std::string, std::string>& frozen_studies() {
  static const std::map<std::string, std::string> frozen = {
      {"circle_easy", "e54e9354b719fd31b78bd62fd9ab3035a42c918428fe86448f46ff6fee4b5777"},
      {"circle_hard", "3648aaeadd48eb48adff1da6493428f9cb0159ff9d51ee7271baf48e0984784b"},
      {"corridor_easy", "e6b51a3fe32b918e0758ce445b169403b0e6ab0857e823f8a890fdcb1f96bf56"},
      {"corridor_hard", "a588e7cea35694139bb0cf16e44fff1f16b22e2393d3ab2343afef53e7194fa5"},
      {"dense_loop_easy", "5e190ed24f3ab6dde6ced5fbe779e94c9205239200e634905741ede639929a5d"},
      {"dense_loop_hard", "ede546e3396ca43f08144df9d7da95f0e35ad5e00dc1f5aa59dbb9ca20b8a336"},
      {"field_easy", "19c1c017eca68b6e5074c71c6c398c03a7a483d00e1bece533b9f446ed1250ca"},
      {"field_hard", "68832ad637ee3cbddef23929568c1fe085400c2f2f8d9f973f0f5e338dde3e13"},
      {"figure_eight_easy", "000ca99f0bdea5ea241f284e0234f3cfed412ac37b82c751e2ca11de7bb8d7bf"},
      {"figure_eight_hard", "f7e825be7c1188923a38bad47e805906386ec6abe1c7f1c07d4ad68bb3241224"},
      {"known_map", "99a765ef92ec46c335668d4717a21806e89af499d621d959b45a993d41456b19"},
      {"small_loop_easy", "8b61e97901921af5b8abbdee57a07ac93d13877b1ffb1cff534f7f41f4175099"},
      {"small_loop_hard", "fad4513e28ded0ab9d409162c876d6b5e32179529282d2ea6695cee42af6acf4"},
      {"sparse_loop_easy", "8dfee76e2c1a227f88b2a5cfe9a117c66bd4ec506e1994d4501ae060bdacd2a0"},
      {"sparse_loop_hard", "eb97e2786d08f67ef6d0237c93f7ddba1035e04783d5400af65ae36e4f4288d7"},
  };
  return frozen;
}

TEST(BenchmarkWorlds, AreFrozen) {
  std::map<std::string, std::string> shipped;
  for (const std::string& name : shipped_names(kFrozenFolder, ".ini")) {
    const auto path = shipped_file(kFrozenFolder, name + ".ini");
    shipped[name] = sha256(resolved_text(read_study(path.value(), known_filters())));
  }
  EXPECT_EQ(shipped, frozen_studies());
}

}  // namespace
}  // namespace montecarta::experiments
