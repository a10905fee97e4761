// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/page/replay/replay.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace montecarta::analysis {
namespace {

TEST(ReplayJson, IsShortAndComplete) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Replay replay{7};
  replay.times = {0.2, 0.4};
  replay.x = {1, 2};
  replay.y = {3, 4};
  replay.h = {0.5, 0.25};
  replay.landmarks = {{10, -20}};
  ReplayCell cell{"pf", 1, "failed"};
  cell.x = {1.00049, nan};
  cell.y = {3, nan};
  cell.h = {0.123456, nan};
  cell.pose = {{1, 3, 0.5, 0.25, 45}, {nan, nan, nan, nan, nan}};
  cell.particles = {9, {{{4}, {}, {1.1}, {2.9}}, {{5}, {0}, {nan}, {nan}}}};
  cell.maps = {{1, {{10, -20, 0.1, 0.05, 30}}}};
  cell.has_ancestry = true;
  replay.cells = {cell};
  EXPECT_EQ(replay_json(replay),
            R"({"run":7,"times":[0.2,0.4],"truth":{"x":[1,2],"y":[3,4],"h":[0.5,0.25]},)"
            R"("landmarks":[10,-20],"fixes":[],"cells":[{"label":"pf","failure":"failed",)"
            R"("colour":"#D55E00","ancestry":true,"x":[1.00049,null],"y":[3,null],)"
            R"("h":[0.1235,null],"pose":[0.5,0.25,45,null,null,null],"particles":9,"unit":1e-05,)"
            R"("clouds":[{"x":[9951],"y":[-10000]},{"x":[null],"y":[null],"parent":[0]}],)"
            R"("maps":[{"frame":1,"landmarks":[10,-20,0.1,0.05,30]}]}]})");
}

}  // namespace
}  // namespace montecarta::analysis
