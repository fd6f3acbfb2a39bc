// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/lattice_comparison.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/geometry/option_check.h"
#include "core/lattice/place_rater.h"

namespace floorloc {
namespace {

bool IsLikelier(const LatticePlace& a, const LatticePlace& b) { return a.sigma > b.sigma; }

}  // namespace

void LatticeComparisonOptions::Check() const {
  RequireOption(max_places >= min_places && max_places <= 100000, "max_places must be min_places to 100000");
  RequireOption(near_places >= min_places && near_places <= max_places, "near_places must be min_places to max_places");
  RequireOption(max_poses >= 1, "max_poses must be positive");
  RequireOption(typical_places >= min_places, "typical_places must be at least min_places");
  RequireOption(promising_places >= 1, "promising_places must be positive");
  RequireOption(glance_blur_level >= 0 && glance_blur_level <= MosaicRaster::kMaxBlurLevel,
                "glance_blur_level must be 0 to 3");
  RequireOption(min_known_share > 0 && min_known_share <= 1, "min_known_share must be above 0 and at most 1");
  RequireOption(min_places >= 5, "min_places must be at least 5");
  RequireOption(temper > 0 && temper <= 1, "temper must be above 0 and at most 1");
  RequireOption(max_sigma > 0, "max_sigma must be positive");
  RequireOption(strong_deviations > 0, "strong_deviations must be positive");
}

const LatticePlace* LatticeComparison::Find(const Pose2& map_from_base) const {
  constexpr double kToleranceRad = 0.1;  // places have the same heading
  const auto found = std::find_if(places.begin(), places.end(), [&](const LatticePlace& place) {
    const Pose2 apart = place.map_from_base.Inverse() * map_from_base;
    return apart.translation().norm() <= tolerance_m && std::abs(apart.yaw()) <= kToleranceRad;
  });
  return found == places.end() ? nullptr : &*found;
}

// The nearest max_places whose views lie on the map; zero is the first of them.
std::vector<Eigen::Vector2i> LatticeComparer::PlacesAround(const Eigen::Vector2d& middle_in_map, int max_places) const {
  // On a quarter of a circle, as in a corner of the map.
  const double reach = std::min(std::hypot(extent_.width_m(), extent_.height_m()),
                                std::sqrt(4.0 * max_places * CellArea() / std::numbers::pi));
  const Eigen::Matrix2d inverse = lattice_.basis.inverse();
  const int across = static_cast<int>(std::ceil(reach * inverse.row(0).norm()));
  const int along = static_cast<int>(std::ceil(reach * inverse.row(1).norm()));
  std::vector<Eigen::Vector2i> places;
  for (int i = -across; i <= across; ++i) {
    for (int k = -along; k <= along; ++k) {
      const Eigen::Vector2i multiples(i, k);
      if (extent_.Contains(middle_in_map + lattice_.basis * multiples.cast<double>()) || multiples.isZero()) {
        places.push_back(multiples);
      }
    }
  }
  std::stable_sort(places.begin(), places.end(), [&](const Eigen::Vector2i& a, const Eigen::Vector2i& b) {
    return (lattice_.basis * a.cast<double>()).squaredNorm() < (lattice_.basis * b.cast<double>()).squaredNorm();
  });
  places.resize(std::min(places.size(), static_cast<std::size_t>(max_places)));
  return places;
}

double LatticeComparer::CellArea() const { return std::abs(lattice_.basis.determinant()); }

std::optional<LatticeComparison> LatticeComparer::Compare(const FrameSamples& frame, const PhotometricFit& fit,
                                                          int max_places) const {
  const PlaceRater rater(raster_, frame, fit, {lattice_.basis, options_, min_cell_samples_});
  const auto typical = static_cast<std::size_t>(options_.typical_places);
  const auto refined = typical + static_cast<std::size_t>(options_.promising_places);
  std::vector<Eigen::Vector2i> chosen = PlacesAround(fit.map_from_base * frame.center(), max_places);
  std::vector<LatticePlace> others;
  if (chosen.size() > refined) {
    others = rater.Glance(chosen);
    const auto promising = others.begin() + static_cast<std::ptrdiff_t>(std::min(typical, others.size()));
    std::stable_sort(promising, others.end(), IsLikelier);
    const auto end = others.begin() + static_cast<std::ptrdiff_t>(std::min(refined, others.size()));
    chosen.clear();
    std::transform(others.begin(), end, std::back_inserter(chosen), [](const LatticePlace& p) { return p.multiples; });
    others.erase(others.begin(), end);
  }
  LatticeComparison comparison;
  comparison.places = rater.Rate(chosen, others.empty() ? chosen.size() : typical);
  if (static_cast<int>(comparison.places.size()) < options_.min_places ||
      !comparison.places.front().multiples.isZero()) {
    return std::nullopt;
  }
  comparison.places.insert(comparison.places.end(), others.begin(), others.end());
  std::stable_sort(comparison.places.begin(), comparison.places.end(), IsLikelier);
  const double on_map = extent_.width_m() * extent_.height_m() / CellArea();
  comparison.not_compared = std::max(0.0, on_map - static_cast<double>(comparison.places.size()));
  comparison.tolerance_m = 0.25 * std::min(lattice_.basis.col(0).norm(), lattice_.basis.col(1).norm());
  return comparison;
}

}  // namespace floorloc
