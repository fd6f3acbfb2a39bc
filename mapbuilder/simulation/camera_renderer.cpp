// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/camera_renderer.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr int kMaxLevel = 4;
constexpr float kSurroundings = 38.0F;   // grey value outside the floor
constexpr int kLightStepPx = 4;          // light is computed at every 4th pixel
constexpr double kBlurPerCyclePx = 2.5;  // exposure is integrated in cycles of four samples

// Positions of a cycle's samples in the pixel: the centres of its four quarters, as weights of the pixel's corners (top
// left, top right, bottom left, bottom right).
constexpr std::array<std::array<double, 4>, 4> kQuarters = {{{0.5625, 0.1875, 0.1875, 0.0625},
                                                             {0.0625, 0.1875, 0.1875, 0.5625},
                                                             {0.1875, 0.5625, 0.0625, 0.1875},
                                                             {0.1875, 0.0625, 0.5625, 0.1875}}};

std::vector<cv::Mat> BuildPyramid(const cv::Mat& image) {
  std::vector<cv::Mat> levels = {image};
  while (static_cast<int>(levels.size()) <= kMaxLevel && std::min(levels.back().cols, levels.back().rows) >= 64) {
    const cv::Mat& fine = levels.back();
    // Drops an odd last row or column, so that texels are exact 2x2 means.
    const cv::Rect even(0, 0, fine.cols & ~1, fine.rows & ~1);
    cv::Mat coarse;
    cv::resize(fine(even), coarse, {even.width / 2, even.height / 2}, 0.0, 0.0, cv::INTER_AREA);
    levels.push_back(coarse);
  }
  return levels;
}

cv::Mat UndistortCorners(const CameraModel& camera) {
  cv::Mat corners(camera.height_px + 1, camera.width_px + 1, CV_64FC2);
  for (int v = 0; v < corners.rows; ++v) {
    auto* row = corners.ptr<cv::Vec2d>(v);
    for (int u = 0; u < corners.cols; ++u) {
      const Eigen::Vector2d p = camera.Undistort({u - 0.5, v - 0.5});
      row[u] = {p.x(), p.y()};
    }
  }
  return corners;
}

Eigen::Vector2d ToEigen(const cv::Vec2d& p) { return {p[0], p[1]}; }

// Chooses two samples across a pixel: with texels of half the pixel's footprint no detail is lost and nothing aliases.
cv::Mat ChooseLevels(const cv::Mat& corners, const Eigen::Matrix3d& base_from_pixel, double texel_m, int level_count) {
  cv::Mat levels(corners.rows - 1, corners.cols - 1, CV_8UC1);
  for (int v = 0; v < levels.rows; ++v) {
    for (int u = 0; u < levels.cols; ++u) {
      const auto floor_point = [&](int du, int dv) -> Eigen::Vector2d {
        return (base_from_pixel * ToEigen(corners.at<cv::Vec2d>(v + dv, u + du)).homogeneous()).hnormalized();
      };
      const Eigen::Vector2d right = floor_point(1, 0) - floor_point(0, 0);
      const Eigen::Vector2d down = floor_point(0, 1) - floor_point(0, 0);
      const double footprint_m = std::sqrt(std::abs(right.x() * down.y() - right.y() * down.x()));
      const double level = std::floor(std::log2(std::max(1.0, 0.5 * footprint_m / texel_m)) + 0.5);
      levels.at<std::uint8_t>(v, u) =
          static_cast<std::uint8_t>(std::isfinite(level) ? std::min<double>(level, level_count - 1) : 0.0);
    }
  }
  return levels;
}

struct Point {
  double x;
  double y;
};

// From base frame to texture pixel (level 0). Most of a simulation's time is spent in it, and in unoptimised builds a
// library's matrices would take it several times.
struct TextureFromBase {
  double xx, xy, x0;
  double yx, yy, y0;

  explicit TextureFromBase(const Eigen::Affine2d& t)
      : xx(t(0, 0)), xy(t(0, 1)), x0(t(0, 2)), yx(t(1, 0)), yy(t(1, 1)), y0(t(1, 2)) {}
};

// At the samples of the exposure: whole cycles of four, each of which samples the pixel's four quarters in turn.
std::vector<TextureFromBase> PlanSamples(const FloorTexture& floor, const Pose2& map_from_base,
                                         const Eigen::Vector3d& motion, double blur_px) {
  const int cycles = std::max(1, static_cast<int>(std::ceil(blur_px / kBlurPerCyclePx)));
  const int count = 4 * cycles;
  const double texel_per_m = 1.0 / floor.resolution_m;
  const Eigen::Affine2d texture_from_map =
      Eigen::Translation2d(floor.PixelFromMap({0.0, 0.0})) * Eigen::Scaling(texel_per_m, -texel_per_m);
  std::vector<TextureFromBase> samples;
  for (int k = 0; k < count; ++k) {
    const double time = (k + 0.5) / count - 0.5;
    const Pose2 pose = map_from_base * Pose2::Exp(time * motion);
    samples.emplace_back(texture_from_map * Eigen::Translation2d(pose.translation()) * Eigen::Rotation2Dd(pose.yaw()));
  }
  return samples;
}

