// SPDX-License-Identifier: BSD-3-Clause
#include "experiments/judging/covariance_columns.hpp"

#include "engine/errors.hpp"
#include "engine/formatted.hpp"
#include "engine/text/list_text.hpp"
#include "experiments/text/words.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace montecarta::experiments {
namespace {

/// Row and column of the covariance for every name that an element may have in the header.
std::map<std::string, std::pair<std::size_t, std::size_t>> names_of_elements(
    const Names& header, const StateShape& shape) {
  std::map<std::string, std::pair<std::size_t, std::size_t>> elements;
  const auto add = [&](const Names& components) {
    for (std::size_t i = 0; i < components.size(); ++i) {
      for (std::size_t j = 0; j < components.size(); ++j) {
        elements[formatted("{}{}_{}", kCovariancePrefix, components[i], components[j])] = {i, j};
      }
    }
  };
  Names indices, own = shape.components;
  for (std::size_t i = 0; i < own.size(); ++i) indices.push_back(std::to_string(i));
  add(indices);
  add(own);
  if (shape.kind == StateKind::pose) {
    const std::string heading = heading_in(header);
    own.back() = heading.substr(0, heading.rfind('_'));
    add(own);
  }
  return elements;
}

/// Throws StudyError if an element of the covariance has indices, but a state of more than a pose
/// in space has its columns in another order than that of its components.
void refuse_indices_out_of_order(const Names& header, std::size_t field, const StateShape& shape,
                                 const std::string& place) {
  const bool has_index = header[field].find_first_of("0123456789", kCovariancePrefix.size()) ==
                         kCovariancePrefix.size();
  if (!has_index || shape.kind != StateKind::pose_in_space ||
      shape.dimension() == static_cast<std::size_t>(kPoseComponents)) {
    return;
  }
  if (state_in_header(header) == shape.columns) return;
  throw StudyError(
      "{}: '{}' has indices, but the state has not the order {} (so a component has no certain "
      "number): write the names of components, or the columns in the order {}",
      place, header[field], joined(shape.components, ","), joined(shape.columns, ","));
}

/// The elements of a covariance in the columns of a header.
class CovarianceColumns {
 public:
  CovarianceColumns(const Names& header, const StateShape& shape, const std::string& place)
      : header_(header), shape_(shape), place_(place), found_(shape.dimension() * size()) {}

