// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/statistics/t_quantile.hpp"

#include <boost/math/distributions/students_t.hpp>

namespace montecarta::analysis {

double t_quantile(std::size_t n, double level) {
  const boost::math::students_t t(static_cast<double>(n - 1));
  return boost::math::quantile(t, 0.5 + 0.5 * level);
}

}  // namespace montecarta::analysis
