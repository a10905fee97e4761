// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>

namespace montecarta::filters {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(std::string(MONTECARTA_SOURCE_DIR) + "/" + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(OwnFilterPage, QuotesTheExampleThatIsCompiled) {
  const std::string example = text_of("filters/dead_reckoning.cpp");
  ASSERT_FALSE(example.empty());
  EXPECT_NE(text_of("filters/WRITE_YOUR_OWN.md").find(example), std::string::npos)
      << "filters/WRITE_YOUR_OWN.md must quote filters/dead_reckoning.cpp as it stands";
}

}  // namespace
}  // namespace montecarta::filters
