// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/mosaic_block.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/io/image.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

constexpr int kCellPx = MosaicGrid::kCellPx;
constexpr std::size_t kKeptBytes = 192U << 20;
constexpr std::size_t kBatchBytes = 64U << 20;
constexpr int kStripeRows = 8;  // of cells

// Pixels with a smaller weight are dropped: the outermost ones of a frame, where no other frame covers the floor.
constexpr float kMinShare = 0.02F;

// Depth inside their view at which new images fully replace the background.
constexpr float kBackgroundFadePx = 32.0F;

std::vector<SurveyView> ViewsOf(const MosaicInput& input) {
  std::vector<SurveyView> views;
  for (std::size_t s = 0; s < input.surveys.size(); ++s) {
    views.emplace_back(input.surveys[s], input.exposure.flat_field[s]);
  }
  return views;
}

// Pixels of the survey's resolution per mosaic pixel.
int ShrinkFor(const MosaicInput& input, double resolution_m) {
  if (input.surveys.empty()) {
    return 1;  // background only
  }
  return std::max(1, static_cast<int>(resolution_m / input.surveys.front().survey.camera.floor.resolution_m + 1e-6));
}

std::size_t BatchFor(const MosaicInput& input, int shrink) {
  std::size_t largest = 1;
  for (const LoadedSurvey& survey : input.surveys) {
    const CameraModel& camera = survey.survey.camera.camera;
    largest = std::max(largest, static_cast<std::size_t>(camera.width_px) * static_cast<std::size_t>(camera.height_px));
  }
  const std::size_t bytes = 4 * largest / static_cast<std::size_t>(shrink * shrink);
  return std::clamp<std::size_t>(kBatchBytes / std::max<std::size_t>(bytes, 1), 1, 64);
}

// Candidates chosen at any node.
std::vector<int> ChosenCandidates(const NodeChoices& choices, std::size_t candidates) {
  std::vector<bool> chosen(candidates, false);
  for (const NodeChoice& choice : choices) {
    for (const NodeChoice::Chosen& c : choice.chosen) {
      if (c.candidate >= 0) {
        chosen[static_cast<std::size_t>(c.candidate)] = true;
      }
    }
  }
  std::vector<int> list;
  for (std::size_t c = 0; c < candidates; ++c) {
    if (chosen[c]) {
      list.push_back(static_cast<int>(c));
    }
  }
  return list;
}

RectM Grown(const RectM& rect, double by_m) {
  return {rect.x_min - by_m, rect.x_max + by_m, rect.y_min - by_m, rect.y_max + by_m};
}

// Weight of the new images against the background, CV_32F per pixel.
cv::Mat ShareOfNew(const MosaicGrid& grid, const NodeChoices& choices) {
  cv::Mat at_nodes(grid.nodes(), grid.nodes(), CV_32F);
  std::transform(choices.begin(), choices.end(), at_nodes.begin<float>(),
                 [](const NodeChoice& choice) { return std::min(choice.depth_px / kBackgroundFadePx, 1.0F); });
  const cv::Mat node_from_pixel = (cv::Mat_<double>(2, 3) << 1.0 / kCellPx, 0.0, 0.0, 0.0, 1.0 / kCellPx, 0.0);
  cv::Mat share;
  cv::warpAffine(at_nodes, share, node_from_pixel, cv::Size(grid.side_px, grid.side_px),
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return share;
}

}  // namespace

BlockBlender::BlockBlender(const MosaicInput& input, double resolution_m, int threads)
    : input_(input),
      threads_(threads),
      shrink_(ShrinkFor(input, resolution_m)),
      batch_(BatchFor(input, shrink_)),
      index_(input.map_from_base, FloorsInBase(input.frames, input.surveys)),
      surveys_(ViewsOf(input)),
      exposure_field_(input, index_, surveys_),
      images_([this](int frame) { return Load(frame); }, kKeptBytes) {}

SourceImage BlockBlender::Load(int frame) const {
  const BuildFrame& f = input_.frames[static_cast<std::size_t>(frame)];
  const LoadedSurvey& from = input_.surveys[static_cast<std::size_t>(f.survey)];
  const Survey& survey = from.survey;
  const CameraModel& camera = survey.camera.camera;
  return MakeSourceImage(ReadColorImage(survey.ImagePath(f.info), camera.width_px, camera.height_px), from.survey.mask,
                         shrink_);
}

