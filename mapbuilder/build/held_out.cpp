// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/held_out.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/geometry/option_check.h"
#include "core/io/image.h"
#include "core/localization/localizer.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/coverage/cell_key.h"
#include "mapbuilder/coverage/coverage.h"

namespace floorloc {
namespace {

Eigen::Vector2d ViewCenter(const PlacedSurvey& placed, int frame) {
  const auto i = static_cast<std::size_t>(frame);
  return *placed.map_from_base[i] * placed.floor_in_base[i].Center();
}

// Share of the frame's view that at least min_others other frames cover, sampled on a lattice.
double CoveredShare(const PlacedSurvey& placed, const CoverageGrid& coverage, int frame, int min_others) {
  constexpr int kLattice = 6;
  const auto i = static_cast<std::size_t>(frame);
  const RectM& floor = placed.floor_in_base[i];
  int covered = 0;
  for (int row = 0; row < kLattice; ++row) {
    for (int column = 0; column < kLattice; ++column) {
      const Eigen::Vector2d point(floor.x_min + floor.width_m() * (column + 0.5) / kLattice,
                                  floor.y_min + floor.height_m() * (row + 0.5) / kLattice);
      covered += coverage.CountAt(*placed.map_from_base[i] * point) > min_others ? 1 : 0;
    }
  }
  return static_cast<double>(covered) / (kLattice * kLattice);
}

FloorMap MapWithout(const std::vector<int>& held_out, const PlacedSurvey& placed, const HeldOutOptions& options) {
  std::vector<std::optional<Pose2>> map_from_base = placed.map_from_base;
  for (const int frame : held_out) {
    map_from_base[static_cast<std::size_t>(frame)].reset();
  }
  FloorMap map;
  map.keypoints = FuseKeypoints({placed.frames, map_from_base, placed.floor_in_base}, options.fusion);
  map.info.extractor = options.extractor;
  map.info.cameras = {placed.surveys.front().survey.camera};
  map.info.area_m2 = CoverageGrid(map_from_base, placed.floor_in_base).AreaM2();
  return map;
}

HeldOutFrame LocalizeHeldOutFrame(const Localizer& localizer, const PlacedSurvey& placed, int frame,
                                  const HeldOutOptions& options) {
  const auto i = static_cast<std::size_t>(frame);
  const BuildFrame& sought = placed.frames[i];
  const LoadedSurvey& loaded = placed.surveys[static_cast<std::size_t>(sought.survey)];
  const CameraModel& camera = loaded.survey.camera.camera;
  const cv::Mat raw = ReadGrayImage(loaded.survey.ImagePath(sought.info), camera.width_px, camera.height_px);
  const std::shared_ptr<const Rectifier> rectifier =
      sought.height_ratio == 1.0 ? loaded.rectifier
                                 : std::make_shared<Rectifier>(CameraOf(sought, placed.surveys), loaded.survey.mask);
  const LocalizationResult found =
      localizer.Localize(localizer.Observe(*rectifier, raw, sought.readout_motion), std::nullopt);
  HeldOutFrame result{sought.info.filename, *placed.map_from_base[i], ToString(found.status), ToString(found.reason)};
  result.keypoints = found.keypoints;
  result.inliers = found.inliers;
  if (found.status == LocalizationStatus::kLocalized) {
    const Eigen::Vector2d center = placed.floor_in_base[i].Center();
    result.error_m = (found.map_from_base * center - result.map_from_base * center).norm();
    result.error_rad = std::abs(WrapAngle(found.map_from_base.yaw() - result.map_from_base.yaw()));
    if (result.error_m > options.wrong_m || result.error_rad > options.wrong_rad) {
      result.status = "wrong";
    }
  }
  return result;
}

}  // namespace

void HeldOutOptions::Check() const {
  extractor.Check();
  fusion.Check();
  RequireOption(max_frames >= 0, "max_frames must be 0 or more");
  RequireOption(max_share >= 0.0 && max_share <= 1.0, "max_share must be 0 to 1");
  RequireOption(min_covered_share >= 0.0 && min_covered_share <= 1.0, "min_covered_share must be 0 to 1");
  RequireOption(min_others >= 1, "min_others must be at least 1");
  RequireOption(wrong_m > 0.0, "wrong_m must be positive");
  RequireOption(wrong_rad > 0.0, "wrong_rad must be positive");
  run.Check();
}

std::vector<int> ChooseHeldOut(const PlacedSurvey& placed, const HeldOutOptions& options) {
  options.Check();
  const CoverageGrid coverage(placed.map_from_base, placed.floor_in_base);
  const auto count = static_cast<double>(placed.frames.size());
  const double wanted = std::min<double>(options.max_frames, options.max_share * count);
  std::vector<int> chosen;
  if (wanted < 1.0) {
    return chosen;
  }
  const RectM& view = placed.floor_in_base.front();
  const double apart_m = std::max(std::hypot(view.width_m(), view.height_m()), std::sqrt(coverage.AreaM2() / wanted));
  std::unordered_map<std::int64_t, std::vector<Eigen::Vector2d>> cells;
  for (int frame = 0; frame < static_cast<int>(placed.frames.size()); ++frame) {
    if (!placed.map_from_base[static_cast<std::size_t>(frame)]) {
      continue;
    }
    const Eigen::Vector2d center = ViewCenter(placed, frame);
    bool near = false;
    for (const int dx : {-1, 0, 1}) {
      for (const int dy : {-1, 0, 1}) {
        const auto cell = cells.find(CellKey(center + apart_m * Eigen::Vector2d(dx, dy), apart_m));
        near =
            near || (cell != cells.end() && std::any_of(cell->second.begin(), cell->second.end(),
                                                        [&](const auto& p) { return (p - center).norm() < apart_m; }));
      }
    }
    if (!near && CoveredShare(placed, coverage, frame, options.min_others) >= options.min_covered_share) {
      cells[CellKey(center, apart_m)].push_back(center);
      chosen.push_back(frame);
    }
  }
  return chosen;
}

std::vector<HeldOutFrame> LocalizeHeldOut(const PlacedSurvey& placed, const HeldOutOptions& options) {
  const std::vector<int> chosen = ChooseHeldOut(placed, options);
  std::vector<HeldOutFrame> results(chosen.size());
  if (chosen.empty()) {
    return results;
  }
  const Localizer localizer(MapWithout(chosen, placed, options), {});
  ParallelFor(static_cast<int>(chosen.size()), options.run.threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    results[index] = LocalizeHeldOutFrame(localizer, placed, chosen[index], options);
  });
  return results;
}

}  // namespace floorloc
