// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/camera_copies.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

constexpr int kBlockPx = 8;

// Decoded tiles that are kept, bytes.
constexpr std::size_t kTileMemory = std::size_t{64} << 20;

// Numbers that a block's texture has, of its pixels: neighbours resemble each other.
constexpr double kFreedom = 12.0;

// The view of a camera, seen from above.
struct ViewFrame {
  explicit ViewFrame(const RectM& region, int longer_side) : roi(region) {
    pixel_m = std::max(roi.width_m(), roi.height_m()) / (longer_side * kBlockPx);
    columns = std::max(1, static_cast<int>(std::lround(roi.height_m() / pixel_m)) / kBlockPx);
    rows = std::max(1, static_cast<int>(std::lround(roi.width_m() / pixel_m)) / kBlockPx);
  }
  Eigen::Vector2d BaseFromPixel(double u, double v) const {
    return {roi.x_max - (v + 0.5) * pixel_m, roi.y_max - (u + 0.5) * pixel_m};
  }

  RectM roi;
  double pixel_m = 0.0;
  int columns = 0, rows = 0;  // blocks
};

// Sums over frames of the texture of each block.
class BlockSums {
 public:
  BlockSums(const ViewFrame& view, double min_floor)
      : view_(view),
        min_floor_(min_floor),
        sum_(cv::Mat::zeros(view.rows * kBlockPx, view.columns * kBlockPx, CV_32F)),
        frames_(cv::Mat::zeros(view.rows, view.columns, CV_32F)) {}

  // mosaic: CV_32FC1 of the view's size; known: CV_8UC1, 255 where it shows floor.
  void Add(const cv::Mat& mosaic, const cv::Mat& known) {
    for (int row = 0; row < view_.rows; ++row) {
      for (int column = 0; column < view_.columns; ++column) {
        AddBlock(mosaic, known, BlockAt(row, column), &frames_.at<float>(row, column));
      }
    }
  }

  // Mean correlation of a block over all pairs of frames; 0 with fewer than two.
  double Correlation(int row, int column) const {
    const double n = Frames(row, column);
    const double norm = cv::norm(sum_(BlockAt(row, column)));
    return n > 1.0 ? (norm * norm - n) / (n * (n - 1.0)) : 0.0;
  }
  double Frames(int row, int column) const { return static_cast<double>(frames_.at<float>(row, column)); }

 private:
  // Adds the texture of a block as a unit vector; unless too little of it shows floor.
  void AddBlock(const cv::Mat& mosaic, const cv::Mat& known, const cv::Rect& where, float* frames) {
    double sum = 0.0;
    double squares = 0.0;
    int pixels = 0;
    for (int v = where.y; v < where.y + where.height; ++v) {
      for (int u = where.x; u < where.x + where.width; ++u) {
        if (known.at<std::uint8_t>(v, u) == 255) {
          const auto value = static_cast<double>(mosaic.at<float>(v, u));
          sum += value;
          squares += value * value;
          ++pixels;
        }
      }
    }
    const double variation = pixels > 0 ? squares - sum * sum / pixels : 0.0;
    if (pixels < min_floor_ * where.area() || variation <= 0.0) {
      return;
    }
    const double mean = sum / pixels;
    const double norm = std::sqrt(variation);
    for (int v = where.y; v < where.y + where.height; ++v) {
      for (int u = where.x; u < where.x + where.width; ++u) {
        if (known.at<std::uint8_t>(v, u) == 255) {
          sum_.at<float>(v, u) += static_cast<float>((static_cast<double>(mosaic.at<float>(v, u)) - mean) / norm);
        }
      }
    }
    *frames += 1.0F;
  }
  static cv::Rect BlockAt(int row, int column) { return {column * kBlockPx, row * kBlockPx, kBlockPx, kBlockPx}; }

  const ViewFrame& view_;
  double min_floor_;
  cv::Mat sum_;
  cv::Mat frames_;
};

// Leaves the connected regions that cover at least this share: what travels with a camera is of one piece.
cv::Mat LargeRegions(const cv::Mat& blocks, double min_share) {
  cv::Mat labels, stats, centroids;
  const int count = cv::connectedComponentsWithStats(blocks, labels, stats, centroids, 4);
  cv::Mat large = cv::Mat::zeros(blocks.size(), CV_8U);
  for (int i = 1; i < count; ++i) {
    if (stats.at<int>(i, cv::CC_STAT_AREA) >= min_share * static_cast<double>(blocks.total())) {
      large.setTo(255, labels == i);
    }
  }
  return large;
}

