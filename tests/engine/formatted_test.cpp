// SPDX-License-Identifier: BSD-3-Clause
#include "engine/formatted.hpp"

#include "engine/errors.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <string_view>

namespace montecarta::engine {
namespace {

TEST(Formatted, WritesTextsPathsAndWholeNumbers) {
  const std::filesystem::path path = "a folder/out.h5";  // as it is, without quotes
  EXPECT_EQ(formatted("{}: {} of {} runs", path, 3, std::uint64_t{300}),
            "a folder/out.h5: 3 of 300 runs");
  EXPECT_EQ(formatted("{}{}{}{}", 'a', "b", std::string("c"), std::string_view("d")), "abcd");
  EXPECT_EQ(formatted("{{{}}}", std::numeric_limits<std::int64_t>::min()),
            "{-9223372036854775808}");
  EXPECT_EQ(formatted("{}", std::uint8_t{65}), "65");
}

TEST(Formatted, LeavesWhatAUserWroteAsItIs) {
  const std::string braces = "study {} of {:d}";
  EXPECT_STREQ(StudyError("{}: unknown", braces).what(), "study {} of {:d}: unknown");
  EXPECT_STREQ(StudyError(braces).what(), braces.c_str());
  EXPECT_STREQ(RunError("a disk {}").what(), "a disk {}");
}

}  // namespace
}  // namespace montecarta::engine
