// SPDX-License-Identifier: Apache-2.0
#include "core/map/extractor_parameters.h"

#include <array>
#include <charconv>
#include <stdexcept>

namespace floorloc {
namespace {

template <typename Number>
std::string ToText(Number value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

template <typename Number>
Number FromText(const std::string& name, const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw std::invalid_argument("extractor parameter '" + name + "' is not a number: '" + text + "'");
  }
  return value;
}

// Visits every field once, for writing and reading alike, so that they cannot differ.
template <typename Options, typename Visit>
void VisitFields(Options& o, const Visit& visit) {
  visit("max_keypoints", o.max_keypoints);
  visit("cell_px", o.cell_px);
  visit("levels", o.levels);
  visit("scale_factor", o.scale_factor);
  visit("threshold", o.threshold);
  visit("normalize_radius_px", o.normalize_radius_px);
  visit("smooth_sigma_px", o.smooth_sigma_px);
}

}  // namespace

std::map<std::string, std::string> ToParameters(const ExtractorOptions& options) {
  std::map<std::string, std::string> parameters{{"type", ToString(options.type)}};
  VisitFields(options, [&](const char* name, auto value) { parameters[name] = ToText(value); });
  return parameters;
}

ExtractorOptions FromParameters(const std::map<std::string, std::string>& parameters) {
  ExtractorOptions options;
  std::size_t used = 0;
  const auto text = [&](const std::string& name) {
    const auto it = parameters.find(name);
    if (it == parameters.end()) {
      throw std::invalid_argument("extractor parameter '" + name + "' is missing");
    }
    ++used;
    return it->second;
  };
  options.type = ParseExtractorType(text("type"));
  VisitFields(options, [&](const char* name, auto& value) {
    value = FromText<std::remove_reference_t<decltype(value)>>(name, text(name));
  });
  if (used != parameters.size()) {
    throw std::invalid_argument("the map has extractor parameters unknown to this version");
  }
  options.Check();
  return options;
}

}  // namespace floorloc
