// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/floor_wear.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr double kMaxShare = 0.9;
constexpr double kVisibleOpacity = 0.08;  // opacity from which on a pixel counts as changed
constexpr int kTallyStep = 4;             // changed area is counted on every 4th pixel

// An overlay on the floor: colour and opacity.
struct Mark {
  cv::Rect box;
  cv::Mat opacity;  // CV_32FC1, 0 ... 1
  cv::Scalar bgr;
};

// A blob with a wavy outline, for stains, leaves and chewing gum.
std::vector<cv::Point> BlobOutline(cv::RNG& rng, double radius_px, cv::Point center) {
  constexpr int kCorners = 40;
  const std::array<double, 3> phases = {rng.uniform(0.0, 6.28), rng.uniform(0.0, 6.28), rng.uniform(0.0, 6.28)};
  const double stretch = rng.uniform(0.55, 1.0);
  const double turn = rng.uniform(0.0, std::numbers::pi);
  std::vector<cv::Point> outline;
  for (int i = 0; i < kCorners; ++i) {
    const double a = 2.0 * std::numbers::pi * i / kCorners;
    const double r = radius_px * (1.0 + 0.2 * std::sin(2.0 * a + phases[0]) + 0.12 * std::sin(3.0 * a + phases[1]) +
                                  0.06 * std::sin(5.0 * a + phases[2]));
    const double x = r * std::cos(a);
    const double y = r * std::sin(a) * stretch;
    outline.emplace_back(center.x + static_cast<int>(x * std::cos(turn) - y * std::sin(turn)),
                         center.y + static_cast<int>(x * std::sin(turn) + y * std::cos(turn)));
  }
  return outline;
}

// A slightly curved line, for tyre marks and scratches.
std::vector<cv::Point> BentLine(cv::RNG& rng, double length_px, cv::Point center) {
  constexpr int kSteps = 24;
  double heading = rng.uniform(0.0, 2.0 * std::numbers::pi);
  const double bend = rng.gaussian(0.04);
  cv::Point2d p(center.x - 0.5 * length_px * std::cos(heading), center.y - 0.5 * length_px * std::sin(heading));
  std::vector<cv::Point> line;
  for (int i = 0; i <= kSteps; ++i, heading += bend) {
    line.emplace_back(p);
    p += cv::Point2d(std::cos(heading), std::sin(heading)) * (length_px / kSteps);
  }
  return line;
}

cv::Scalar BlobColor(cv::RNG& rng) {
  static const std::array<cv::Scalar, 5> kColors = {cv::Scalar(40, 62, 92), cv::Scalar(70, 72, 74),
                                                    cv::Scalar(222, 226, 228), cv::Scalar(96, 104, 116),
                                                    cv::Scalar(44, 46, 48)};
  return kColors[static_cast<std::size_t>(rng.uniform(0, static_cast<int>(kColors.size())))];
}

struct Finish {
  double opacity = 1.0;     // at the centre
  double edge_px = 1.2;     // width of the soft edge
  double unevenness = 0.0;  // 0 smooth ... 1 patchy
};

Mark FinishMark(const cv::Mat& shape, cv::Rect box, const Finish& finish, cv::RNG& rng) {
  Mark mark{box, {}, {}};
  shape.convertTo(mark.opacity, CV_32FC1, finish.opacity / 255.0);
  cv::GaussianBlur(mark.opacity, mark.opacity, {}, finish.edge_px);
  const cv::Mat noise = FractalNoise(box.size(), {9.0, 9.0, 2}, DeriveSeed(static_cast<std::uint64_t>(rng.next()), 0));
  mark.opacity = mark.opacity.mul(1.0 - finish.unevenness * (0.5 + 0.5 * noise));
  cv::min(mark.opacity, 1.0, mark.opacity);
  cv::max(mark.opacity, 0.0, mark.opacity);
  return mark;
}

