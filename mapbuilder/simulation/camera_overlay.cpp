// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/camera_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "core/geometry/option_check.h"
#include "mapbuilder/simulation/procedural_floor.h"
#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr std::array<const char*, 5> kNames{"part", "text", "logo", "dirt", "lamp"};
constexpr int kDirtSpots = 12;  // on the 5 % of the image that they cover
constexpr int kLampSpots = 4;
constexpr double kSpotsShare = 0.05;
constexpr double kTextLines = 20.0;  // that fill the image

// The share of the pixels with the smallest values (CV_32FC1): the edge of a shape of given area.
float Quantile(const cv::Mat& field, double share) {
  std::vector<float> values(field.begin<float>(), field.end<float>());
  const auto rank = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

template <typename Function>
cv::Mat Field(cv::Size size, const Function& value) {
  cv::Mat field(size, CV_32FC1);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      field.at<float>(v, u) = static_cast<float>(value(u, v));
    }
  }
  return field;
}

// Grows from a lower corner; its edge is bent a little.
cv::Mat CornerField(cv::Size size, std::uint64_t seed) {
  const cv::Mat bends = FractalNoise(size, {0.3 * size.width, 0.3 * size.height, 2}, seed);
  return Field(size, [&](int u, int v) {
    const double x = (u + 0.5) / size.width;
    const double y = 1.0 - (v + 0.5) / size.height;
    return std::pow(std::pow(x, 4.0) + std::pow(y, 4.0), 0.25) + 0.05 * static_cast<double>(bends.at<float>(v, u));
  });
}

// Distance to the nearest of some random spots, in radii of that spot.
cv::Mat SpotField(cv::Size size, int spots, std::uint64_t seed) {
  cv::RNG rng(seed);
  std::vector<cv::Vec3d> circles;
  for (int i = 0; i < spots; ++i) {
    circles.emplace_back(rng.uniform(0.03, 0.97) * size.width, rng.uniform(0.03, 0.97) * size.height,
                         rng.uniform(0.5, 1.5));
  }
  const cv::Mat bends = FractalNoise(size, {0.04 * size.width, 0.04 * size.width, 2}, DeriveSeed(seed, 1));
  return Field(size, [&](int u, int v) {
    double nearest = HUGE_VAL;
    for (const cv::Vec3d& c : circles) {
      nearest = std::min(nearest, std::hypot(u - c[0], v - c[1]) / c[2]);
    }
    return nearest * (1.0 + 0.2 * static_cast<double>(bends.at<float>(v, u)));
  });
}

// A sharp texture of its own in the bounds of the region.
cv::Mat PartLook(const cv::Mat& region, std::uint64_t seed) {
  constexpr double kResolutionM = 0.0007;
  const cv::Rect bounds = cv::boundingRect(region);
  cv::Mat gray;
  cv::cvtColor(PaintProceduralFloor("concrete", {bounds.size(), kResolutionM}, seed), gray, cv::COLOR_BGR2GRAY);
  gray.convertTo(gray, CV_32FC1);
  cv::Mat look(region.size(), CV_32FC1, cv::Scalar::all(0.0));
  cv::Mat(2.0 * (gray - cv::mean(gray)) + cv::Scalar::all(130.0)).copyTo(look(bounds));
  return look;
}

cv::Rect LogoBox(cv::Size size, double share) {
  const int width = std::max(1, static_cast<int>(std::lround(size.width * std::sqrt(share))));
  const int height = std::max(1, static_cast<int>(std::lround(size.height * std::sqrt(share))));
  return {size.width - width, 0, width, height};
}

cv::Mat LogoLook(cv::Size size, const cv::Rect& box) {
  cv::Mat look(size, CV_32FC1, cv::Scalar::all(0.0));
  cv::Mat plate = look(box);
  plate.setTo(225.0);
  const int unit = std::max(1, std::min(box.width, box.height) / 12);
  const cv::Point middle(box.width / 3, box.height / 2);
  cv::circle(plate, middle, 4 * unit, cv::Scalar::all(40.0), unit, cv::LINE_AA);
  cv::ellipse(plate, middle, {3 * unit, 2 * unit}, 35.0, 0.0, 250.0, cv::Scalar::all(90.0), cv::FILLED, cv::LINE_AA);
  cv::putText(plate, "AGV", {box.width / 2, box.height / 2}, cv::FONT_HERSHEY_DUPLEX, 0.11 * unit,
              cv::Scalar::all(20.0), std::max(1, unit / 4), cv::LINE_AA);
  for (int k = 0; k < 3; ++k) {
    cv::rectangle(plate, cv::Rect(box.width / 2, box.height / 2 + (2 * k + 1) * unit, box.width / 3 - k * unit, unit),
                  cv::Scalar::all(60.0 + 40.0 * k), cv::FILLED);
  }
  return look;
}

std::string TextLine(int line, double time_s) {
  constexpr std::array<const char*, 5> kCaptions{"HALL 2 NORTH AISLE 14", "EXP 1/250 GAIN 6.0dB WB 4800K",
                                                 "FW 4.11.2 SN 00417B", "640x480 25FPS MJPEG Q60",
                                                 "LINK OK BATT 87% TEMP 41C"};
  if (line > 0) {
    return kCaptions[static_cast<std::size_t>(line - 1) % kCaptions.size()];
  }
  const auto ms = std::llround(std::max(0.0, time_s) * 1e3);
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "CAM 03 2026-05-04 14:%02lld:%02lld.%03lld", ms / 60000 % 60, ms / 1000 % 60,
                ms % 1000);
  return text.data();
}