class CopyFinder {
 public:
  CopyFinder(const MosaicRaster& raster, const ViewFrame& view, const CameraCopyOptions& options)
      : raster_(raster), view_(view), options_(options), real_(view, options.min_floor) {
    for (int i = 0; i < options.controls; ++i) {
      controls_.emplace_back(view, options.min_floor);
    }
  }

  // heading: direction of the frame's motion, base frame.
  void Add(const Pose2& map_from_base, const Eigen::Vector2d& heading) {
    AddTo(map_from_base, &real_);
    const double longer_m = std::max(view_.roi.width_m(), view_.roi.height_m());
    for (BlockSums& control : controls_) {
      std::uniform_real_distribution<double> shift(options_.min_shift, options_.max_shift);
      const double sign = random_() % 2 == 0 ? 1.0 : -1.0;
      const Eigen::Vector2d beside = sign * shift(random_) * longer_m * heading;
      AddTo(map_from_base * Pose2(beside.x(), beside.y(), 0.0), &control);
    }
  }

  cv::Mat Repeating() const;

 private:
  void AddTo(const Pose2& map_from_base, BlockSums* sums) const;

  const MosaicRaster& raster_;
  const ViewFrame& view_;
  const CameraCopyOptions& options_;
  BlockSums real_;
  std::vector<BlockSums> controls_;
  std::mt19937 random_{1};
};

