// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>

/// The matchers that many tests use, by their short names.
namespace montecarta {

using testing::AllOf;
using testing::ContainsRegex;
using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::IsNan;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

}  // namespace montecarta
