// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/floor_lattice.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/geometry/pose2.h"
#include "core/lattice/self_similarity.h"

namespace floorloc {
namespace {

using Translations = std::vector<Eigen::Vector2d>;

// Between keypoints with like descriptors and angles, metres.
Translations FindTranslations(const MapKeypoints& map, const DescriptorIndex& index, const FloorLatticeOptions& options,
                              std::uint32_t seed) {
  Translations translations;
  for (const SimilarKeypoints& one :
       FindSimilarKeypoints(map, index, {options.sample, options.copies, options.max_bit_share, seed})) {
    const Keypoint& from = map.keypoints[one.keypoint];
    for (const Neighbour& neighbour : one.similar) {
      const Keypoint& to = map.keypoints[static_cast<std::size_t>(neighbour.index)];
      const Eigen::Vector2d moved = to.Position() - from.Position();
      if (moved.norm() >= options.min_period_m && moved.norm() <= options.reach_m &&
          std::abs(WrapAngle(static_cast<double>(to.angle_rad) - static_cast<double>(from.angle_rad))) <=
              options.max_angle_rad) {
        translations.push_back(moved);
      }
    }
  }
  return translations;
}

// Counts of translations up to the longest period, those of either sign together: of the upper half plane.
class Histogram {
 public:
  Histogram(const Translations& translations, const FloorLatticeOptions& options)
      : options_(options),
        reach_(static_cast<int>(std::ceil(options.max_period_m / options.bin_m))),
        counts_(static_cast<std::size_t>(side()) * static_cast<std::size_t>(side()), 0) {
    for (const Eigen::Vector2d& t : translations) {
      Add(t);
      Add(-t);
    }
  }

  // Middles of the bins that hold more than their neighbours, together with them at least min_peak_share of the
  // largest; the shortest first.
  Translations Peaks() const {
    std::vector<std::pair<int, Eigen::Vector2d>> peaks;
    int largest = 0;
    for (int v = 0; v <= reach_ - 1; ++v) {
      for (int u = 1 - reach_; u <= reach_ - 1; ++u) {
        const double length = options_.bin_m * std::hypot(u, v);
        if (length >= options_.min_period_m && length <= options_.max_period_m && IsLargest(u, v)) {
          peaks.emplace_back(SumAround(u, v), options_.bin_m * Eigen::Vector2d(u, v));
          largest = std::max(largest, peaks.back().first);
        }
      }
    }
    Translations high;
    for (const auto& [count, middle] : peaks) {
      if (count >= options_.min_peak_share * largest) {
        high.push_back(middle);
      }
    }
    std::stable_sort(high.begin(), high.end(), [](const auto& a, const auto& b) { return a.norm() < b.norm(); });
    return high;
  }

 private:
  int side() const { return 2 * reach_ + 1; }
  std::size_t IndexOf(int u, int v) const {
    return static_cast<std::size_t>(v + reach_) * static_cast<std::size_t>(side()) +
           static_cast<std::size_t>(u + reach_);
  }
  void Add(const Eigen::Vector2d& t) {
    const auto u = static_cast<int>(std::lround(t.x() / options_.bin_m));
    const auto v = static_cast<int>(std::lround(t.y() / options_.bin_m));
    if (std::abs(u) <= reach_ && std::abs(v) <= reach_) {
      ++counts_[IndexOf(u, v)];
    }
  }
  int SumAround(int u, int v) const {
    int sum = 0;
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        sum += counts_[IndexOf(u + du, v + dv)];
      }
    }
    return sum;
  }
  bool IsLargest(int u, int v) const {
    const int count = counts_[IndexOf(u, v)];
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        if (counts_[IndexOf(u + du, v + dv)] > count) {
          return false;
        }
      }
    }
    return count > 0;
  }

  const FloorLatticeOptions& options_;
  int reach_;  // bins
  std::vector<int> counts_;
};

