// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/simulated_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/geometry/option_check.h"
#include "mapbuilder/simulation/procedural_floor.h"
#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr int kClasses = 5;
constexpr int kSurfaces = 4;
constexpr double kTexelM = 0.002;  // the pixels' footprints are 1.5 to 4 mm
constexpr int kTexels = 600;

struct Material {
  const char* name;
  IntensityStatistics intensity;
  double relief_m;  // standard deviation of the height
};

// The reliefs are guesses; their noise is far below the range sensor's.
constexpr std::array<Material, kClasses> kMaterials = {{{"carpet", {0.04, 0.1}, 0.004},  // measured: 0.0 (0.1)
                                                        {"concrete", {3.2, 1.7}, 0.001},
                                                        {"linoleum", {2.2, 2.1}, 0.0005},
                                                        {"rough_wood", {3.5, 2.0}, 0.002},
                                                        {"smooth_wood", {5.1, 1.7}, 0.0005}}};

// --- colour ---

cv::Mat PaintLinoleum(const PixelGrid& grid, std::uint64_t seed) {
  const double px_per_m = 1.0 / grid.resolution_m;
  const cv::Mat marble = FractalNoise(grid.size_px, {0.08 * px_per_m, 0.08 * px_per_m, 5}, DeriveSeed(seed, 1));
  cv::Mat floor;
  cv::merge(std::vector<cv::Mat>{marble * 14.0 + 128.0, marble * 12.0 + 142.0, marble * 10.0 + 150.0}, floor);
  floor.convertTo(floor, CV_8UC3);
  return floor;
}

// Weathered: greyer, with more contrast.
cv::Mat Roughen(const cv::Mat& wood, std::uint64_t seed) {
  cv::Mat gray;
  cv::cvtColor(wood, gray, cv::COLOR_BGR2GRAY);
  cv::cvtColor(gray, gray, cv::COLOR_GRAY2BGR);
  cv::Mat rough;
  cv::addWeighted(wood, 0.8, gray, 0.8, -80.0, rough);
  cv::Mat noise(rough.size(), CV_8UC3);
  cv::RNG(seed).fill(noise, cv::RNG::UNIFORM, 0, 24);
  return rough + noise;
}

cv::Mat Paint(int surface_class, std::uint64_t seed) {
  const PixelGrid grid{{kTexels, kTexels}, kTexelM};
  switch (surface_class) {
    case 0:
      return PaintProceduralFloor("carpet", grid, seed);
    case 1:
      return PaintProceduralFloor("concrete", grid, seed);
    case 2:
      return PaintLinoleum(grid, seed);
    case 3:
      return Roughen(PaintProceduralFloor("wood", grid, seed), DeriveSeed(seed, 9));
    default:
      return PaintProceduralFloor("wood", grid, seed);
  }
}

double Change(cv::RNG* random, double most) { return 1.0 + random->uniform(-most, most); }

// --- the floor under each pixel ---

struct View {
  cv::Mat x, y;   // CV_32FC1: metres on the floor
  cv::Mat depth;  // CV_32FC1: metres along the optical axis
};

View LookAtFloor(const SceneOptions& o) {
  View view{cv::Mat(o.size_px, CV_32FC1), cv::Mat(o.size_px, CV_32FC1), cv::Mat(o.size_px, CV_32FC1)};
  const double sine = std::sin(o.camera_pitch_rad);
  const double cosine = std::cos(o.camera_pitch_rad);
  for (int v = 0; v < o.size_px.height; ++v) {
    const double down = (v - 0.5 * (o.size_px.height - 1)) / o.focal_px;
    const double depth = o.camera_height_m / (sine + down * cosine);
    for (int u = 0; u < o.size_px.width; ++u) {
      view.x.at<float>(v, u) = static_cast<float>(depth * (u - 0.5 * (o.size_px.width - 1)) / o.focal_px);
      view.y.at<float>(v, u) = static_cast<float>(depth * (cosine - down * sine));
      view.depth.at<float>(v, u) = static_cast<float>(depth);
    }
  }
  return view;
}

// A straight border of surfaces that passes near the middle of the view.
struct Line {
  double nx, ny, offset;

  Line(const View& view, cv::RNG* random) {
    const double angle = random->uniform(0.0, 2.0 * std::numbers::pi);
    nx = std::cos(angle);
    ny = std::sin(angle);
    const cv::Size size = view.x.size();
    const cv::Point through(random->uniform(size.width / 4, size.width * 3 / 4),
                            random->uniform(size.height / 4, size.height * 3 / 4));
    offset = nx * view.x.at<float>(through) + ny * view.y.at<float>(through);
  }
  bool IsBeyond(double x, double y) const { return nx * x + ny * y > offset; }
};

