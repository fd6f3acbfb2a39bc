// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/simulated_noise.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// One octave: random values on a lattice, smoothly interpolated.
cv::Mat LatticeNoise(cv::Size size, double cell_x_px, double cell_y_px, std::uint64_t seed) {
  const cv::Size cells(static_cast<int>(std::ceil(size.width / cell_x_px)) + 3,
                       static_cast<int>(std::ceil(size.height / cell_y_px)) + 3);
  cv::Mat lattice(cells, CV_32FC1);
  cv::RNG rng(seed);
  rng.fill(lattice, cv::RNG::UNIFORM, -1.0F, 1.0F);
  cv::Mat field;
  // Pixel (u, v) samples lattice position (u / cell + 1, v / cell + 1), so that border cells are never used.
  const cv::Matx23d lattice_from_pixel(1.0 / cell_x_px, 0.0, 1.0, 0.0, 1.0 / cell_y_px, 1.0);
  cv::warpAffine(lattice, field, lattice_from_pixel, size, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT);
  return field;
}

}  // namespace

std::uint64_t DeriveSeed(std::uint64_t seed, std::uint64_t stream) {
  // SplitMix64 (Steele, Lea, Flood 2014): consecutive inputs give uncorrelated outputs.
  std::uint64_t z = seed + 0x9e3779b97f4a7c15ULL * (stream + 1);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

void NoiseOptions::Check() const {
  RequireOption(cell_x_px > 0.0, "cell_x_px must be positive");
  RequireOption(cell_y_px > 0.0, "cell_y_px must be positive");
  RequireOption(octaves >= 1 && octaves <= 16, "octaves must be 1 to 16");
}

cv::Mat FractalNoise(cv::Size size, const NoiseOptions& options, std::uint64_t seed) {
  options.Check();
  cv::Mat sum = cv::Mat::zeros(size, CV_32FC1);
  double weight = 1.0;
  for (int octave = 0; octave < options.octaves; ++octave, weight *= 0.5) {
    const double shrink = std::exp2(-octave);
    const double cell_x_px = options.cell_x_px * shrink;
    const double cell_y_px = options.cell_y_px * shrink;
    if (octave > 0 && std::min(cell_x_px, cell_y_px) < 2.0) {
      break;
    }
    const auto stream = static_cast<std::uint64_t>(octave);
    cv::scaleAdd(LatticeNoise(size, cell_x_px, cell_y_px, DeriveSeed(seed, stream)), weight, sum, sum);
  }
  return sum;
}

}  // namespace floorloc
