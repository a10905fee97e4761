// SPDX-License-Identifier: BSD-3-Clause
#include "analysis/verdict/run_products.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace montecarta::analysis {
namespace {

constexpr double kLeastShare = 0.5;    // of errors that two runs have in common
constexpr double kFewestErrors = 3.0;  // of which a root mean square is taken

}  // namespace

void AspectProducts::add(const AspectProducts& other) {
  products.add(other.products);
  for (std::size_t run = 0; run < terms_of_run.size(); ++run) {
    terms_of_run[run] += other.terms_of_run[run];
  }
  common_terms += other.common_terms;
  constant_root += other.constant_root;
}

double AspectProducts::terms() const { return mean_of(terms_of_run); }

Traces AspectProducts::traces() const {
  const double largest = constant_root * constant_root;
  if (products.runs() < kFewestRunsOfTraces || !(share() >= kLeastShare)) {
    return traces_of_constant_errors(terms(), largest);
  }
  return traces_of(products, terms(), largest, share());
}

// With all sums in units of t_1: Var z = 2 t_2 (1 + v) + v t_1^2, where v is the variance of the
// scales, and the mean of G_ij^2 is t_2. The factors correct the division of the errors by the
// sample's own root mean square.
Summary AspectProducts::variance_of_scales() const {
  const auto n = static_cast<double>(products.runs());
  const MeanSquaredProduct squares = mean_squared_product(products);
  const double scale = squares.mean + 0.5 * terms() * terms();
  SummaryOf variance;
  for (std::size_t i = 0; i < products.runs(); ++i) {
    const double deviation = products(i, i) - terms_of_run[i];
    const double own = (n + 2.0) / (n - 1.0) * 0.5 * deviation * deviation;
    const double others = (n + 2.0) / n * (n * squares.mean - (n - 1.0) * squares.without[i]);
    variance.add((own - others) / scale);
  }
  return variance.result();
}

DividedErrors::DividedErrors(std::vector<double> errors, std::size_t scans, std::size_t dimension)
    : dimension_(dimension),
      errors_(std::move(errors)),
      is_there_(errors_.size(), 1),
      counts_(scans * dimension) {
  const std::size_t places = counts_.size();
  std::vector<double> squares(places), scale(places);
  const auto for_each_error = [&](const auto& visit) {  // run by run, as they lie in memory
    for (std::size_t first = 0; first < errors_.size(); first += places) {
      for (std::size_t k = 0; k < places; ++k) visit(errors_[first + k], is_there_[first + k], k);
    }
  };
  for_each_error([&](double& error, char& is_there, std::size_t place) {
    if (std::isnan(error)) {
      error = 0.0;
      is_there = 0;
    }
    squares[place] += error * error;
    counts_[place] += is_there;
  });
  for (std::size_t place = 0; place < places; ++place) {
    const double n = counts_[place];
    const bool is_usable = n >= kFewestErrors && squares[place] > 0.0;
    if (is_usable) scale[place] = 1.0 / std::sqrt(squares[place] / n);
    if (!is_usable) counts_[place] = 0.0;
  }
  for_each_error([&](double& error, char& is_there, std::size_t place) {
    error *= scale[place];
    if (counts_[place] == 0.0) is_there = 0;
  });
}

AspectProducts DividedErrors::products(const Aspect& aspect) const {
  AspectProducts found(runs());
  const auto n = static_cast<double>(runs());
  std::vector<std::size_t> places;
  for (std::size_t s = aspect.first_scan; s < aspect.end_scan; ++s) {
    for (std::size_t k = aspect.first_component; k < aspect.end_component; ++k) {
      places.push_back(s * dimension_ + k);
    }
  }
  std::vector<double> rows;
  rows.reserve(runs() * places.size());
  for (std::size_t run = 0; run < runs(); ++run) {
    for (const std::size_t place : places) {
      rows.push_back(errors_[run * counts_.size() + place]);
      found.terms_of_run[run] += is_there_[run * counts_.size() + place];
    }
  }
  found.products.add(rows, places.size());
  for (std::size_t s = aspect.first_scan; s < aspect.end_scan; ++s) {
    double here = 0.0;
    for (std::size_t k = aspect.first_component; k < aspect.end_component; ++k) {
      here += counts_[s * dimension_ + k] / n;
    }
    found.constant_root += std::sqrt(here);
  }
  for (const std::size_t place : places) {
    found.common_terms += counts_[place] * std::max(counts_[place] - 1.0, 0.0) / (n * (n - 1.0));
  }
  return found;
}

}  // namespace montecarta::analysis
