// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/floor_check/strange_views.h"

#include <algorithm>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/io/input_error.h"

namespace floorloc {
namespace {

constexpr int kViews = 10;

cv::Mat Exposed(const cv::Mat& scene, double noise, cv::RNG* rng) {
  cv::Mat grain(scene.size(), CV_32FC1);
  rng->fill(grain, cv::RNG::NORMAL, 0.0, noise);
  cv::Mat image;
  cv::Mat(scene + grain).convertTo(image, CV_8UC1);
  return image;
}

cv::Mat Plain(cv::Size size, double level) { return {size, CV_32FC1, cv::Scalar(level)}; }

// Light that falls off from a place.
cv::Mat Lamp(cv::Size size, cv::RNG* rng) {
  cv::Mat light = Plain(size, 0.0);
  cv::circle(light, {rng->uniform(0, size.width), rng->uniform(0, size.height)}, size.height / 2, 900.0, cv::FILLED);
  cv::GaussianBlur(light, light, {}, size.height / 6.0);
  return light + Plain(size, 120.0);
}

// Boards with gaps and nails.
cv::Mat Pallet(cv::Size size, cv::RNG* rng) {
  cv::Mat scene = Plain(size, 25.0);
  const int board = rng->uniform(90, 150);
  for (int u = rng->uniform(-60, 0); u < size.width; u += board + rng->uniform(40, 80)) {
    cv::Mat part = scene(cv::Rect(u, 0, board, size.height) & cv::Rect({0, 0}, size));
    cv::Mat grain(size.height, 1, CV_32FC1);
    rng->fill(grain, cv::RNG::NORMAL, rng->uniform(110.0, 190.0), 14.0);
    cv::repeat(grain, 1, part.cols, part);
    for (int nail = 0; nail < 4; ++nail) {
      cv::circle(part, {rng->uniform(0, std::max(1, part.cols)), rng->uniform(0, size.height)}, 5, 50.0, cv::FILLED);
    }
  }
  cv::GaussianBlur(scene, scene, {}, 1.0);
  return scene;
}

// A dark shoe over a wall of another brightness.
cv::Mat Foot(cv::Size size, cv::RNG* rng) {
  cv::Mat scene = Plain(size, rng->uniform(60.0, 120.0));
  cv::ellipse(scene, {size.width / 2, size.height / 2}, {size.width * 2 / 5, size.height / 4}, rng->uniform(0.0, 180.0),
              0.0, 360.0, 35.0, cv::FILLED);
  for (int lace = 0; lace < 6; ++lace) {
    cv::line(scene, {rng->uniform(200, 440), rng->uniform(160, 320)}, {rng->uniform(200, 440), rng->uniform(160, 320)},
             200.0, 5);
  }
  cv::rectangle(scene, cv::Rect(0, 0, size.width / 4, size.height), 190.0, cv::FILLED);
  cv::GaussianBlur(scene, scene, {}, 1.5);
  return scene;
}

StrangeViews Repeat(const std::string& name, const std::function<cv::Mat(cv::RNG*)>& make) {
  StrangeViews views{name, {}};
  for (int i = 0; i < kViews; ++i) {
    cv::RNG rng(static_cast<std::uint64_t>(i) + 1);
    views.images.push_back(make(&rng));
  }
  return views;
}

}  // namespace

std::vector<StrangeViews> SimulatedStrangeViews(cv::Size raw_px) {
  return {
      Repeat("lens cap", [&](cv::RNG* rng) { return Exposed(Plain(raw_px, rng->uniform(0.0, 6.0)), 2.0, rng); }),
      Repeat("darkness", [&](cv::RNG* rng) { return Exposed(Plain(raw_px, rng->uniform(8.0, 30.0)), 6.0, rng); }),
      Repeat("glare", [&](cv::RNG* rng) { return Exposed(Lamp(raw_px, rng) * 2.2, 3.0, rng); }),
      Repeat("plain wall", [&](cv::RNG* rng) { return Exposed(Plain(raw_px, rng->uniform(90.0, 220.0)), 3.0, rng); }),
      Repeat("pallet", [&](cv::RNG* rng) { return Exposed(Pallet(raw_px, rng), 3.0, rng); }),
      Repeat("foot", [&](cv::RNG* rng) { return Exposed(Foot(raw_px, rng), 3.0, rng); }),
  };
}

StrangeViews ReadStrangeViews(const std::string& name, const std::filesystem::path& folder, cv::Size raw_px,
                              int count) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".jpg" || extension == ".png" || extension == ".jpeg") {
      files.push_back(entry.path());
    }
  }
  if (files.empty()) {
    throw InputError(folder, "has no images");
  }
  std::sort(files.begin(), files.end());
  StrangeViews views{name, {}};
  const std::size_t step = std::max<std::size_t>(1, files.size() / static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < files.size(); i += step) {
    cv::Mat image = cv::imread(files[i].string(), cv::IMREAD_GRAYSCALE);
    if ((image.rows > image.cols) != (raw_px.height > raw_px.width)) {
      cv::rotate(image, image, cv::ROTATE_90_CLOCKWISE);
    }
    cv::resize(image, image, raw_px, 0, 0, cv::INTER_AREA);
    views.images.push_back(image);
  }
  return views;
}

}  // namespace floorloc
