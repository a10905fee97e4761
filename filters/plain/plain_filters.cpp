// SPDX-License-Identifier: BSD-3-Clause
#include "filters/plain/plain_filters.hpp"

#include "filters/plain/de_srcd.hpp"
#include "filters/plain/ekf_slam.hpp"
#include "filters/plain/fastslam1.hpp"
#include "filters/plain/fej_ekf_slam.hpp"
#include "filters/plain/marginal.hpp"
#include "filters/plain/oc_ekf_slam.hpp"
#include "filters/plain/riekf_slam.hpp"
#include "filters/plain/ufastslam.hpp"

#include <algorithm>
#include <memory>
#include <string>

namespace montecarta::filters {
namespace {

using Plain = std::unique_ptr<SlamFilter> (*)(const FilterSetup&);

template <class Filter>
std::unique_ptr<SlamFilter> make_plain(const FilterSetup& setup) {
  return std::make_unique<Filter>(setup);
}
template <Choice choice>
std::unique_ptr<SlamFilter> make_plain_marginal(const FilterSetup& setup) {
  return std::make_unique<plain::Marginal>(setup, choice);
}

template <plain::SrcdParts parts>
std::unique_ptr<SlamFilter> make_plain_srcd(const FilterSetup& setup) {
  return std::make_unique<plain::Srcd>(setup, parts);
}

struct PlainFilter {
  std::string name;  ///< of the fast filter
  Plain make;
  std::vector<std::string> left_out;  ///< options that it does not have
};

const std::vector<PlainFilter>& all_plain() {
  static const std::vector<PlainFilter> all{
      {"ekf_slam", make_plain<plain::EkfSlam>, {"iterations", "motion", "moments"}},
      {"riekf_slam", make_plain<plain::RiekfSlam>, {"iterations", "motion", "moments"}},
      {"fej_ekf_slam", make_plain<plain::FejEkfSlam>, {"motion", "moments"}},
      {"oc_ekf_slam", make_plain<plain::OcEkfSlam>, {"motion", "moments"}},
      {"fastslam1", make_plain<plain::FastSlam1>, {}},
      {"fastslam2", make_plain<plain::FastSlam2>, {}},
      {"ufastslam", make_plain<plain::UFastSlam>, {}},
      {"srcd", make_plain_srcd<plain::SrcdParts{}>, {"weights_of_sigma_points", "new_landmarks"}},
      {"srcd_aided", make_plain_srcd<plain::SrcdParts{.pose = false}>, {"weights_of_sigma_points"}},
      {"srcd_pf", make_plain_srcd<plain::SrcdParts{.map = false}>, {"weights_of_sigma_points"}},
      {"de_srcd", make_plain<plain::DeSrcd>, {"weights_of_sigma_points"}},
      {"marginal", make_plain_marginal<Choice::by_weight>, {"kernel_sums", "kernel_tolerance"}},
      {"ampf_de", make_plain_marginal<Choice::by_likelihood>, {"kernel_sums", "kernel_tolerance"}},
  };
  return all;
}

/// Plain filters take range and bearing at the pose, resample in two ways, and report no joint.
FilterKind plain_version(FilterKind kind, const PlainFilter& plain) {
  kind.name = "plain_" + kind.name;
  kind.long_name = "plain " + kind.long_name;
  std::erase_if(kind.options, [&](const Parameter& option) {
    return std::ranges::count(plain.left_out, option.key) > 0;
  });
  for (Parameter& option : kind.options) {
    if (option.key == "resampling") option.choices = {"systematic", "stratified"};
  }
  kind.reports.joint = kind.delays_initialisation = false;
  kind.reports.own_columns.clear();
  kind.sensors = {RangeBearingSensor::kName};
  kind.make = plain.make;
  return kind;
}

}  // namespace

std::vector<FilterKind> plain_kinds(std::span<const FilterKind> fast) {
  std::vector<FilterKind> kinds;
  for (const PlainFilter& plain : all_plain())
    kinds.push_back(plain_version(*std::ranges::find(fast, plain.name, &FilterKind::name), plain));
  return kinds;
}

}  // namespace montecarta::filters
