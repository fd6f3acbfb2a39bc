// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/floor_check/floor_trial.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/map/camera_correction.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"

namespace floorloc {
namespace {

double Median(std::vector<double> values) {
  if (values.empty()) {
    return 0.0;
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double SearchMs(const LocalizationResult& result) {
  return result.timing.total_ms - result.timing.rectify_ms - result.timing.features_ms;
}

bool Found(const LocalizationResult& result) { return result.status != LocalizationStatus::kNotLocalized; }

struct Localizers {
  const Localizer& before;
  const Localizer& after;
};

FloorRow TryViews(const Localizers& by, const Rectifier& rectifier, const std::string& name,
                  const std::vector<cv::Mat>& images) {
  FloorRow row;
  row.views = name;
  std::vector<double> before_ms;
  std::vector<double> refused_ms;
  for (const cv::Mat& image : images) {
    const FrameObservation frame = by.before.Observe(rectifier, image);
    const LocalizationResult before = by.before.Localize(frame, std::nullopt);
    const LocalizationResult after = by.after.Localize(frame, std::nullopt);
    ++row.images;
    row.found_before += Found(before) ? 1 : 0;
    row.found_after += Found(after) ? 1 : 0;
    if (!Found(before)) {
      before_ms.push_back(SearchMs(before));
    }
    const bool refused = after.timing.match_ms == 0.0;
    const bool no_floor = after.reason == NotLocalizedReason::kNoFloor;
    const bool other_floor = after.reason == NotLocalizedReason::kOtherFloor;
    (refused ? row.no_floor_refused : row.no_floor_named) += no_floor ? 1 : 0;
    (refused ? row.other_floor_refused : row.other_floor_named) += other_floor ? 1 : 0;
    if (refused && (no_floor || other_floor)) {
      refused_ms.push_back(SearchMs(after));
    }
  }
  row.before_ms = Median(before_ms);
  row.refused_ms = Median(refused_ms);
  return row;
}

// The images as a vehicle might see the floor through a worse lens, and from speed.
std::vector<cv::Mat> Blurred(const std::vector<cv::Mat>& images, double sigma_px) {
  std::vector<cv::Mat> blurred;
  for (const cv::Mat& image : images) {
    cv::GaussianBlur(image, blurred.emplace_back(), {}, sigma_px);
  }
  return blurred;
}

std::vector<cv::Mat> Smeared(const std::vector<cv::Mat>& images, int length_px) {
  std::vector<cv::Mat> smeared;
  for (const cv::Mat& image : images) {
    cv::blur(image, smeared.emplace_back(), {length_px, 1});
  }
  return smeared;
}

std::vector<cv::Mat> Darkened(const std::vector<cv::Mat>& images, double gain) {
  cv::RNG rng(8);
  std::vector<cv::Mat> dark;
  for (const cv::Mat& image : images) {
    cv::Mat noise(image.size(), CV_32FC1), level;
    rng.fill(noise, cv::RNG::NORMAL, 0.0, 2.0);
    image.convertTo(level, CV_32FC1, gain);
    cv::Mat(level + noise).convertTo(dark.emplace_back(), CV_8UC1);
  }
  return dark;
}

}  // namespace

std::vector<FloorRow> TryFloor(const std::string& name, const Scene& scene, const std::vector<StrangeViews>& strange,
                               const std::filesystem::path& map_file) {
  BuildOptions options;
  options.surveys = {scene.survey};
  options.out = map_file;
  BuildMap(options);
  const MapDatabase database(map_file);
  const auto tiles = [&](const TileId& tile) { return database.ReadMosaicTile(tile); };
  LocalizerOptions unaware;
  unaware.floor.refused_share = unaware.floor.named_share = 0.0;
  const Localizer before(database.ReadMap(), unaware, tiles);
  const Localizer after(database.ReadMap(), LocalizerOptions(), tiles);
  const MapInfo& info = before.map().info;
  std::vector<FloorRow> rows;
  for (const FrameGroup& group : scene.groups) {
    const Rectifier rectifier(CorrectedOrGiven(info, group.camera).AtResolution(info.camera().floor.resolution_m));
    std::vector<cv::Mat> images;
    for (const SceneFrame& frame : group.frames) {
      images.push_back(frame.raw);
    }
    const auto add = [&](const std::string& views, const std::vector<cv::Mat>& shown) {
      rows.push_back(TryViews({before, after}, rectifier, group.name + views, shown));
    };
    add("", images);
    add(", blurred 2 px", Blurred(images, 2.0));
    add(", smeared 16 px", Smeared(images, 16));
    add(", gain 0.2", Darkened(images, 0.2));
    add(", gain 1.6", Darkened(images, 1.6));
  }
  const Rectifier rectifier(info.camera());
  for (const StrangeViews& views : strange) {
    if (views.name != name) {
      rows.push_back(TryViews({before, after}, rectifier, views.name, views.images));
    }
  }
  for (FloorRow& row : rows) {
    row.map = name;
  }
  return rows;
}

}  // namespace floorloc
