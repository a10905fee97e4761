// SPDX-License-Identifier: BSD-3-Clause
#include "filters/fastslam/ufastslam.hpp"

namespace montecarta {

FilterKind ufastslam_kind() {
  std::vector<Option> options = sigma_point_options();
  options.push_back(
      number_option("alpha", "0.9", 1e-3, 1,
                    "spread of the sigma points; Kim's paper: 0.002, his code: 0.9 (EQUATIONS 7)"));
  options.push_back(number_option(
      "beta", "2", 0, 10, "weight of the centre in covariances; 2 for a Gaussian (EQUATIONS 7)"));
  options.push_back(
      number_option("kappa", "0", 0, 10,
                    "second spread: alpha^2 (n + kappa) is the square of the points' distance"));
  options.push_back(map_uncertainty_option());
  return {.name = "ufastslam",
          .long_name = "U-FastSLAM",
          .source = "Kim et al. 2008; EQUATIONS 7",
          .has_particles = true,
          .has_mixture = true,
          .options = std::move(options),
          .make = make_ufastslam<Lanes>};
}

}  // namespace montecarta
