// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/fixed_structure.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/geometry/option_check.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/screening/contrast_images.h"
#include "mapbuilder/screening/floor_warp.h"

namespace floorloc {
namespace {

// Between letters and the like, pixels of the fine resolution.
constexpr int kGapPx = 5;

// Two images at the coarse resolution; fine: at the other.
struct ContrastPair {
  std::array<cv::Mat, 2> fine;
  cv::Mat first, second;
  cv::Mat first_map, second_map;  // of the first's pixels in the second, and of the second's in the first
};

// Sums over all images at the fine resolution. CV_32FC1.
struct Moments {
  explicit Moments(const cv::Size& size) : sum(cv::Mat::zeros(size, CV_32F)), squares(cv::Mat::zeros(size, CV_32F)) {}

  void Add(const cv::Mat& contrast) {
    sum += contrast;
    cv::accumulateSquare(contrast, squares);
    ++images;
  }
  cv::Mat MeanImage() const { return sum / images; }

  cv::Mat sum, squares;
  double images = 0.0;
};

// Votes of pairs, counted per pixel. CV_32SC1.
struct Votes {
  explicit Votes(const cv::Size& size)
      : pairs(cv::Mat::zeros(size, CV_32S)),
        standing(cv::Mat::zeros(size, CV_32S)),
        floor(cv::Mat::zeros(size, CV_32S)) {}

  cv::Mat pairs;     // that showed the pixel's floor in both images
  cv::Mat standing;  // in which it stood still
  cv::Mat floor;     // in which it moved as the floor
};

void Count(const cv::Mat& where, cv::Mat* votes) { cv::add(*votes, cv::Scalar(1), *votes, where); }

cv::Mat AtLeast(const cv::Mat& votes, const cv::Mat& pairs, double share) {
  cv::Mat count;
  cv::Mat all;
  votes.convertTo(count, CV_32F);
  pairs.convertTo(all, CV_32F);
  return count >= share * all;
}

class FixedStructureFinder {
 public:
  FixedStructureFinder(const FloorCamera& camera, const FixedStructureOptions& options, int threads)
      : options_(options),
        threads_(threads),
        shrink_(std::max(1, camera.camera.width_px / options.width_px)),
        raw_size_(camera.camera.width_px, camera.camera.height_px),
        fine_(std::max(1, raw_size_.width / shrink_), std::max(1, raw_size_.height / shrink_)),
        coarse_(HalfSize(fine_)),
        warp_(camera, coarse_) {}

  FixedStructure Find(const std::vector<MovedImages>& images);

 private:
  std::optional<ContrastPair> Prepare(const MovedImages& moved) const;
  bool ShowsMotion(const ContrastPair& pair) const;
  void CountStanding(const ContrastPair& pair, Votes* votes) const;
  void CountShowingThrough(const ContrastPair& pair, const cv::Mat& mean, Votes* votes) const;
  cv::Mat FloorCorrelation(const cv::Mat& image, const cv::Mat& other, const cv::Mat& map) const;
  cv::Mat Region(const Votes& votes, const Votes& through, const Moments& moments) const;
  cv::Mat KeepProven(const cv::Mat& candidates, const cv::Mat& seeds) const;

