// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// One namespace per folder. Each sees only the names of the folders that it may include.
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