MosaicPatch BlockBlender::Blend(const RectM& square, int side_px) {
  const MosaicGrid grid{square, side_px};
  const std::vector<int> frames = index_.Touching(Grown(square, 2.0 * kCellPx * grid.step_m()));
  const MosaicPatch older = input_.background ? input_.background(square, side_px) : MosaicPatch();
  if (frames.empty()) {
    return older.bgr.empty() ? MosaicPatch::Empty(side_px) : older;
  }
  sums_.Reset(grid);
  const NodeChoices choices = AddFrames(grid, frames);
  const MosaicPatch newer = Finish(grid);
  return older.bgr.empty() ? newer : BlendOver(newer, older, ShareOfNew(grid, choices));
}

NodeChoices BlockBlender::AddFrames(const MosaicGrid& grid, const std::vector<int>& frames) {
  std::vector<FrameView> views;
  for (const int frame : frames) {
    const auto i = static_cast<std::size_t>(frame);
    views.emplace_back(surveys_[static_cast<std::size_t>(input_.frames[i].survey)], *input_.map_from_base[i],
                       input_.frames[i]);
  }
  NodeChoices choices = ChooseFrames(grid, views);
  const std::vector<int> chosen = ChosenCandidates(choices, views.size());
  const int stripes = (grid.nodes() + kStripeRows - 1) / kStripeRows;
  // Loads a few frames at a time. Every stripe adds them in the same order, since float sums depend on it.
  for (std::size_t first = 0; first < chosen.size(); first += batch_) {
    std::vector<std::optional<FrameLayer>> layers(std::min(batch_, chosen.size() - first));
    ParallelFor(static_cast<int>(layers.size()), threads_, [&](int i) {
      const int candidate = chosen[first + static_cast<std::size_t>(i)];
      const auto c = static_cast<std::size_t>(candidate);
      const FrameLayer::Source source{candidate, views[c], exposure_field_.GainOf(frames[c]), images_.Get(frames[c])};
      layers[static_cast<std::size_t>(i)].emplace(source, choices, grid);
    });
    ParallelFor(stripes, threads_, [&](int stripe) {
      for (const auto& layer : layers) {
        layer->AddTo(&sums_, stripe * kStripeRows, (stripe + 1) * kStripeRows);
      }
    });
  }
  return choices;
}

MosaicPatch BlockBlender::Finish(const MosaicGrid& grid) const {
  MosaicPatch patch = MosaicPatch::Empty(grid.side_px);
  ParallelFor(grid.cells(), threads_, [&](int cell_row) {
    const int end = std::min((cell_row + 1) * kCellPx, grid.side_px);
    for (int row = cell_row * kCellPx; row < end; ++row) {
      FinishRow(grid, row, &patch);
    }
  });
  return patch;
}

void BlockBlender::FinishRow(const MosaicGrid& grid, int row, MosaicPatch* patch) const {
  const double y = grid.square.y_max - (row + 0.5) * grid.step_m();
  if (y < input_.extent.y_min || y > input_.extent.y_max) {
    return;
  }
  const float down = static_cast<float>(row % kCellPx) / kCellPx;
  const auto* upper = sums_.low_band.ptr<cv::Vec4f>(row / kCellPx);
  const auto* lower = sums_.low_band.ptr<cv::Vec4f>(row / kCellPx + 1);
  const auto* color = sums_.color.ptr<cv::Vec4f>(row);
  auto* bgr = patch->bgr.ptr<cv::Vec3b>(row);
  auto* valid = patch->valid.ptr<std::uint8_t>(row);
  for (int column = 0; column < grid.side_px; ++column) {
    const double x = grid.square.x_min + (column + 0.5) * grid.step_m();
    const float share = color[column][3];
    if (share < kMinShare || x < input_.extent.x_min || x > input_.extent.x_max) {
      continue;
    }
    const int node = column / kCellPx;
    const float right = static_cast<float>(column % kCellPx) / kCellPx;
    const cv::Vec4f left_low_band = upper[node] + down * (lower[node] - upper[node]);
    const cv::Vec4f right_low_band = upper[node + 1] + down * (lower[node + 1] - upper[node + 1]);
    const cv::Vec4f low_band = left_low_band + right * (right_low_band - left_low_band);
    for (int c = 0; c < 3; ++c) {
      bgr[column][c] = cv::saturate_cast<std::uint8_t>(color[column][c] / share + low_band[c]);
    }
    valid[column] = 255;
  }
}

}  // namespace floorloc
