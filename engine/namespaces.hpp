// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// A namespace a folder. Each sees the names of the folders that it may include, and no others.
namespace montecarta {

namespace engine {}
namespace models {
using namespace engine;
}
namespace filters {
using namespace engine;
using namespace models;
}  // namespace filters
namespace analysis {
using namespace engine;
using namespace models;
}  // namespace analysis
namespace experiments {
using namespace engine;
using namespace models;
using namespace filters;
using namespace analysis;
}  // namespace experiments

}  // namespace montecarta
