// SPDX-License-Identifier: BSD-3-Clause
#include "engine/records/h5.hpp"
#include "engine/records/result_layout.hpp"
#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"

#include <gmock/gmock.h>

#include <array>

namespace montecarta::engine {
namespace {

using testing::HasSubstr;

/// What is said of an HDF5 file of this type and version that holds nothing else.
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
  EXPECT_THAT(said_of(ours, format::kMajor + 1),
              HasSubstr("some.h5: format version 2 (this program reads version 1)"));
  EXPECT_THROW(said_of(ours, format::kMajor), RunError) << "of a known version, but empty";
}

}  // namespace
}  // namespace montecarta::engine
