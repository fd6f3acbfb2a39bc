// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/gray_renderer.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace floorloc {
namespace {

constexpr double kSurroundings = 38.0;  // grey value outside the floor
constexpr int kLightStepPx = 8;         // light is computed at every 8th pixel
constexpr float kLumaNoise = 0.67F;     // noise of grey relative to that of each channel: the norm of kLuma

// Blue, green, red -> grey.
constexpr std::array<double, 3> kLuma = {0.114, 0.587, 0.299};

// Positions of an exposure's samples within the pixel, in turn.
constexpr std::array<std::array<double, 2>, 4> kOffsetsPx = {
    {{-0.25, -0.25}, {0.25, 0.25}, {0.25, -0.25}, {-0.25, 0.25}}};

// Texture pixel from base frame, homogeneous.
Eigen::Matrix3d TexelFromBase(const GrayFloor& floor, const Pose2& map_from_base) {
  Eigen::Matrix3d base = Eigen::Matrix3d::Identity();
  base.topLeftCorner<2, 2>() = map_from_base.rotation();
  base.topRightCorner<2, 1>() = map_from_base.translation();
  Eigen::Matrix3d texel_from_map;
  const double per_m = 1.0 / floor.resolution_m;
  texel_from_map << per_m, 0.0, -0.5, 0.0, -per_m, floor.gray.rows - 0.5, 0.0, 0.0, 1.0;
  return texel_from_map * base;
}

// Undistorted pixels -> texture pixels, of rows.
void Project(const cv::Mat& rays, const Eigen::Matrix3d& texel_from_pixel, cv::Mat texels) {
  const Eigen::Matrix3f h = texel_from_pixel.cast<float>();
  const auto* in = rays.ptr<float>();
  auto* out = texels.ptr<float>();
  const auto count = static_cast<int>(rays.total());
  for (int i = 0; i < count; ++i) {
    const float u = in[2 * i], v = in[2 * i + 1];
    const float w = 1.0F / (h(2, 0) * u + h(2, 1) * v + h(2, 2));
    out[2 * i] = (h(0, 0) * u + h(0, 1) * v + h(0, 2)) * w;
    out[2 * i + 1] = (h(1, 0) * u + h(1, 1) * v + h(1, 2)) * w;
  }
}

double BlurPx(const FloorCamera& camera, const Eigen::Vector3d& motion) {
  const double view_distance_m = camera.floor.roi.Center().norm();
  return (motion.head<2>().norm() + std::abs(motion.z()) * view_distance_m) / camera.floor.resolution_m;
}

void AddNoise(cv::Mat& image, const RenderConditions& conditions) {
  if (conditions.read_noise <= 0.0 && conditions.shot_noise <= 0.0) {
    return;
  }
  const auto read_variance = static_cast<float>(conditions.read_noise * conditions.read_noise);
  const auto shot = static_cast<float>(conditions.shot_noise);
  cv::Mat noise(image.size(), CV_32FC1);
  cv::RNG rng(conditions.noise_seed);
  rng.fill(noise, cv::RNG::NORMAL, 0.0, kLumaNoise);
  auto* values = image.ptr<float>();
  const auto* normal = noise.ptr<float>();
  const auto count = static_cast<int>(image.total());
  for (int i = 0; i < count; ++i) {
    values[i] += normal[i] * std::sqrt(read_variance + shot * std::max(0.0F, values[i]));
  }
}

cv::Mat ThroughJpeg(const cv::Mat& gray, int quality) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", gray, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
}

}  // namespace

GrayRenderer::GrayRenderer(const FloorCamera& camera) : camera_(camera) {
  camera_.Check();
  const CameraModel& lens = camera_.camera;
  rays_.create(lens.height_px, lens.width_px, CV_32FC2);
  for (int v = 0; v < rays_.rows; ++v) {
    for (int u = 0; u < rays_.cols; ++u) {
      const Eigen::Vector2d ray = lens.Undistort({u, v});
      rays_.at<cv::Vec2f>(v, u) = {static_cast<float>(ray.x()), static_cast<float>(ray.y())};
    }
  }
  light_points_.create(lens.height_px / kLightStepPx + 2, lens.width_px / kLightStepPx + 2, CV_64FC2);
  for (int v = 0; v < light_points_.rows; ++v) {
    for (int u = 0; u < light_points_.cols; ++u) {
      const cv::Vec2f ray =
          rays_.at<cv::Vec2f>(std::min(v * kLightStepPx, rays_.rows - 1), std::min(u * kLightStepPx, rays_.cols - 1));
      const Eigen::Vector2d point =
          (camera_.floor.base_from_pixel * Eigen::Vector3d(ray[0], ray[1], 1.0)).hnormalized();
      light_points_.at<cv::Vec2d>(v, u) = {point.x(), point.y()};
    }
  }
}

