// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/whole_floor.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/input_error.h"
#include "mapbuilder/coverage/coverage.h"
#include "mapbuilder/mosaic/mosaic.h"
#include "mapbuilder/placement/place_frames.h"
#include "mapbuilder/survey/extract_frames.h"

namespace floorloc {
namespace {

constexpr double kMaxPixels = 1.5e8;

// Placement by ground truth; empty when the survey has none for its frames.
std::optional<Placement> PlaceByTruth(const std::vector<BuildFrame>& frames, const Survey& survey) {
  Placement placement;
  placement.map_from_base.resize(frames.size());
  std::size_t placed = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    placement.map_from_base[i] = InterpolatePose(survey.ground_truth, frames[i].info.stamp_ns);
    placed += placement.map_from_base[i] ? 1 : 0;
  }
  return placed > 0 ? std::optional(placement) : std::nullopt;
}

Placement PlaceByBuilder(const std::vector<BuildFrame>& frames, const std::vector<LoadedSurvey>& surveys,
                         const RunOptions& run) {
  PlacementOptions placement;
  placement.registration.run = run;
  placement.registration.resolution_m = surveys.front().survey.camera.floor.resolution_m;
  return PlaceFrames(frames, surveys, placement);
}

// Assembles the finest tiles of a mosaic into one grey image.
class MosaicCanvas {
 public:
  MosaicCanvas(const RectM& extent, const MosaicLayout& layout) : layout_(layout) {
    const double side = layout.TileSide(layout.max_zoom);
    first_x_ = static_cast<int>(std::floor(extent.x_min / side));
    first_y_ = static_cast<int>(std::floor(extent.y_min / side));
    last_y_ = static_cast<int>(std::floor(extent.y_max / side));
    const int columns = static_cast<int>(std::floor(extent.x_max / side)) - first_x_ + 1;
    gray_ = cv::Mat::zeros((last_y_ - first_y_ + 1) * layout.tile_px, columns * layout.tile_px, CV_8UC1);
  }

  void Add(const MosaicTile& tile) {
    const cv::Rect rect((tile.id.x - first_x_) * layout_.tile_px, (last_y_ - tile.id.y) * layout_.tile_px,
                        layout_.tile_px, layout_.tile_px);
    if (tile.id.z == layout_.max_zoom && (rect & cv::Rect({0, 0}, gray_.size())) == rect) {
      cv::imdecode(tile.jpeg, cv::IMREAD_GRAYSCALE).copyTo(gray_(rect));
    }
  }

  FloorImage Finish() const {
    // Tiles are JPEG: unsurveyed areas are nearly black rather than black.
    cv::Mat mask = gray_ > 3;
    cv::morphologyEx(mask, mask, cv::MORPH_CLOSE, cv::Mat::ones(9, 9, CV_8U));
    const double side = layout_.TileSide(layout_.max_zoom);
    const double half = 0.5 * layout_.resolution_m;
    return FloorImage::FromMosaic(gray_, mask, {first_x_ * side + half, (last_y_ + 1) * side - half},
                                  layout_.resolution_m);
  }

 private:
  MosaicLayout layout_;
  int first_x_ = 0;
  int first_y_ = 0;
  int last_y_ = 0;
  cv::Mat gray_;
};

FloorImage Compose(const MosaicInput& input, const RunOptions& run) {
  MosaicOptions mosaic;
  mosaic.jpeg_quality = 97;
  mosaic.resolution_m = input.surveys.front().survey.camera.floor.resolution_m;
  mosaic.run = run;
  const double pixels = input.extent.width_m() * input.extent.height_m() / std::pow(mosaic.resolution_m, 2);
  if (pixels > kMaxPixels) {
    throw InputError(input.surveys.front().survey.folder,
                     "is too large for one image (" + std::to_string(static_cast<int>(pixels / 1e6)) +
                         " megapixels); take a part of the survey, or a coarser resolution in floor.yaml");
  }
  const MosaicLayout layout = MakeMosaicLayout(input.extent, mosaic);
  MosaicCanvas canvas(input.extent, layout);
  ComposeMosaic(input, layout, mosaic, [&](const std::vector<MosaicTile>& tiles) {
    std::for_each(tiles.begin(), tiles.end(), [&](const MosaicTile& tile) { canvas.Add(tile); });
  });
  return canvas.Finish();
}

}  // namespace

WholeFloor ComposeWholeFloor(const std::filesystem::path& survey_folder, const RunOptions& run) {
  run.Check();
  const std::vector<LoadedSurvey> surveys = LoadSurveys({survey_folder});
  const Survey& survey = surveys.front().survey;
  const std::vector<BuildFrame> frames = ExtractSurveyFrames(surveys, {ExtractorOptions(), run});
  const std::optional<Placement> truth = PlaceByTruth(frames, survey);
  const Placement placement = truth ? *truth : PlaceByBuilder(frames, surveys, run);
  const CoverageGrid coverage(placement.map_from_base, std::vector<RectM>(frames.size(), survey.camera.floor.roi));
  const Exposure exposure = EstimateExposure({frames, surveys, placement.links, placement.map_from_base});
  WholeFloor floor;
  floor.image = Compose({frames, surveys, placement.map_from_base, exposure, coverage.Extent()}, run);
  floor.true_poses = truth.has_value();
  floor.frames = static_cast<int>(std::count_if(placement.map_from_base.begin(), placement.map_from_base.end(),
                                                [](const auto& pose) { return pose.has_value(); }));
  return floor;
}

}  // namespace floorloc