// From undistorted pixel to base frame.
struct FloorHomography {
  double h[9];   // row by row
  double front;  // sign of the third coordinate of points before the camera
};

// Centres of a pixel's quarters on the floor, base frame; NaN where the camera does not see the floor.
// upper, lower: the undistorted corners (u, v) at the pixel's left, each followed by the one at its right.
void QuartersInBase(const double* upper, const double* lower, const FloorHomography& homography, Point* quarters) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const double* const h = homography.h;
  for (int i = 0; i < 4; ++i) {
    const double* const w = kQuarters[static_cast<std::size_t>(i)].data();
    const double u = w[0] * upper[0] + w[1] * upper[2] + w[2] * lower[0] + w[3] * lower[2];
    const double v = w[0] * upper[1] + w[1] * upper[3] + w[2] * lower[1] + w[3] * lower[3];
    const double z = h[6] * u + h[7] * v + h[8];
    quarters[i] = z * homography.front > 0.0 ? Point{(h[0] * u + h[1] * v + h[2]) / z, (h[3] * u + h[4] * v + h[5]) / z}
                                             : Point{kNaN, kNaN};
  }
}

// Adds the interpolated colour of the texture at a position in texels of the level; dark outside the floor.
void AddTexel(const cv::Mat& level, double u, double v, float* bgr) {
  const double u_floor = std::floor(u);
  const double v_floor = std::floor(v);
  if (!(u_floor >= 0.0 && v_floor >= 0.0 && u_floor < level.cols - 1 && v_floor < level.rows - 1)) {
    for (int c = 0; c < 3; ++c) {
      bgr[c] += kSurroundings;
    }
    return;
  }
  const auto a = static_cast<float>(u - u_floor);
  const auto b = static_cast<float>(v - v_floor);
  const std::uint8_t* top = level.ptr<std::uint8_t>(static_cast<int>(v_floor)) + 3 * static_cast<int>(u_floor);
  const std::uint8_t* bottom = top + level.step[0];
  for (int c = 0; c < 3; ++c) {
    const float upper = static_cast<float>(top[c]) * (1.0F - a) + static_cast<float>(top[c + 3]) * a;
    const float lower = static_cast<float>(bottom[c]) * (1.0F - a) + static_cast<float>(bottom[c + 3]) * a;
    bgr[c] += upper * (1.0F - b) + lower * b;
  }
}

// Each row has its own seed.
void AddNoise(cv::Mat& image, const RenderConditions& conditions) {
  if (conditions.read_noise <= 0.0 && conditions.shot_noise <= 0.0) {
    return;
  }
  const auto read_variance = static_cast<float>(conditions.read_noise * conditions.read_noise);
  const auto shot = static_cast<float>(conditions.shot_noise);
  cv::Mat noise(1, image.cols, CV_32FC3);
  for (int v = 0; v < image.rows; ++v) {
    cv::RNG rng(DeriveSeed(conditions.noise_seed, static_cast<std::uint64_t>(v)));
    rng.fill(noise, cv::RNG::NORMAL, 0.0, 1.0);
    auto* values = image.ptr<float>(v);
    const auto* normal = noise.ptr<float>(0);
    for (int i = 0; i < 3 * image.cols; ++i) {
      values[i] += normal[i] * std::sqrt(read_variance + shot * std::max(0.0F, values[i]));
    }
  }
}

}  // namespace

CameraRenderer::CameraRenderer(const FloorTexture& floor, const FloorCamera& camera)
    : floor_(floor), camera_(camera), pyramid_(BuildPyramid(floor.bgr)) {
  camera_.Check();
  corners_ = UndistortCorners(camera_.camera);
  levels_ =
      ChooseLevels(corners_, camera_.floor.base_from_pixel, floor_.resolution_m, static_cast<int>(pyramid_.size()));
}