cv::Mat SurfaceOfPixel(const View& view, cv::RNG* random) {
  const Line first(view, random);
  const Line second(view, random);
  cv::Mat surfaces(view.x.size(), CV_32SC1);
  for (int v = 0; v < surfaces.rows; ++v) {
    for (int u = 0; u < surfaces.cols; ++u) {
      const float x = view.x.at<float>(v, u);
      const float y = view.y.at<float>(v, u);
      surfaces.at<int>(v, u) = (first.IsBeyond(x, y) ? 2 : 0) + (second.IsBeyond(x, y) ? 1 : 0);
    }
  }
  return surfaces;
}

std::array<int, kSurfaces> DrawClasses(cv::RNG* random) {
  std::array<int, kClasses> order = {0, 1, 2, 3, 4};
  for (int i = kClasses - 1; i > 0; --i) {
    std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(random->uniform(0, i + 1))]);
  }
  return {order[0], order[1], order[2], order[3]};
}

// --- images ---

// The texture laid over the whole view, turned and shifted.
cv::Mat LayTexture(const cv::Mat& texture, const View& view, cv::RNG* random) {
  const double angle = random->uniform(0.0, 2.0 * std::numbers::pi);
  const double shift = random->uniform(0.0, static_cast<double>(kTexels));
  const double c = std::cos(angle) / kTexelM;
  const double s = std::sin(angle) / kTexelM;
  const cv::Mat u = c * view.x - s * view.y + shift;
  const cv::Mat v = s * view.x + c * view.y + shift;
  cv::Mat laid;
  cv::remap(texture, laid, u, v, cv::INTER_LINEAR, cv::BORDER_REFLECT);
  return laid;
}

cv::Mat RenderColor(const SceneOptions& o, const View& view, const cv::Mat& surfaces,
                    const std::array<int, kSurfaces>& classes, std::uint64_t seed) {
  cv::RNG random(DeriveSeed(seed, 1));
  cv::Mat color(o.size_px, CV_32FC3);
  for (int surface = 0; surface < kSurfaces; ++surface) {
    const int surface_class = classes[static_cast<std::size_t>(surface)];
    const std::uint64_t stream = 10U + static_cast<std::uint64_t>(surface);
    cv::Mat laid = LayTexture(Paint(surface_class, DeriveSeed(seed, stream)), view, &random);
    laid.convertTo(laid, CV_32FC3);
    const double brightness = Change(&random, o.color_change);
    cv::multiply(laid,
                 cv::Scalar(brightness * Change(&random, o.color_change), brightness,
                            brightness * Change(&random, o.color_change)),
                 laid);
    laid.copyTo(color, surfaces == surface);
  }
  const double light = Change(&random, o.light_change);
  cv::multiply(color,
               cv::Scalar(light * Change(&random, o.color_change), light, light * Change(&random, o.color_change)),
               color);
  const cv::Mat shade = FractalNoise(o.size_px, {400.0, 400.0, 1}, DeriveSeed(seed, 2)) * o.light_change + 1.0;
  cv::Mat shade3;
  cv::merge(std::vector<cv::Mat>(3, shade), shade3);
  cv::multiply(color, shade3, color);
  cv::Mat noise(o.size_px, CV_32FC3);
  constexpr double kSensorNoise = 2.0;  // grey levels
  random.fill(noise, cv::RNG::NORMAL, 0.0, kSensorNoise);
  cv::Mat image;
  cv::Mat(color + noise).convertTo(image, CV_8UC3);
  return image;
}

cv::Mat Holes(const SceneOptions& o, std::uint64_t seed) {
  cv::RNG random(DeriveSeed(seed, 3));
  const cv::Mat patches = FractalNoise(o.size_px, {40.0, 40.0, 2}, DeriveSeed(seed, 4));
  cv::Mat sorted;
  cv::sort(patches.reshape(1, 1), sorted, cv::SORT_EVERY_ROW + cv::SORT_ASCENDING);
  const float threshold = sorted.at<float>(static_cast<int>(o.hole_share / 3.0 * (sorted.cols - 1)));
  cv::Mat alone(o.size_px, CV_32FC1);
  random.fill(alone, cv::RNG::UNIFORM, 0.0, 1.0);
  return (patches < threshold) | (alone < o.hole_share * 2.0 / 3.0);
}

// Which surface every pixel shows (CV_32SC1), and the class of each.
struct FloorPlan {
  const cv::Mat& surfaces;
  const std::array<int, kSurfaces>& classes;
};