cv::Mat Shifted(const cv::Mat& image, const Eigen::Vector2d& shift_px) {
  if (shift_px.isZero()) {
    return image;
  }
  cv::Mat shifted;
  cv::warpAffine(image, shifted, cv::Matx23d(1.0, 0.0, shift_px.x(), 0.0, 1.0, shift_px.y()), image.size(),
                 cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return shifted;
}

cv::Mat LikeChannelsOf(const cv::Mat& image, const cv::Mat& gray) {
  cv::Mat same;
  cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(image.channels()), gray), same);
  return same;
}

int SpotCount(int at_usual_share, double share) {
  return std::max(1, static_cast<int>(std::lround(at_usual_share * share / kSpotsShare)));
}

}  // namespace

std::vector<std::string> OverlayKindNames() { return {kNames.begin(), kNames.end()}; }

const char* ToString(OverlayKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

OverlayKind ParseOverlayKind(const std::string& name) {
  const auto* found = std::find(kNames.begin(), kNames.end(), name);
  if (found == kNames.end()) {
    throw std::invalid_argument("no overlay named '" + name + "' (part, text, logo, dirt, lamp)");
  }
  return static_cast<OverlayKind>(found - kNames.begin());
}

void OverlayOptions::Check() const {
  RequireOption(share >= 0.0 && share <= 0.9, "overlay's share must be 0 to 0.9");
  RequireOption(sway_px >= 0.0 && sway_px <= 100.0, "overlay's sway must be 0 to 100 pixels");
}

CameraOverlay::CameraOverlay(const OverlayOptions& options, cv::Size size_px) : options_(options) {
  options_.Check();
  region_ = cv::Mat(size_px, CV_8UC1, cv::Scalar::all(0));
  if (options_.share <= 0.0) {
    return;
  }
  const bool spots = options_.kind == OverlayKind::kDirt || options_.kind == OverlayKind::kLamp;
  if (options_.kind == OverlayKind::kLogo) {
    const cv::Rect box = LogoBox(size_px, options_.share);
    region_(box).setTo(255);
    look_ = LogoLook(size_px, box);
  } else if (options_.kind == OverlayKind::kText) {
    region_.rowRange(0, static_cast<int>(std::lround(options_.share * size_px.height))).setTo(255);
    return;
  } else {
    const int count = SpotCount(options_.kind == OverlayKind::kDirt ? kDirtSpots : kLampSpots, options_.share);
    const cv::Mat field =
        spots ? SpotField(size_px, count, options_.seed) : CornerField(size_px, DeriveSeed(options_.seed, 1));
    const float edge = Quantile(field, options_.share);
    region_ = field < edge;
    if (options_.kind == OverlayKind::kLamp) {
      light_ = Field(size_px, [&](int u, int v) {
        const double r = std::min(1.0, static_cast<double>(field.at<float>(v, u) / edge));
        return 1.0 + 0.8 * (1.0 - r * r) * (0.7 + 0.3 * std::cos(4.0 * std::numbers::pi * r));
      });
      return;
    }
    look_ = spots ? cv::Mat(size_px, CV_32FC1, cv::Scalar::all(45.0)) : PartLook(region_, DeriveSeed(options_.seed, 2));
  }
  region_.convertTo(opacity_, CV_32FC1, (spots ? 0.85 : 1.0) / 255.0);
  cv::GaussianBlur(opacity_, opacity_, {}, spots ? 1.5 : 0.7);
}

void CameraOverlay::CoverScene(const Eigen::Vector2d& shift_px, cv::Mat* image) const {
  if (!light_.empty()) {
    *image = image->mul(LikeChannelsOf(*image, Shifted(light_, shift_px)));
  }
  if (!opacity_.empty()) {
    const cv::Mat opacity = LikeChannelsOf(*image, Shifted(opacity_, shift_px));
    const cv::Mat look = LikeChannelsOf(*image, Shifted(look_, shift_px));
    *image += opacity.mul(look - *image);
  }
}

void CameraOverlay::BurnIn(double time_s, cv::Mat* image) const {
  if (options_.kind != OverlayKind::kText || options_.share <= 0.0) {
    return;
  }
  const int height = cv::boundingRect(region_).height;
  const int lines = std::max(1, static_cast<int>(std::lround(options_.share * kTextLines)));
  cv::Mat(*image, cv::Rect(0, 0, image->cols, height)).setTo(cv::Scalar::all(12.0));
  const int line_px = height / lines;
  for (int line = 0; line < lines; ++line) {
    const std::string text = TextLine(line, time_s);
    int baseline = 0;
    const cv::Size unit = cv::getTextSize(text, cv::FONT_HERSHEY_DUPLEX, 1.0, 1, &baseline);
    const double scale = std::min(0.9 * line_px / (unit.height + baseline), 0.97 * image->cols / unit.width);
    cv::putText(*image, text, {image->cols / 100, static_cast<int>((line + 0.72) * line_px)}, cv::FONT_HERSHEY_DUPLEX,
                scale, cv::Scalar::all(235.0), 1, cv::LINE_AA);
  }
}

}  // namespace floorloc