void CopyFinder::AddTo(const Pose2& map_from_base, BlockSums* sums) const {
  const Eigen::Vector2d middle = map_from_base * view_.roi.Center();
  const double reach_m = 0.5 * std::hypot(view_.roi.width_m(), view_.roi.height_m()) + 2.0 * view_.pixel_m;
  const RasterPatch patch =
      raster_.Cut({middle.x() - reach_m, middle.x() + reach_m, middle.y() - reach_m, middle.y() + reach_m});
  if (patch.gray.empty()) {
    return;
  }
  // Shrunk by an integer before it is turned: means instead of samples.
  const int shrink = std::max(1, static_cast<int>(view_.pixel_m / patch.resolution_m));
  const cv::Size size(patch.gray.cols / shrink, patch.gray.rows / shrink);
  if (size.empty()) {
    return;
  }
  const cv::Mat whole = patch.gray(cv::Rect(0, 0, size.width * shrink, size.height * shrink));
  cv::Mat gray;
  cv::Mat known;
  cv::resize(whole, gray, size, 0, 0, cv::INTER_AREA);
  cv::resize(whole > 0, known, size, 0, 0, cv::INTER_AREA);
  const auto pixel = [&](double u, double v) -> Eigen::Vector2d {
    const Eigen::Vector2d px = patch.PixelFromMap(map_from_base * view_.BaseFromPixel(u, v));
    return (px.array() + 0.5) / shrink - 0.5;
  };
  const Eigen::Vector2d origin = pixel(0, 0), right = pixel(1, 0) - origin, down = pixel(0, 1) - origin;
  const cv::Matx23d map(right.x(), down.x(), origin.x(), right.y(), down.y(), origin.y());
  const cv::Size view(view_.columns * kBlockPx, view_.rows * kBlockPx);
  gray.convertTo(gray, CV_32F);
  cv::warpAffine(gray, gray, map, view, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
  cv::warpAffine(known, known, map, view, cv::INTER_NEAREST | cv::WARP_INVERSE_MAP);
  sums->Add(gray, known);
}

cv::Mat CopyFinder::Repeating() const {
  cv::Mat repeats = cv::Mat::zeros(view_.rows, view_.columns, CV_8U);
  for (int row = 0; row < view_.rows; ++row) {
    for (int column = 0; column < view_.columns; ++column) {
      double by_floor = 0.0;
      double frames = real_.Frames(row, column);
      for (const BlockSums& control : controls_) {
        by_floor = std::max(by_floor, control.Correlation(row, column));
        frames = std::min(frames, control.Frames(row, column));
      }
      if (frames < options_.min_frames) {
        continue;
      }
      const double sigma = std::sqrt(2.0 / kFreedom) / frames;
      const double limit = std::max(options_.min_correlation, options_.min_sigmas * sigma);
      // Where the floor repeats itself beside the frames' places, it may do so at them.
      const bool repeats_here = by_floor < limit && real_.Correlation(row, column) - by_floor > limit;
      repeats.at<std::uint8_t>(row, column) = repeats_here ? 255 : 0;
    }
  }
  const cv::Mat square = cv::Mat::ones(options_.min_side_blocks, options_.min_side_blocks, CV_8U);
  cv::morphologyEx(repeats, repeats, cv::MORPH_OPEN, square, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  return LargeRegions(repeats, options_.min_share);
}

std::vector<const MapFrame*> FramesOf(const std::vector<MapFrame>& frames, int survey) {
  std::vector<const MapFrame*> chosen;
  for (const MapFrame& frame : frames) {
    if (frame.survey == survey) {
      chosen.push_back(&frame);
    }
  }
  std::sort(chosen.begin(), chosen.end(), [](const auto* a, const auto* b) { return a->stamp_ns < b->stamp_ns; });
  return chosen;
}

// Direction of motion at a frame, base frame; forward where it does not move.
Eigen::Vector2d HeadingAt(const std::vector<const MapFrame*>& frames, std::size_t i) {
  const std::size_t from = i > 0 ? i - 1 : i;
  const std::size_t to = std::min(i + 1, frames.size() - 1);
  const Eigen::Vector2d moved = frames[to]->map_from_base.translation() - frames[from]->map_from_base.translation();
  const double length_m = moved.norm();
  return length_m > 1e-4 ? Eigen::Vector2d(Pose2(0.0, 0.0, -frames[i]->map_from_base.yaw()) * (moved / length_m))
                         : Eigen::Vector2d(1.0, 0.0);
}

}  // namespace

void CameraCopyOptions::Check() const {
  RequireOption(min_frames >= 2, "min_frames must be at least 2");
  RequireOption(max_frames >= min_frames, "max_frames must be at least min_frames");
  RequireOption(blocks >= 4 && blocks <= 128, "blocks must be 4 to 128");
  RequireOption(controls >= 1, "controls must be at least 1");
  RequireOption(min_shift > 0.0, "min_shift must be positive");
  RequireOption(max_shift > min_shift, "max_shift must be above min_shift");
  RequireOption(min_floor > 0.0 && min_floor <= 1.0, "min_floor must be above 0 and at most 1");
  RequireOption(min_sigmas > 0.0, "min_sigmas must be positive");
  RequireOption(min_correlation > 0.0 && min_correlation < 1.0, "min_correlation must be between 0 and 1");
  RequireOption(min_side_blocks >= 1, "min_side_blocks must be at least 1");
  RequireOption(min_share > 0.0 && min_share < 1.0, "min_share must be between 0 and 1");
}

std::vector<CameraCopies> FindCameraCopies(const FloorMap& map, const std::vector<MapFrame>& frames,
                                           const MosaicTileSource& tiles, const CameraCopyOptions& options) {
  options.Check();
  const MosaicRaster raster(tiles, map.mosaic, ContrastOptions(), kTileMemory);
  std::vector<CameraCopies> found;
  for (std::size_t survey = 0; survey < map.info.cameras.size(); ++survey) {
    const std::vector<const MapFrame*> of_survey = FramesOf(frames, static_cast<int>(survey));
    if (static_cast<int>(of_survey.size()) < options.min_frames) {
      continue;
    }
    const ViewFrame view(map.info.cameras[survey].floor.roi, options.blocks);
    CopyFinder finder(raster, view, options);
    const std::size_t step = (of_survey.size() - 1) / static_cast<std::size_t>(options.max_frames) + 1;
    CameraCopies copies;
    for (std::size_t i = 0; i < of_survey.size(); i += step) {
      finder.Add(of_survey[i]->map_from_base, HeadingAt(of_survey, i));
      ++copies.frames;
    }
    copies.survey = static_cast<int>(survey);
    copies.blocks = finder.Repeating();
    copies.share = static_cast<double>(cv::countNonZero(copies.blocks)) / static_cast<double>(copies.blocks.total());
    if (copies.share > 0.0) {
      found.push_back(std::move(copies));
    }
  }
  return found;
}

}  // namespace floorloc