// The shortest peak, and the shortest one that is not along it.
std::optional<Eigen::Matrix2d> ChooseBasis(const Translations& peaks) {
  constexpr double kMinSine = 0.3;  // two shortest vectors of a lattice are at least 60 degrees apart
  for (const Eigen::Vector2d& second : peaks) {
    Eigen::Matrix2d basis;
    basis << peaks.front(), second;
    if (std::abs(basis.determinant()) >= kMinSine * peaks.front().norm() * second.norm()) {
      return basis;
    }
  }
  return std::nullopt;
}

// Fits the basis to the copies that lie on the lattice: first to the nearest ones, whose places a rough basis predicts.
FloorLattice Refine(const Translations& translations, const Eigen::Matrix2d& rough,
                    const FloorLatticeOptions& options) {
  constexpr int kRounds = 4;
  FloorLattice lattice{rough};
  for (int round = 0; round < kRounds; ++round) {
    const int farthest = 1 << round;
    const double tolerance_m = round == 0 ? 2.0 * options.bin_m : options.tolerance_m;
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Matrix2d product = Eigen::Matrix2d::Zero();
    double squares = 0.0;
    int explained = 0;
    for (const Eigen::Vector2d& t : translations) {
      const Eigen::Vector2i whole = lattice.Nearest(t);
      const Eigen::Vector2d place = lattice.basis * whole.cast<double>();
      if ((t - place).norm() <= tolerance_m && !whole.isZero()) {
        squares += (t - place).squaredNorm();
        ++explained;
        if (whole.cwiseAbs().maxCoeff() <= farthest) {
          normal += whole.cast<double>() * whole.cast<double>().transpose();
          product += t * whole.cast<double>().transpose();
        }
      }
    }
    if (std::abs(normal.determinant()) < 1.0) {
      return {rough};
    }
    lattice = {product * normal.inverse(), std::sqrt(squares / std::max(1, explained)),
               static_cast<double>(explained) / static_cast<double>(translations.size())};
  }
  return lattice;
}

}  // namespace

void FloorLatticeOptions::Check() const {
  RequireOption(sample >= 1 && sample <= 1000000, "sample must be 1 to 1000000");
  RequireOption(copies >= 1 && copies <= 1000, "copies must be 1 to 1000");
  RequireOption(max_bit_share >= 0 && max_bit_share < 1, "max_bit_share must be 0 to 1");
  RequireOption(max_angle_rad > 0, "max_angle_rad must be positive");
  RequireOption(min_period_m > 0 && max_period_m > min_period_m, "max_period_m must be above min_period_m, above 0");
  RequireOption(bin_m > 0 && max_period_m / bin_m <= 10000, "bin_m must be positive, at least max_period_m / 10000");
  RequireOption(reach_m >= max_period_m, "reach_m must be at least max_period_m");
  RequireOption(min_peak_share > 0 && min_peak_share <= 1, "min_peak_share must be above 0 and at most 1");
  RequireOption(tolerance_m > 0, "tolerance_m must be positive");
  RequireOption(min_share > 0 && min_share <= 1, "min_share must be above 0 and at most 1");
}

Eigen::Vector2i FloorLattice::Nearest(const Eigen::Vector2d& translation_m) const {
  const Eigen::Vector2d multiples = basis.inverse() * translation_m;
  return multiples.array().round().cast<int>();
}

std::optional<FloorLattice> FindFloorLattice(const MapKeypoints& map, const DescriptorIndex& index,
                                             const FloorLatticeOptions& options, std::uint32_t seed) {
  if (map.size() < 2 || map.descriptors.depth() != CV_8U) {
    return std::nullopt;
  }
  const Translations translations = FindTranslations(map, index, options, seed);
  const Translations peaks = Histogram(translations, options).Peaks();
  const std::optional<Eigen::Matrix2d> basis = peaks.empty() ? std::nullopt : ChooseBasis(peaks);
  if (!basis) {
    return std::nullopt;
  }
  const FloorLattice lattice = Refine(translations, *basis, options);
  return lattice.share >= options.min_share ? std::optional(lattice) : std::nullopt;
}

}  // namespace floorloc