cv::Mat CameraRenderer::Render(const Pose2& map_from_base, const RenderConditions& conditions) const {
  cv::Mat image = RenderFloor(map_from_base, conditions);
  if (conditions.overlay) {
    conditions.overlay->CoverScene(conditions.overlay_shift_px, &image);
  }
  const cv::Mat light = RenderLight(map_from_base, conditions);
  for (int v = 0; v < image.rows; ++v) {
    auto* pixels = image.ptr<cv::Vec3f>(v);
    const auto* light_row = light.ptr<float>(v);
    for (int u = 0; u < image.cols; ++u) {
      for (int c = 0; c < 3; ++c) {
        const auto channel_gain = static_cast<float>(conditions.white_balance[static_cast<std::size_t>(c)]);
        pixels[u][c] = pixels[u][c] * light_row[u] * channel_gain + static_cast<float>(conditions.bias);
      }
    }
  }
  if (conditions.defocus_px > 0.0) {
    cv::GaussianBlur(image, image, {}, conditions.defocus_px);
  }
  AddNoise(image, conditions);
  if (conditions.overlay) {
    conditions.overlay->BurnIn(conditions.time_s, &image);
  }
  cv::Mat raw;
  image.convertTo(raw, CV_8UC3);
  return raw;
}

cv::Mat CameraRenderer::RenderFloor(const Pose2& map_from_base, const RenderConditions& conditions) const {
  const Eigen::Matrix3d base_from_pixel = VibratedBaseFromPixel(camera_, conditions.vibration);
  const double view_distance_m = camera_.floor.roi.Center().norm();
  const double blur_m = conditions.motion.head<2>().norm() + std::abs(conditions.motion.z()) * view_distance_m;
  // Points in front of the camera have the same sign of the homography's third coordinate as the region of interest.
  const double front = base_from_pixel.inverse().row(2) * camera_.floor.roi.Center().homogeneous();
  FloorHomography homography{{}, front};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(homography.h) = base_from_pixel;
  cv::Mat image = cv::Mat::zeros(levels_.size(), CV_32FC3);
  for (int v = 0; v < image.rows; ++v) {
    const Pose2 row_pose = PoseAtRow(map_from_base, conditions, v, image.rows);
    const std::vector<TextureFromBase> samples =
        PlanSamples(floor_, row_pose, conditions.motion, blur_m / camera_.floor.resolution_m);
    const float scale = 1.0F / static_cast<float>(samples.size());
    const auto* upper = corners_.ptr<double>(v);
    const auto* lower = corners_.ptr<double>(v + 1);
    const auto* levels = levels_.ptr<std::uint8_t>(v);
    auto* bgr = image.ptr<float>(v);
    for (int u = 0; u < image.cols; ++u, upper += 2, lower += 2, bgr += 3) {
      Point quarters[4];
      QuartersInBase(upper, lower, homography, quarters);
      const cv::Mat& level = pyramid_[levels[u]];
      const double shrink = 1.0 / (1 << levels[u]);
      int quarter = 0;
      for (const TextureFromBase& sample : samples) {
        const Point& p = quarters[quarter];
        const double x = sample.xx * p.x + sample.xy * p.y + sample.x0;
        const double y = sample.yx * p.x + sample.yy * p.y + sample.y0;
        AddTexel(level, (x + 0.5) * shrink - 0.5, (y + 0.5) * shrink - 0.5, bgr);
        quarter = (quarter + 1) % 4;
      }
      for (int c = 0; c < 3; ++c) {
        bgr[c] *= scale;
      }
    }
  }
  return image;
}

cv::Mat CameraRenderer::RenderLight(const Pose2& map_from_base, const RenderConditions& conditions) const {
  const cv::Size size = levels_.size();
  cv::Mat coarse(size.height / kLightStepPx + 2, size.width / kLightStepPx + 2, CV_32FC1);
  const Eigen::Vector2d half(0.5 * size.width, 0.5 * size.height);
  for (int v = 0; v < coarse.rows; ++v) {
    for (int u = 0; u < coarse.cols; ++u) {
      const int column = std::min(u * kLightStepPx, size.width);
      const int row = std::min(v * kLightStepPx, size.height);
      const Eigen::Vector2d pixel = ToEigen(corners_.at<cv::Vec2d>(row, column));
      const Eigen::Vector2d relative = Eigen::Vector2d(column - half.x(), row - half.y()).cwiseQuotient(half);
      double light = 1.0;
      if (pixel.allFinite()) {
        const Eigen::Vector2d base = (camera_.floor.base_from_pixel * pixel.homogeneous()).hnormalized();
        light = LightAt(base, map_from_base, conditions);
      }
      light *= 1.0 + conditions.light_gradient.dot(relative);
      light *= 1.0 - conditions.vignetting * 0.5 * relative.squaredNorm();
      coarse.at<float>(v, u) = static_cast<float>(conditions.gain * light);
    }
  }
  cv::Mat light;
  const double step = 1.0 / kLightStepPx;
  const cv::Matx23d coarse_from_pixel(step, 0.0, 0.5 * step, 0.0, step, 0.5 * step);
  cv::warpAffine(coarse, light, coarse_from_pixel, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return light;
}

}  // namespace floorloc
