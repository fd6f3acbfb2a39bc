// SPDX-License-Identifier: Apache-2.0
#include "core/fusion/pose_fuser.h"

#include <stdexcept>

#include "core/fusion/pose_filter.h"
#include "core/fusion/simple_fuser.h"

namespace floorloc {
namespace {

constexpr FusionMethod kMethods[] = {FusionMethod::kEkf, FusionMethod::kIncrements, FusionMethod::kFixes,
                                     FusionMethod::kReplace, FusionMethod::kJumpFilter};

}  // namespace

const char* ToString(FusionMethod method) {
  switch (method) {
    case FusionMethod::kEkf:
      return "ekf";
    case FusionMethod::kIncrements:
      return "increments";
    case FusionMethod::kFixes:
      return "fixes";
    case FusionMethod::kReplace:
      return "replace";
    case FusionMethod::kJumpFilter:
      return "jump_filter";
  }
  return "";
}

FusionMethod ParseFusionMethod(const std::string& name) {
  std::string known;
  for (const FusionMethod method : kMethods) {
    if (name == ToString(method)) {
      return method;
    }
    known += (known.empty() ? "" : ", ") + std::string(ToString(method));
  }
  throw std::invalid_argument("unknown fusion method '" + name + "'; known are: " + known);
}

std::unique_ptr<PoseFuser> MakePoseFuser(FusionMethod method, const PoseFilterOptions& options) {
  options.Check();
  if (method == FusionMethod::kEkf) {
    return std::make_unique<PoseFilter>(options);
  }
  return std::make_unique<SimpleFuser>(method, options.gates);
}

}  // namespace floorloc