  const FixedStructureOptions& options_;
  int threads_;
  int shrink_;
  cv::Size raw_size_;
  cv::Size fine_;
  cv::Size coarse_;
  FloorWarp warp_;
};

cv::Mat FixedStructureFinder::FloorCorrelation(const cv::Mat& image, const cv::Mat& other, const cv::Mat& map) const {
  cv::Mat moved;
  cv::remap(other, moved, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar(0.0));
  return WindowCorrelation(image, moved, options_.window_px, options_.noise);
}

bool FixedStructureFinder::ShowsMotion(const ContrastPair& pair) const {
  const cv::Mat standing = WindowCorrelation(pair.first, pair.second, options_.window_px, options_.noise);
  const cv::Mat moving = FloorCorrelation(pair.first, pair.second, pair.first_map);
  const cv::Mat in_view = InView(pair.first_map, options_.window_px);
  const int floor = cv::countNonZero((moving > standing + options_.min_lead) & in_view);
  const int fixed = cv::countNonZero((standing > moving + options_.min_lead) & in_view);
  return floor > options_.min_moving_share * (floor + fixed) &&
         floor > options_.min_decided_share * cv::countNonZero(in_view);
}

void FixedStructureFinder::CountStanding(const ContrastPair& pair, Votes* votes) const {
  const cv::Mat standing = WindowCorrelation(pair.first, pair.second, options_.window_px, options_.noise);
  const auto count = [&](const cv::Mat& image, const cv::Mat& other, const cv::Mat& map) {
    const cv::Mat moving = FloorCorrelation(image, other, map);
    const cv::Mat in_view = InView(map, options_.window_px);
    Count(in_view, &votes->pairs);
    Count((standing > options_.min_standing) & (standing > moving + options_.min_lead) & in_view, &votes->standing);
    Count((moving > options_.min_standing) & in_view, &votes->floor);
  };
  count(pair.first, pair.second, pair.first_map);
  count(pair.second, pair.first, pair.second_map);
}

void FixedStructureFinder::CountShowingThrough(const ContrastPair& pair, const cv::Mat& mean, Votes* votes) const {
  const cv::Mat first = pair.first - mean;
  const cv::Mat second = pair.second - mean;
  const auto count = [&](const cv::Mat& image, const cv::Mat& other, const cv::Mat& map) {
    const cv::Mat in_view = InView(map, options_.window_px);
    Count(in_view, &votes->pairs);
    Count((FloorCorrelation(image, other, map) > options_.min_standing) & in_view, &votes->floor);
  };
  count(first, second, pair.first_map);
  count(second, first, pair.second_map);
}

double Median(const cv::Mat& values, const cv::Mat& where) {
  std::vector<float> chosen;
  for (int row = 0; row < values.rows; ++row) {
    for (int column = 0; column < values.cols; ++column) {
      if (where.at<std::uint8_t>(row, column) != 0) {
        chosen.push_back(values.at<float>(row, column));
      }
    }
  }
  if (chosen.empty()) {
    return 0.0;
  }
  const auto middle = chosen.begin() + static_cast<std::ptrdiff_t>(chosen.size() / 2);
  std::nth_element(chosen.begin(), middle, chosen.end());
  return static_cast<double>(*middle);
}

cv::Mat FixedStructureFinder::KeepProven(const cv::Mat& candidates, const cv::Mat& seeds) const {
  cv::Mat labels;
  const int count = cv::connectedComponents(candidates, labels, 8, CV_32S);
  std::vector<int> pixels(static_cast<std::size_t>(count), 0);
  std::vector<int> proven(static_cast<std::size_t>(count), 0);
  for (int row = 0; row < labels.rows; ++row) {
    for (int column = 0; column < labels.cols; ++column) {
      const auto label = static_cast<std::size_t>(labels.at<int>(row, column));
      ++pixels[label];
      proven[label] += seeds.at<std::uint8_t>(row, column) != 0 ? 1 : 0;
    }
  }
  cv::Mat kept = cv::Mat::zeros(candidates.size(), CV_8U);
  for (int row = 0; row < labels.rows; ++row) {
    for (int column = 0; column < labels.cols; ++column) {
      const auto label = static_cast<std::size_t>(labels.at<int>(row, column));
      if (label != 0 && pixels[label] >= options_.min_region_px &&
          proven[label] >= std::max(3.0, options_.min_seed_share * pixels[label])) {
        kept.at<std::uint8_t>(row, column) = 255;
      }
    }
  }
  return kept;
}

cv::Mat FixedStructureFinder::Region(const Votes& votes, const Votes& through, const Moments& moments) const {
  const cv::Mat known = votes.pairs >= 2 * options_.min_pairs;  // counted in both directions
  const cv::Mat seeds = AtLeast(votes.standing, votes.pairs, options_.min_vote_share) & known;
  cv::Mat shows = AtLeast(through.floor, through.pairs, options_.max_floor_share) & known;
  const cv::Mat floor = AtLeast(votes.floor, votes.pairs, options_.min_vote_share) & known;
  // A window at the edge of a part shows the floor beside it.
  const int half = options_.window_px / 2 | 1;
  const cv::Mat window = cv::Mat::ones(half, half, CV_8U);
  cv::erode(shows, shows, window, {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar::all(255));
  const cv::Mat mean = moments.MeanImage();
  const cv::Mat energy = mean.mul(mean);
  const cv::Mat variance = WindowMean(moments.squares / moments.images - mean.mul(mean), 3);
  const cv::Mat still = variance < cv::max(options_.max_variation * Median(variance, ToSize(floor, fine_)),
                                           options_.max_relative_variation * energy);
  cv::Mat candidates;
  cv::morphologyEx(still, candidates, cv::MORPH_CLOSE, cv::Mat::ones(kGapPx, kGapPx, CV_8U));
  candidates &= ToSize(~shows, fine_);
  return KeepProven(candidates, ToSize(seeds & ~shows, fine_));
}

// Empty when the pair does not show the floor moving.
std::optional<ContrastPair> FixedStructureFinder::Prepare(const MovedImages& moved) const {
  ContrastPair pair;
  pair.fine = {StructureContrast(moved.first, fine_, options_.light_px),
               StructureContrast(moved.second, fine_, options_.light_px)};
  pair.first = ToHalfSize(pair.fine[0]);
  pair.second = ToHalfSize(pair.fine[1]);
  pair.first_map = warp_.MapFor(moved.first_from_second.Inverse());
  pair.second_map = warp_.MapFor(moved.first_from_second);
  return ShowsMotion(pair) ? std::optional(std::move(pair)) : std::nullopt;
}

FixedStructure FixedStructureFinder::Find(const std::vector<MovedImages>& images) {
  std::vector<std::optional<ContrastPair>> prepared(images.size());
  ParallelFor(static_cast<int>(images.size()), threads_,
              [&](int i) { prepared[static_cast<std::size_t>(i)] = Prepare(images[static_cast<std::size_t>(i)]); });
  std::vector<ContrastPair> pairs;
  Moments moments(fine_);
  for (std::optional<ContrastPair>& pair : prepared) {
    if (pair) {
      moments.Add(pair->fine[0]);
      moments.Add(pair->fine[1]);
      pair->fine = {};
      pairs.push_back(*std::move(pair));
    }
  }
  FixedStructure found;
  found.pairs = static_cast<int>(pairs.size());
  found.decided = found.pairs >= options_.min_pairs;
  if (!found.decided) {
    return found;
  }
  Votes votes(coarse_);
  Votes through(coarse_);
  const cv::Mat mean = ToHalfSize(moments.MeanImage());
  for (const ContrastPair& pair : pairs) {
    CountStanding(pair, &votes);
    CountShowingThrough(pair, mean, &through);
  }
  const cv::Mat region = Region(votes, through, moments);
  if (cv::countNonZero(region) > 0) {
    cv::Mat fixed;
    cv::resize(region, fixed, raw_size_, 0, 0, cv::INTER_NEAREST);
    cv::dilate(fixed, fixed, cv::Mat::ones(2 * options_.margin_px + 1, 2 * options_.margin_px + 1, CV_8U));
    found.mask = ~fixed;
  }
  return found;
}

}  // namespace

void FixedStructureOptions::Check() const {
  RequireOption(width_px >= 16, "width_px must be at least 16");
  RequireOption(min_pairs >= 1, "min_pairs must be at least 1");
  RequireOption(window_px >= 3 && window_px % 2 == 1, "window_px must be odd and at least 3");
  RequireOption(light_px > window_px && light_px % 2 == 1, "light_px must be odd and larger than window_px");
  RequireOption(noise > 0.0, "noise must be positive");
  RequireOption(min_moving_share > 0.0 && min_moving_share < 1.0, "min_moving_share must be between 0 and 1");
  RequireOption(min_decided_share > 0.0 && min_decided_share < 1.0, "min_decided_share must be between 0 and 1");
  RequireOption(min_standing > 0.0 && min_standing < 1.0, "min_standing must be between 0 and 1");
  RequireOption(min_lead > 0.0 && min_lead < 1.0, "min_lead must be between 0 and 1");
  RequireOption(min_vote_share > 0.0 && min_vote_share < 1.0, "min_vote_share must be between 0 and 1");
  RequireOption(max_floor_share > 0.0 && max_floor_share < 1.0, "max_floor_share must be between 0 and 1");
  RequireOption(max_variation > 0.0 && max_variation < 1.0, "max_variation must be between 0 and 1");
  RequireOption(max_relative_variation > 0.0 && max_relative_variation < 1.0,
                "max_relative_variation must be between 0 and 1");
  RequireOption(min_seed_share > 0.0 && min_seed_share < 1.0, "min_seed_share must be between 0 and 1");
  RequireOption(margin_px >= 0, "margin_px must not be negative");
  RequireOption(min_region_px >= 1, "min_region_px must be at least 1");
}

FixedStructure FindFixedStructure(const FloorCamera& camera, const std::vector<MovedImages>& pairs,
                                  const FixedStructureOptions& options, int threads) {
  options.Check();
  return FixedStructureFinder(camera, options, threads).Find(pairs);
}

}  // namespace floorloc
