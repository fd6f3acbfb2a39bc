// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/place_rater.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/lattice/place_scorer.h"
#include "core/photometry/frame_at_place.h"

namespace floorloc {
namespace {

// A frame at a place of the lattice.
struct PlaceView {
  Eigen::Vector2i multiples = Eigen::Vector2i::Zero();
  Pose2 map_from_base;
  std::vector<float> mosaic;  // FrameAtPlace::Mosaic()
};

FramePlacement PlacementOf(const FrameSamples& frame, const PhotometricFit& fit, const Eigen::Vector2d& moved_m) {
  FramePlacement placement;
  placement.yaw_rad = fit.map_from_base.yaw();
  placement.middle_in_map = fit.map_from_base * frame.center() + moved_m;
  placement.mounting << fit.mounting.rotation_rad, fit.mounting.height_share;
  return placement;
}

double KnownShare(const std::vector<float>& mosaic) {
  const auto known = std::count_if(mosaic.begin(), mosaic.end(), [](float m) { return !std::isnan(m); });
  return static_cast<double>(known) / static_cast<double>(std::max<std::size_t>(1, mosaic.size()));
}

// The mosaic's mean over the places, sample by sample; not a number where few know it.
std::vector<float> MeanMosaic(std::span<const PlaceView> views, int min_places) {
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
FrameRest RestOf(const FrameSamples& frame, SampleSet set, const std::vector<float>& mean, int min_samples,
                 double max_sigma) {
  FrameRest rest{std::vector<float>(mean.size(), 0.0F), std::vector<float>(mean.size(), 0.0F)};
  const auto limit = static_cast<float>(max_sigma);
  std::size_t start = 0;
  for (int c = 0; c < frame.cells(); ++c) {
    const std::span<const FrameSamples::Sample> samples = frame.cell(c, set);
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

std::vector<Distortion> DistortionsOf(const FrameSamples& frame, SampleSet set, const FrameAtPlace& place) {
  const std::vector<Eigen::Vector2f> slopes = place.Slopes(set);
  const Eigen::Vector2f center = frame.center().cast<float>();
  const auto radius_m = static_cast<float>(frame.radius_m());
  std::vector<Distortion> distortions;
  distortions.reserve(slopes.size());
  std::size_t i = 0;
  for (int c = 0; c < frame.cells(); ++c) {
    for (const FrameSamples::Sample& s : frame.cell(c, set)) {
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
std::vector<float> TypicalDeviation(std::span<const PlaceView> views, const std::vector<float>& mean) {
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

// Makes scores standard deviations from the mean of those at wrong places, as the first `typical` ones are: what the
// mean mosaic has of noise is in the frame's rest and in that of every place, which lifts all scores. The best of all
// does not count: if it is the right one, its score is not by chance.
void Normalize(std::size_t typical, double temper, std::vector<LatticePlace>* places) {
  const auto best = std::max_element(places->begin(), places->end(),
                                     [](const LatticePlace& a, const LatticePlace& b) { return a.sigma < b.sigma; });
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (auto place = places->begin(); place != places->end() && count < static_cast<double>(typical); ++place) {
    if (place != best) {
      sum += place->sigma;
      squares += place->sigma * place->sigma;
      count += 1.0;
    }
  }
  const double mean = sum / count;
  // Student's t with count - 1 degrees of freedom has the variance (count - 1) / (count - 3).
  const double sigma = std::sqrt(std::max(0.0, squares - mean * sum) / (count - 3.0));
  for (LatticePlace& place : *places) {
    place.sigma = sigma > 0.0 ? (place.sigma - mean) / sigma : 0.0;
    place.expected_sigma = sigma > 0.0 ? place.expected_sigma / sigma : 0.0;
    const double above = std::max(0.0, place.sigma);
    place.log_likelihood = 0.5 * temper * above * above;
  }
}

}  // namespace

std::vector<LatticePlace> PlaceRater::Glance(const std::vector<Eigen::Vector2i>& multiples) const {
  return Score(multiples, multiples.size(), SampleSet::kSparse);
}

std::vector<LatticePlace> PlaceRater::Rate(const std::vector<Eigen::Vector2i>& multiples, std::size_t typical) const {
  return Score(multiples, typical, SampleSet::kAll);
}

std::vector<LatticePlace> PlaceRater::Score(const std::vector<Eigen::Vector2i>& multiples, std::size_t typical,
                                            SampleSet set) const {
  const LatticeComparisonOptions& options = parameters_.options;
  std::vector<PlaceView> views;
  std::vector<Distortion> distortions;
  for (const Eigen::Vector2i& m : multiples) {
    const FrameAtPlace place = At(m, set);
    std::vector<float> mosaic = place.Mosaic(set);
    if (KnownShare(mosaic) < options.min_known_share) {
      continue;
    }
    const Eigen::Vector2d moved = place.placement().middle_in_map - fit_.map_from_base * frame_.center();
    const Eigen::Vector2d t = fit_.map_from_base.translation() + moved;
    views.push_back({m, Pose2(t.x(), t.y(), fit_.map_from_base.yaw()), std::move(mosaic)});
    if (distortions.empty()) {
      distortions = DistortionsOf(frame_, set, place);
    }
  }
  if (static_cast<int>(views.size()) < options.min_places) {
    return {};
  }
  SampleScales scales;
  // The others were chosen by what the frame shows: their mean is like the frame, and would be taken from it.
  const std::span<const PlaceView> typical_views = std::span(views).first(std::min(typical, views.size()));
  scales.mean = MeanMosaic(typical_views, options.min_places);
  scales.rest =
      RestOf(frame_, set, scales.mean, FrameSamples::MinSamples(parameters_.min_cell_samples, set), options.max_sigma);
  scales.deviation = TypicalDeviation(typical_views, scales.mean);
  scales.distortions = std::move(distortions);
  const PlaceScorer scorer(std::move(scales), options.strong_deviations);
  std::vector<LatticePlace> places;
  for (const PlaceView& view : views) {
    const double share = places.size() < typical_views.size() ? 1.0 / static_cast<double>(typical_views.size()) : 0.0;
    const PlaceScore score = scorer.ScoreOf(view.mosaic, share);
    places.push_back({view.multiples, view.map_from_base, score.score, score.expected});
  }
  Normalize(typical, options.temper, &places);
  return places;
}

FrameAtPlace PlaceRater::At(const Eigen::Vector2i& multiples, SampleSet set) const {
  const FramePlacement placement = PlacementOf(frame_, fit_, parameters_.basis * multiples.cast<double>());
  if (set == SampleSet::kSparse) {
    return {raster_, frame_, placement, parameters_.options.glance_blur_level};
  }
  FrameAtPlace place(raster_, frame_, placement);
  place.Refine(raster_, parameters_.min_cell_samples);
  return place;
}

}  // namespace floorloc
