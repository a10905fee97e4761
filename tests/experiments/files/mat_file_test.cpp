// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/files/mat_file.hpp"

#include "tests/doubles/complaint.hpp"
#include "tests/doubles/scratch_folder.hpp"
#include "tests/experiments/recordings/small_drives.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>

namespace montecarta::experiments {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class Number>
void expect_extremes(const ScratchFolder& folder, matio_classes kind, matio_types type) {
  const Number least = std::numeric_limits<Number>::lowest(),
               most = std::numeric_limits<Number>::max();
  const auto path = folder / ("class_" + std::to_string(kind) + ".mat");
  add_matrix<Number>(path, "v", {least, most}, 1, kind, type, MAT_COMPRESSION_NONE);
  EXPECT_THAT(MatFile(path).series("v"),
              ElementsAre(static_cast<double>(least), static_cast<double>(most)))
      << kind;
}

TEST(MatFile, ReadsEveryClassOfNumbers) {
  const ScratchFolder folder;
  expect_extremes<std::int8_t>(folder, MAT_C_INT8, MAT_T_INT8);
  expect_extremes<std::uint8_t>(folder, MAT_C_UINT8, MAT_T_UINT8);
  expect_extremes<std::int16_t>(folder, MAT_C_INT16, MAT_T_INT16);
  expect_extremes<std::uint16_t>(folder, MAT_C_UINT16, MAT_T_UINT16);
  expect_extremes<std::int32_t>(folder, MAT_C_INT32, MAT_T_INT32);
  expect_extremes<std::uint32_t>(folder, MAT_C_UINT32, MAT_T_UINT32);
  expect_extremes<std::int64_t>(folder, MAT_C_INT64, MAT_T_INT64);
  expect_extremes<std::uint64_t>(folder, MAT_C_UINT64, MAT_T_UINT64);
  expect_extremes<float>(folder, MAT_C_SINGLE, MAT_T_SINGLE);
  expect_extremes<double>(folder, MAT_C_DOUBLE, MAT_T_DOUBLE);
}

TEST(MatFile, ReadsEachClassCompressedOrNot) {
  const ScratchFolder folder;
  for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    const auto path = folder / (compression == MAT_COMPRESSION_NONE ? "plain.mat" : "packed.mat");
    add_matrix<double>(path, "a_long_name", {0.5, -2, 1e300, 4, 5, 6}, 2, MAT_C_DOUBLE,
                       MAT_T_DOUBLE, compression);
    add_matrix<std::int32_t>(path, "t", {-7, 2'000'000'000}, 1, MAT_C_INT32, MAT_T_INT32,
                             compression);
    add_matrix<std::uint16_t>(path, "u", {65535, 1, 2}, 3, MAT_C_UINT16, MAT_T_UINT16, compression);
    const MatFile file(path);
    EXPECT_EQ(file.matrix("a_long_name").rows(), 2);
    EXPECT_EQ(file.matrix("a_long_name")(0, 1), 1e300) << "column by column";
    EXPECT_THAT(file.series("t"), ElementsAre(-7, 2e9));
    EXPECT_THAT(file.series("u"), ElementsAre(65535, 1, 2));
    EXPECT_FALSE(file.has("w"));
    EXPECT_THAT(complaint_of([&] { file.series("a_long_name"); }), HasSubstr("is 2 x 3"));
    EXPECT_THAT(
        complaint_of([&] { file.matrix("w"); }),
        HasSubstr("no variable 'w' (a real matrix of numbers; there are: a_long_name, t, u"));
  }
}

/// A file whose only variable begins at byte 128: tag, flags, sides, name, numbers.
std::string bytes_of_small_file(const ScratchFolder& folder) {
  add_doubles(folder / "good.mat", "speed", {1, 2, 3}, 3);
  std::ifstream file(folder / "good.mat", std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(MatFile, RefusesWhatContradictsItself) {
  const ScratchFolder folder;
  const std::string good = bytes_of_small_file(folder);
  const auto said = [&](const std::string& bytes) {
    write_text(folder / "bad.mat", bytes);
    return complaint_of([&] { MatFile(folder / "bad.mat"); });
  };
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return said(std::string(good).replace(at, bytes.size(), bytes));
  };
  EXPECT_EQ(said(good), "nothing");
  EXPECT_THAT(said(good.substr(0, good.size() - 8)), HasSubstr("damaged (variable 1: it ends too"));
  EXPECT_THAT(with(160, "\x04"), HasSubstr("other sides than numbers")) << "4 x 1 of 3 numbers";
  EXPECT_THAT(with(160, "\xff\xff\xff\xff"), HasSubstr("impossible size")) << "-1 x 1";
  EXPECT_THAT(with(168, std::string("\x01\x00\x00\x00\xff\xff\xff\x7f", 8)),
              HasSubstr("it ends too early"))
      << "a name of 2 GB, for which matio takes that much memory";
  EXPECT_THAT(said(""), HasSubstr("cannot be read (no little-endian MATLAB file"));
  EXPECT_THAT(said("MATLAB 7.3 MAT-file" + good), HasSubstr("save it with -v7"));
  EXPECT_THAT(complaint_of([&] { MatFile(folder.path()); }), HasSubstr("cannot be opened"));
}

}  // namespace
}  // namespace montecarta::experiments