void RenderRange(const SceneOptions& o, const View& view, const FloorPlan& plan, std::uint64_t seed,
                 SurfaceImage* image) {
  cv::RNG random(DeriveSeed(seed, 5));
  std::array<double, kSurfaces> common = {};
  for (double& value : common) {
    value = random.gaussian(1.0);
  }
  constexpr double kNoiseSigma = 0.4;  // of FractalNoise
  const cv::Mat patches = FractalNoise(o.size_px, {40.0, 40.0, 1}, DeriveSeed(seed, 6)) / kNoiseSigma;
  const cv::Mat holes = Holes(o, seed);
  const double rest = 1.0 - o.surface_variance - o.patch_variance;
  image->depth_mm = cv::Mat::zeros(o.size_px, CV_16UC1);
  image->intensity = cv::Mat::zeros(o.size_px, CV_16UC1);
  for (int v = 0; v < o.size_px.height; ++v) {
    for (int u = 0; u < o.size_px.width; ++u) {
      const auto surface = static_cast<std::size_t>(plan.surfaces.at<int>(v, u));
      const Material& material = kMaterials[static_cast<std::size_t>(plan.classes[surface])];
      const double range = view.depth.at<float>(v, u) + random.gaussian(std::hypot(o.range_noise_m, material.relief_m));
      const double z = std::sqrt(o.surface_variance) * common[surface] +
                       std::sqrt(o.patch_variance) * patches.at<float>(v, u) + std::sqrt(rest) * random.gaussian(1.0);
      const double ratio = material.intensity.sigma / material.intensity.mean;
      const double log_variance = std::log(1.0 + ratio * ratio);
      const double intensity =
          std::exp(std::log(material.intensity.mean) - 0.5 * log_variance + std::sqrt(log_variance) * z);
      if (holes.at<std::uint8_t>(v, u) == 0) {
        image->depth_mm.at<std::uint16_t>(v, u) = cv::saturate_cast<std::uint16_t>(1000.0 * range);
        image->intensity.at<std::uint16_t>(v, u) = cv::saturate_cast<std::uint16_t>(kIntensityUnits * intensity);
      }
    }
  }
}

}  // namespace

void SceneOptions::Check() const {
  RequireOption(size_px.width >= 16 && size_px.height >= 16, "size_px must be 16 or more");
  RequireOption(focal_px > 0.0, "focal_px must be positive");
  RequireOption(camera_height_m > 0.0, "camera_height_m must be positive");
  const double half_view = std::atan(0.5 * size_px.height / focal_px);
  RequireOption(camera_pitch_rad > half_view && camera_pitch_rad <= std::numbers::pi / 2,
                "camera_pitch_rad must let the camera see floor only");
  RequireOption(range_noise_m >= 0.0, "range_noise_m must be 0 or more");
  RequireOption(hole_share >= 0.0 && hole_share < 1.0, "hole_share must be 0 to 1");
  RequireOption(surface_variance >= 0.0 && patch_variance >= 0.0 && surface_variance + patch_variance <= 1.0,
                "surface_variance and patch_variance must be 0 or more, together at most 1");
  RequireOption(light_change >= 0.0 && light_change < 1.0, "light_change must be 0 to 1");
  RequireOption(color_change >= 0.0 && color_change < 1.0, "color_change must be 0 to 1");
}

std::vector<std::string> SceneClasses() {
  std::vector<std::string> names;
  for (const Material& material : kMaterials) {
    names.emplace_back(material.name);
  }
  return names;
}

IntensityStatistics IntensityOf(int scene_class) {
  return kMaterials.at(static_cast<std::size_t>(scene_class)).intensity;
}

SurfaceScene SimulateScene(const SceneOptions& options, std::uint64_t seed) {
  options.Check();
  cv::RNG random(DeriveSeed(seed, 0));
  const View view = LookAtFloor(options);
  const cv::Mat surfaces = SurfaceOfPixel(view, &random);
  const std::array<int, kSurfaces> classes = DrawClasses(&random);
  SurfaceScene scene;
  scene.image.color = RenderColor(options, view, surfaces, classes, seed);
  RenderRange(options, view, {surfaces, classes}, seed, &scene.image);
  scene.class_of_pixel = cv::Mat(options.size_px, CV_32SC1);
  for (int surface = 0; surface < kSurfaces; ++surface) {
    scene.class_of_pixel.setTo(classes[static_cast<std::size_t>(surface)], surfaces == surface);
  }
  return scene;
}

}  // namespace floorloc
