// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/lattice_comparison.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/lattice/place_scorer.h"
#include "core/photometry/cell_comparison.h"
#include "core/photometry/frame_at_place.h"

namespace floorloc {
namespace {

// A frame at a place of the lattice.
struct PlaceView {
  Eigen::Vector2i multiples = Eigen::Vector2i::Zero();
  Pose2 map_from_base;
  std::vector<float> mosaic;  // FrameAtPlace::Mosaic()
  double known_share = 0.0;   // of its samples
};

FramePlacement PlacementOf(const FrameSamples& frame, const PhotometricFit& fit, const Eigen::Vector2d& moved_m) {
  FramePlacement placement;
  placement.yaw_rad = fit.map_from_base.yaw();
  placement.middle_in_map = fit.map_from_base * frame.center() + moved_m;
  placement.mounting << fit.mounting.rotation_rad, fit.mounting.height_share;
  return placement;
}

PlaceView ViewOf(const FrameAtPlace& place, const FrameSamples& frame, const PhotometricFit& fit) {
  const Eigen::Vector2d moved = place.placement().middle_in_map - fit.map_from_base * frame.center();
  const Eigen::Vector2d t = fit.map_from_base.translation() + moved;
  PlaceView view;
  view.map_from_base = Pose2(t.x(), t.y(), fit.map_from_base.yaw());
  view.mosaic = place.Mosaic();
  const auto known = std::count_if(view.mosaic.begin(), view.mosaic.end(), [](float m) { return !std::isnan(m); });
  view.known_share = static_cast<double>(known) / static_cast<double>(std::max<std::size_t>(1, view.mosaic.size()));
  return view;
}

// The mosaic's mean over the places, sample by sample; not a number where few know it.
std::vector<float> MeanMosaic(const std::vector<PlaceView>& views, int min_places) {
  std::vector<float> sums(views.front().mosaic.size(), 0.0F);
  std::vector<int> counts(sums.size(), 0);
  for (const PlaceView& view : views) {
    for (std::size_t i = 0; i < sums.size(); ++i) {
      if (!std::isnan(view.mosaic[i])) {
        sums[i] += view.mosaic[i];
        ++counts[i];
      }
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] =
        counts[i] >= min_places ? sums[i] / static_cast<float>(counts[i]) : std::numeric_limits<float>::quiet_NaN();
  }
  return sums;
}

// A sample of a cell that does not agree with the floor (another object, a reflection) says little.
FrameRest RestOf(const FrameSamples& frame, const std::vector<float>& mean, int min_samples, double max_sigma) {
  FrameRest rest{std::vector<float>(mean.size(), 0.0F), std::vector<float>(mean.size(), 0.0F)};
  const auto limit = static_cast<float>(max_sigma);
  std::size_t start = 0;
  for (int c = 0; c < frame.cells(); ++c) {
    const std::span<const FrameSamples::Sample> samples = frame.cell(c);
    CellCorrelation sums;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      if (!std::isnan(mean[start + i])) {
        sums.Add(samples[i].value, mean[start + i]);
      }
    }
    const float variance = sums.VarianceOfMosaic();
    const float gain = sums.Covariance() / variance;
    if (sums.n >= static_cast<float>(min_samples) && variance > 0.0F && gain > 0.0F) {
      const float unexplained = (sums.VarianceOfFrame() - gain * gain * variance) / sums.n;
      const float sigma = std::sqrt(std::max(unexplained, 1.0F));
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const float m = mean[start + i];
        if (!std::isnan(m)) {
          const float expected = sums.f / sums.n + gain * (m - sums.m / sums.n);
          rest.gain[start + i] = gain / sigma;
          rest.value[start + i] = std::clamp((samples[i].value - expected) / sigma, -limit, limit);
        }
      }
    }
    start += samples.size();
  }
  return rest;
}

std::vector<Distortion> DistortionsOf(const FrameSamples& frame, const FrameAtPlace& place) {
  const std::vector<Eigen::Vector2f> slopes = place.Slopes();
  const Eigen::Vector2f center = frame.center().cast<float>();
  const auto radius_m = static_cast<float>(frame.radius_m());
  std::vector<Distortion> distortions;
  distortions.reserve(slopes.size());
  std::size_t i = 0;
  for (int c = 0; c < frame.cells(); ++c) {
    for (const FrameSamples::Sample& s : frame.cell(c)) {
      const Eigen::Vector2f& g = slopes[i++];
      const float dx = (s.x_m - center.x()) / radius_m;
      const float dy = (s.y_m - center.y()) / radius_m;
      const float outwards = g.x() * dx + g.y() * dy;
      distortions.push_back(
          (Distortion() << g.x(), g.y(), g.x() * dx, g.x() * dy, g.y() * dx, g.y() * dy, outwards * dx, outwards * dy)
              .finished());
    }
  }
  return distortions;
}