  /// Finds the columns, and fills what `fields` has of the covariance.
  void find(EstimateFields& fields) {
    if (find_deviations(fields)) return;
    find_elements();
    const std::vector<std::size_t> blocks = blocks_of_elements();
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t j = 0; j < size(); ++j) {
        const auto field = at(i, j);
        if (!field && blocks[i] == blocks[j]) refuse_missing(i, j);
        fields.covariance.push_back(field.value_or(EstimateFields::kNoField));
      }
    }
    fields.uncorrelated = words_of(blocks);
  }

 private:
  std::size_t size() const { return shape_.dimension(); }
  /// The column of an element, or of the one on the other side of the diagonal.
  std::optional<std::size_t> at(std::size_t i, std::size_t j) const {
    const auto& own = found_[i * size() + j];
    return own ? own : found_[j * size() + i];
  }
  bool is_element(const std::string& name) const { return name.starts_with(kCovariancePrefix); }

  void find_elements() {
    const auto elements = names_of_elements(header_, shape_);
    std::optional<std::size_t> unknown;
    for (std::size_t f = 0; f < header_.size(); ++f) {
      if (!is_element(header_[f])) continue;
      const auto element = elements.find(header_[f]);
      if (element == elements.end()) {
        unknown = unknown.value_or(f);
        continue;
      }
      refuse_indices_out_of_order(header_, f, shape_, place_);
      const auto [i, j] = element->second;
      if (found_[i * size() + j]) {
        throw StudyError("{}: '{}' is there by name and by index (which one is it?): remove one",
                         place_, header_[f]);
      }
      found_[i * size() + j] = f;
    }
    if (unknown) refuse_unknown(*unknown);
  }

  /// The name that an element has in a header of this kind.
  std::string element_name(std::size_t i, std::size_t j) const {
    const bool has_indices = std::ranges::any_of(header_, [&](const std::string& name) {
      return is_element(name) && name.find_first_of("0123456789") == kCovariancePrefix.size();
    });
    const auto part = [&](std::size_t k) {
      return has_indices ? std::to_string(k) : shape_.components[k];
    };
    return formatted("{}{}_{}", kCovariancePrefix, part(i), part(j));
  }

  [[noreturn]] void refuse_unknown(std::size_t field) const {
    std::string missing;
    for (std::size_t i = 0; i < size() && missing.empty(); ++i) {
      for (std::size_t j = i; j < size() && missing.empty(); ++j) {
        if (!at(i, j)) missing = element_name(i, j);
      }
    }
    throw StudyError(
        "{}: '{}' is no element of the covariance (its components are {}, or indices from 0): {}",
        place_, excerpt(header_[field]), joined(shape_.components),
        missing.empty() ? "remove it, since all elements are there"
                        : "the first that is missing is called " + missing);
  }

  [[noreturn]] void refuse_missing(std::size_t i, std::size_t j) const {
    throw StudyError(
        "{}: no {} (the state has the components {}; a verdict needs their whole covariance, one "
        "triangle of it, or whole blocks): add the column, or leave out what is not estimated",
        place_, element_name(i, j), joined(shape_.components, ","));
  }

  /// {component} The first component with which it is correlated, also through others.
  std::vector<std::size_t> blocks_of_elements() const {
    std::vector<std::size_t> block(size());
    for (std::size_t k = 0; k < size(); ++k) block[k] = k;
    for (std::size_t i = 0; i < size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (!at(i, j) || block[i] == block[j]) continue;
        const auto [first, last] = std::minmax(block[i], block[j]);
        std::ranges::replace(block, std::size_t(last), std::size_t(first));
      }
    }
    return block;
  }

  /// "between x,y and heading"; empty if there is one block.
  std::string words_of(const std::vector<std::size_t>& block) const {
    Names names;
    for (std::size_t first = 0; first < size(); ++first) {
      Names members;
      for (std::size_t k = 0; k < size(); ++k) {
        if (block[k] == first) members.push_back(shape_.components[k]);
      }
      if (!members.empty()) names.push_back(joined(members, ","));
    }
    return names.size() < 2 ? "" : "between " + joined(names, " and ");
  }

  /// Fills the fields by columns sigma_A. Returns false if there is none.
  bool find_deviations(EstimateFields& fields) {
    const Names& components = shape_.components;
    std::vector<std::size_t> places(size(), EstimateFields::kNoField);
    std::optional<std::size_t> any;
    for (std::size_t f = 0; f < header_.size(); ++f) {
      if (!is_deviation(header_[f], header_)) continue;
      any = f;
      const auto [component, unit] =
          component_and_unit(header_[f].substr(kSigmaPrefix.size()), place_);
      const std::size_t k = place_of_name(components, usual_component(component));
      if (k == size()) continue;  // of a column that is not estimated
      if (unit != shape_.units[k]) refuse_unit(f, k);
      places[k] = f;
    }
    if (!any) return false;
    if (std::ranges::any_of(header_, [&](const auto& name) { return is_element(name); })) {
      throw StudyError("{}: '{}' is beside columns of a covariance (which one is it?): remove one",
                       place_, header_[*any]);
    }
    for (std::size_t i = 0; i < size(); ++i) {
      if (places[i] == EstimateFields::kNoField) {
        throw StudyError(
            "{}: no {}{}_UNIT ({} is a standard deviation, and each component needs one): add the "
            "column",
            place_, kSigmaPrefix, components[i], header_[*any]);
      }
      for (std::size_t j = 0; j < size(); ++j)
        fields.covariance.push_back(i == j ? places[i] : EstimateFields::kNoField);
    }
    fields.are_deviations = true;
    std::vector<std::size_t> alone(size());
    for (std::size_t k = 0; k < size(); ++k) alone[k] = k;
    fields.uncorrelated = words_of(alone);
    return true;
  }

  [[noreturn]] void refuse_unit(std::size_t field, std::size_t k) const {
    throw StudyError("{}: '{}' is not in the unit of {}, {}: rename it to {}{}{}", place_,
                     excerpt(header_[field]), shape_.components[k], shape_.units[k], kSigmaPrefix,
                     shape_.components[k], shape_.units[k] == "1" ? "" : "_" + shape_.units[k]);
  }

  /// The component of a pose in the plane that is called so.
  std::string usual_component(const std::string& name) const {
    const bool is_heading = shape_.kind == StateKind::pose && has_name(kOtherHeadings, name);
    return is_heading ? shape_.components.back() : name;
  }

  const Names& header_;
  const StateShape& shape_;
  const std::string& place_;
  std::vector<std::optional<std::size_t>> found_;  ///< {d, d} columns
};

}  // namespace

void find_covariance(const Names& header, const std::string& place, EstimateFields& fields) {
  CovarianceColumns(header, fields.shape, place).find(fields);
}

void find_covariance_of_truth(Names columns, const std::string& place, const std::string& prefix,
                              EstimateFields& fields) {
  const StateShape& shape = fields.shape;
  const bool is_in_order = usual_names(state_in_header(columns)) == shape.columns;
  const auto elements = names_of_elements(columns, shape);
  for (std::string& name : columns) {
    if (!name.starts_with(kCovariancePrefix)) continue;
    const bool has_index = name.find_first_of("0123456789") == kCovariancePrefix.size();
    if (has_index && !is_in_order) {
      throw StudyError(
          "{}: '{}{}' has indices, but the truth has not the columns of the estimates in their "
          "order (so a component has no certain number): write names, e.g. {}{}{}_{}",
          place, prefix, name, prefix, kCovariancePrefix, shape.components.front(),
          shape.components.front());
    }
    if (!elements.contains(name)) name.clear();  // of what is not estimated
  }
  const std::string where =
      formatted("{} (covariance of the truth{})", place,
                prefix.empty() ? "" : formatted(", in columns {}cov_A_B", prefix));
  CovarianceColumns(columns, shape, where).find(fields);
}

}  // namespace montecarta::experiments