cv::Mat GrayRenderer::Render(const GrayFloor& floor, const Pose2& map_from_base, const RenderConditions& conditions,
                             int jpeg_quality) const {
  cv::Mat image = RenderFloor(floor, map_from_base, conditions);
  if (conditions.overlay) {
    conditions.overlay->CoverScene(conditions.overlay_shift_px, &image);
  }
  image = image.mul(RenderLight(map_from_base, conditions)) + conditions.bias;
  if (conditions.defocus_px > 0.0) {
    cv::GaussianBlur(image, image, {}, conditions.defocus_px);
  }
  AddNoise(image, conditions);
  if (conditions.overlay) {
    conditions.overlay->BurnIn(conditions.time_s, &image);
  }
  cv::Mat raw;
  image.convertTo(raw, CV_8UC1);
  return ThroughJpeg(raw, jpeg_quality);
}

cv::Mat GrayRenderer::RenderFloor(const GrayFloor& floor, const Pose2& map_from_base,
                                  const RenderConditions& conditions) const {
  const Eigen::Matrix3d base_from_pixel = VibratedBaseFromPixel(camera_, conditions.vibration);
  const int samples = 2 * std::max(1, static_cast<int>(std::ceil(0.5 * BlurPx(camera_, conditions.motion))));
  cv::Mat sum = cv::Mat::zeros(rays_.size(), CV_32FC1);
  cv::Mat texels(rays_.size(), CV_32FC2), sample;
  // With a global shutter all rows are one strip.
  const int strip = conditions.readout_motion.isZero() ? rays_.rows : 1;
  for (int k = 0; k < samples; ++k) {
    const double time = (k + 0.5) / samples - 0.5;
    const auto& offset = kOffsetsPx[static_cast<std::size_t>(k) % kOffsetsPx.size()];
    Eigen::Matrix3d shift = Eigen::Matrix3d::Identity();
    shift(0, 2) = offset[0];
    shift(1, 2) = offset[1];
    for (int v = 0; v < rays_.rows; v += strip) {
      const Pose2 pose = strip > 1 ? map_from_base : PoseAtRow(map_from_base, conditions, v, rays_.rows);
      Project(rays_.rowRange(v, v + strip),
              TexelFromBase(floor, pose * Pose2::Exp(time * conditions.motion)) * base_from_pixel * shift,
              texels.rowRange(v, v + strip));
    }
    cv::remap(floor.gray, sample, texels, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT,
              cv::Scalar::all(kSurroundings));
    cv::accumulate(sample, sum);
  }
  return sum / samples;
}

cv::Mat GrayRenderer::RenderLight(const Pose2& map_from_base, const RenderConditions& conditions) const {
  const Eigen::Vector2d half(0.5 * rays_.cols, 0.5 * rays_.rows);
  double gain = 0.0;
  for (std::size_t c = 0; c < kLuma.size(); ++c) {
    gain += conditions.gain * kLuma[c] * conditions.white_balance[c];
  }
  cv::Mat coarse(light_points_.size(), CV_32FC1);
  for (int v = 0; v < coarse.rows; ++v) {
    for (int u = 0; u < coarse.cols; ++u) {
      const auto& point = light_points_.at<cv::Vec2d>(v, u);
      const Eigen::Vector2d relative =
          Eigen::Vector2d(u * kLightStepPx - half.x(), v * kLightStepPx - half.y()).cwiseQuotient(half);
      const double light = LightAt({point[0], point[1]}, map_from_base, conditions) *
                           (1.0 + conditions.light_gradient.dot(relative)) *
                           (1.0 - conditions.vignetting * 0.5 * relative.squaredNorm());
      coarse.at<float>(v, u) = static_cast<float>(gain * light);
    }
  }
  cv::Mat light;
  const double step = 1.0 / kLightStepPx;
  cv::warpAffine(coarse, light, cv::Matx23d(step, 0.0, 0.0, 0.0, step, 0.0), rays_.size(),
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return light;
}

}  // namespace floorloc
