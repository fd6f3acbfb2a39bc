// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic_block.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "core/io/image.h"
#include "mapbuilder/parallel.h"
#include "mapbuilder/two_band_blender.h"

namespace floorloc {
namespace {

// Pixels -> frame picture: where each pixel of the patch lies in the frame's rectified picture.
cv::Mat FramePixelFromPatchPixel(const Pose2& base_from_map, const GroundGrid& grid, const RectM& square, int side_px) {
  const double step = square.width_m() / side_px;
  const auto frame_pixel = [&](double u, double v) {
    const Eigen::Vector2d map_point(square.x_min + (u + 0.5) * step, square.y_max - (v + 0.5) * step);
    return grid.PixelFromBase(base_from_map * map_point);
  };
  const Eigen::Vector2d origin = frame_pixel(0.0, 0.0);
  const Eigen::Vector2d du = frame_pixel(1.0, 0.0) - origin;
  const Eigen::Vector2d dv = frame_pixel(0.0, 1.0) - origin;
  return (cv::Mat_<double>(2, 3) << du.x(), dv.x(), origin.x(), du.y(), dv.y(), origin.y());
}

// The frame's picture in float, with camera and light divided out.
cv::Mat ReadFramePicture(const MosaicInput& input, int frame) {
  const BuildFrame& f = input.frames[static_cast<std::size_t>(frame)];
  const LoadedSurvey& survey = input.surveys[static_cast<std::size_t>(f.survey)];
  const CameraModel& camera = survey.survey.camera.camera;
  const cv::Mat raw = ReadColorImage(survey.survey.ImagePath(f.info), camera.width_px, camera.height_px);
  cv::Mat picture;
  survey.rectifier->RectifyPicture(raw).convertTo(picture, CV_32F,
                                                  input.exposure.frame_gain[static_cast<std::size_t>(frame)]);
  cv::Mat gain;
  cv::cvtColor(input.exposure.flat_field[static_cast<std::size_t>(f.survey)], gain, cv::COLOR_GRAY2BGR);
  return picture.mul(gain);
}

}  // namespace

bool MosaicPatch::empty() const { return cv::countNonZero(seen) == 0; }

std::vector<int> FramesTouching(const MosaicInput& input, const RectM& square) {
  const Eigen::AlignedBox2d wanted(Eigen::Vector2d(square.x_min, square.y_min),
                                   Eigen::Vector2d(square.x_max, square.y_max));
  std::vector<int> touching;
  for (std::size_t i = 0; i < input.frames.size(); ++i) {
    if (!input.map_from_base[i]) {
      continue;
    }
    const RectM& roi = input.surveys[static_cast<std::size_t>(input.frames[i].survey)].survey.camera.floor.roi;
    Eigen::AlignedBox2d seen;
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(roi.x_min, roi.y_min), Eigen::Vector2d(roi.x_min, roi.y_max),
          Eigen::Vector2d(roi.x_max, roi.y_min), Eigen::Vector2d(roi.x_max, roi.y_max)}) {
      seen.extend(*input.map_from_base[i] * corner);
    }
    if (wanted.intersects(seen)) {
      touching.push_back(static_cast<int>(i));
    }
  }
  return touching;
}

MosaicPatch BlendPatch(const MosaicInput& input, const std::vector<int>& frames, const RectM& square, int side_px,
                       int threads) {
  std::vector<FeatherWeights> feather;
  for (const LoadedSurvey& survey : input.surveys) {
    feather.push_back(MakeFeatherWeights(survey.rectifier->mask()));
  }
  // Pictures are read in parallel, a few at a time, and added in order: float sums depend on it.
  constexpr std::size_t kBatch = 16;
  TwoBandBlender blender(side_px);
  for (std::size_t first = 0; first < frames.size(); first += kBatch) {
    const std::size_t count = std::min(kBatch, frames.size() - first);
    std::vector<BandedPicture> pictures(count);
    const auto survey_of = [&](std::size_t i) {
      return static_cast<std::size_t>(input.frames[static_cast<std::size_t>(frames[first + i])].survey);
    };
    ParallelFor(static_cast<int>(count), threads, [&](int index) {
      const auto i = static_cast<std::size_t>(index);
      const std::size_t survey = survey_of(i);
      pictures[i] = SplitBands(ReadFramePicture(input, frames[first + i]), input.surveys[survey].rectifier->mask(),
                               feather[survey]);
    });
    for (std::size_t i = 0; i < count; ++i) {
      const auto frame = static_cast<std::size_t>(frames[first + i]);
      const std::size_t survey = survey_of(i);
      blender.Add(pictures[i], feather[survey],
                  FramePixelFromPatchPixel(input.map_from_base[frame]->Inverse(),
                                           input.surveys[survey].rectifier->grid(), square, side_px));
    }
  }
  MosaicPatch patch;
  blender.Finish(&patch.bgr, &patch.seen);
  return patch;
}

MosaicPatch ShrinkFour(const std::vector<MosaicPatch>& four) {
  const int side = four.front().bgr.cols;
  cv::Mat color = cv::Mat::zeros(2 * side, 2 * side, CV_32FC3);
  cv::Mat weight = cv::Mat::zeros(2 * side, 2 * side, CV_32F);
  for (std::size_t i = 0; i < four.size(); ++i) {
    const bool right = i % 2 == 1;
    const bool upper = i >= 2;  // y runs up, rows run down
    const cv::Rect place(right ? side : 0, upper ? 0 : side, side, side);
    four[i].bgr.convertTo(color(place), CV_32F);  // unseen pixels are zero
    four[i].seen.convertTo(weight(place), CV_32F, 1.0 / 255.0);
  }
  MosaicPatch patch;
  cv::Mat small_color;
  cv::Mat small_weight;
  cv::resize(color, small_color, cv::Size(side, side), 0, 0, cv::INTER_AREA);
  cv::resize(weight, small_weight, cv::Size(side, side), 0, 0, cv::INTER_AREA);
  patch.seen = small_weight > 0.01F;
  cv::Mat weight3;
  cv::cvtColor(cv::max(small_weight, 0.01), weight3, cv::COLOR_GRAY2BGR);
  cv::Mat mean = small_color / weight3;
  mean.convertTo(patch.bgr, CV_8UC3);
  return patch;
}

}  // namespace floorloc