Mark MakeBlob(cv::RNG& rng, cv::Point center, double px_per_m) {
  const double radius_px = px_per_m * (0.004 + 0.026 * std::pow(rng.uniform(0.0, 1.0), 2.0));
  const int reach = static_cast<int>(1.5 * radius_px) + 6;
  const cv::Rect box(center.x - reach, center.y - reach, 2 * reach + 1, 2 * reach + 1);
  cv::Mat shape = cv::Mat::zeros(box.size(), CV_8UC1);
  cv::fillPoly(shape, std::vector{BlobOutline(rng, radius_px, {reach, reach})}, cv::Scalar(255), cv::LINE_AA);
  Mark mark = FinishMark(shape, box, {rng.uniform(0.45, 0.95), 1.2, 0.25}, rng);
  mark.bgr = BlobColor(rng);
  return mark;
}

Mark MakeStreak(cv::RNG& rng, cv::Point center, double px_per_m) {
  const bool scratch = rng.uniform(0.0, 1.0) < 0.4;
  const double length_px = px_per_m * rng.uniform(0.05, 0.25);
  const double width_m = scratch ? rng.uniform(0.0005, 0.0015) : rng.uniform(0.006, 0.018);
  const int width_px = std::max(1, static_cast<int>(std::lround(width_m * px_per_m)));
  const std::vector<cv::Point> line = BentLine(rng, length_px, center);
  const int border = width_px + 14;
  const cv::Rect tight = cv::boundingRect(line);
  const cv::Rect box(tight.x - border, tight.y - border, tight.width + 2 * border, tight.height + 2 * border);
  std::vector<cv::Point> local;
  std::ranges::transform(line, std::back_inserter(local), [&box](cv::Point p) { return p - box.tl(); });
  cv::Mat shape = cv::Mat::zeros(box.size(), CV_8UC1);
  cv::polylines(shape, std::vector{local}, false, cv::Scalar(255), width_px, cv::LINE_AA);
  const Finish finish = scratch ? Finish{0.8, 0.8, 0.3} : Finish{rng.uniform(0.4, 0.65), 4.0, 0.8};
  Mark mark = FinishMark(shape, box, finish, rng);
  mark.bgr = scratch ? cv::Scalar(214, 216, 218) : cv::Scalar(52, 52, 54);
  return mark;
}

// Blends the mark over the floor and records the changed pixels.
void DrawMark(FloorTexture& floor, const Mark& mark, cv::Mat& changed) {
  const cv::Rect box = mark.box & cv::Rect({0, 0}, floor.bgr.size());
  const cv::Point shift = box.tl() - mark.box.tl();
  for (int v = 0; v < box.height; ++v) {
    const auto* opacity = mark.opacity.ptr<float>(v + shift.y) + shift.x;
    auto* pixels = floor.bgr.ptr<cv::Vec3b>(v + box.y) + box.x;
    for (int u = 0; u < box.width; ++u) {
      const double a = opacity[u];
      for (int c = 0; c < 3; ++c) {
        pixels[u][c] = cv::saturate_cast<std::uint8_t>((1.0 - a) * pixels[u][c] + a * mark.bgr[c]);
      }
      if (a > kVisibleOpacity && (v + box.y) % kTallyStep == 0 && (u + box.x) % kTallyStep == 0) {
        changed.at<std::uint8_t>((v + box.y) / kTallyStep, (u + box.x) / kTallyStep) = 1;
      }
    }
  }
}

}  // namespace

double WearFloor(FloorTexture& floor, double share, std::uint64_t seed) {
  if (!(share >= 0.0 && share <= kMaxShare)) {
    throw std::invalid_argument("the share of worn floor must be 0 to 0.9");
  }
  cv::RNG rng(DeriveSeed(seed, 0));
  const double px_per_m = 1.0 / floor.resolution_m;
  cv::Mat changed = cv::Mat::zeros((floor.bgr.rows + kTallyStep - 1) / kTallyStep,
                                   (floor.bgr.cols + kTallyStep - 1) / kTallyStep, CV_8UC1);
  const auto cells = static_cast<double>(changed.total());
  while (cv::countNonZero(changed) < share * cells) {
    const cv::Point center(rng.uniform(0, floor.bgr.cols), rng.uniform(0, floor.bgr.rows));
    const bool streak = rng.uniform(0.0, 1.0) < 0.4;
    DrawMark(floor, streak ? MakeStreak(rng, center, px_per_m) : MakeBlob(rng, center, px_per_m), changed);
  }
  return cv::countNonZero(changed) / cells;
}

}  // namespace floorloc