// How far places typically differ from the mean one, sample by sample: mean absolute deviation, as a standard
// deviation.
std::vector<float> TypicalDeviation(const std::vector<PlaceView>& views, const std::vector<float>& mean) {
  constexpr float kSigmaOfMean = 1.2533F;  // of a normal distribution: sqrt(pi / 2)
  std::vector<float> sums(mean.size(), 0.0F);
  std::vector<float> counts(mean.size(), 0.0F);
  for (const PlaceView& view : views) {
    for (std::size_t i = 0; i < mean.size(); ++i) {
      const float apart = std::abs(view.mosaic[i] - mean[i]);
      sums[i] += std::isnan(apart) ? 0.0F : apart;
      counts[i] += std::isnan(apart) ? 0.0F : 1.0F;
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] *= kSigmaOfMean / std::max(1.0F, counts[i]);
  }
  return sums;
}

}  // namespace

void LatticeComparisonOptions::Check() const {
  RequireOption(max_places >= min_places && max_places <= 100000, "max_places must be min_places to 100000");
  RequireOption(near_places >= min_places && near_places <= max_places, "near_places must be min_places to max_places");
  RequireOption(max_poses >= 1, "max_poses must be positive");
  RequireOption(min_known_share > 0 && min_known_share <= 1, "min_known_share must be above 0 and at most 1");
  RequireOption(min_places >= 4, "min_places must be at least 4");
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
  std::vector<PlaceView> views;
  std::vector<Distortion> distortions;
  for (const Eigen::Vector2i& multiples : PlacesAround(fit.map_from_base * frame.center(), max_places)) {
    const FrameAtPlace place(raster_, frame, PlacementOf(frame, fit, lattice_.basis * multiples.cast<double>()),
                             min_cell_samples_);
    PlaceView view = ViewOf(place, frame, fit);
    if (view.known_share >= options_.min_known_share) {
      view.multiples = multiples;
      views.push_back(std::move(view));
      if (multiples.isZero()) {
        distortions = DistortionsOf(frame, place);
      }
    }
  }
  if (static_cast<int>(views.size()) < options_.min_places || !views.front().multiples.isZero()) {
    return std::nullopt;
  }
  SampleScales scales;
  scales.mean = MeanMosaic(views, options_.min_places);
  scales.rest = RestOf(frame, scales.mean, FrameSamples::kSparseShare * min_cell_samples_, options_.max_sigma);
  scales.deviation = TypicalDeviation(views, scales.mean);
  scales.distortions = std::move(distortions);
  const PlaceScorer scorer(std::move(scales), options_.strong_deviations);
  LatticeComparison comparison;
  const double on_map = extent_.width_m() * extent_.height_m() / CellArea();
  comparison.not_compared = std::max(0.0, on_map - static_cast<double>(views.size()));
  comparison.tolerance_m = 0.25 * std::min(lattice_.basis.col(0).norm(), lattice_.basis.col(1).norm());
  for (const PlaceView& view : views) {
    const PlaceScore score = scorer.ScoreOf(view.mosaic);
    comparison.places.push_back({view.multiples, view.map_from_base, score.score, score.expected});
  }
  std::vector<LatticePlace>& places = comparison.places;
  std::stable_sort(places.begin(), places.end(),
                   [](const LatticePlace& a, const LatticePlace& b) { return a.sigma > b.sigma; });
  // The best place does not count: if it is the right one, its score is not by chance.
  double squares = 0.0;
  for (std::size_t k = 1; k < places.size(); ++k) {
    squares += places[k].sigma * places[k].sigma;
  }
  const double sigma = std::sqrt(squares / static_cast<double>(places.size() - 1));
  for (LatticePlace& place : places) {
    place.sigma = sigma > 0.0 ? place.sigma / sigma : 0.0;
    place.expected_sigma = sigma > 0.0 ? place.expected_sigma / sigma : 0.0;
    const double above = std::max(0.0, place.sigma);
    place.log_likelihood = 0.5 * options_.temper * above * above;
  }
  return comparison;
}

}  // namespace floorloc
