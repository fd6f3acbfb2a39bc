// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/motion_sample.h"

#include <algorithm>
#include <cmath>

namespace floorloc {
namespace {

constexpr int kMinMotions = 5;

// Number of sampled motions in the driving direction, each of about this share of the view, and of sideways ones.
constexpr std::size_t kSampledForward = 200;
constexpr std::size_t kSampledSideways = 60;
constexpr double kSampledShare = 0.2;

// Where odometry's lengths choose no pairs that match: neighbours in time, and those some frames apart.
constexpr int kStrides[] = {1, 4};
constexpr std::size_t kSampledPerStride = 60;

// Lengths that differ by more are of another unit.
constexpr double kOtherUnit = 3.0;

// Minimum lateral share of a sideways motion.
constexpr double kSidewaysShare = 0.5;
constexpr double kMinSidewaysM = 0.02;

bool IsSideways(const Pose2& motion) {
  return std::abs(motion.y()) > std::max(kMinSidewaysM, kSidewaysShare * motion.translation().norm());
}

template <typename T>
std::vector<T> SpreadEvenly(const std::vector<T>& all, std::size_t count) {
  std::vector<T> sample;
  const std::size_t stride = all.size() / count + 1;
  for (std::size_t i = 0; i < all.size(); i += stride) {
    sample.push_back(all[i]);
  }
  return sample;
}

// Pairs of frames in sequence between which odometry moved by a share of the view.
std::vector<FramePair> ForwardPairs(const std::vector<BuildFrame>& frames, int survey, const RectM& floor) {
  const double step_m = kSampledShare * std::min(floor.width_m(), floor.height_m());
  std::vector<FramePair> pairs;
  int first = -1;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].survey != survey || !frames[i].odom_from_base) {
      continue;
    }
    if (first < 0) {
      first = static_cast<int>(i);
      continue;
    }
    const Pose2 motion = frames[static_cast<std::size_t>(first)].odom_from_base->Between(*frames[i].odom_from_base);
    if (motion.translation().norm() >= step_m) {
      pairs.push_back({first, static_cast<int>(i), std::nullopt, 0.0, 0.0});
      first = static_cast<int>(i);
    }
  }
  return SpreadEvenly(pairs, kSampledForward);
}

Pose2 OfView(const Pose2& motion, const RectM& floor) {
  const Pose2 base_from_view(floor.Center().x(), floor.Center().y(), 0.0);
  return base_from_view.Inverse() * motion * base_from_view;
}

// Pairs that are side by side according to odometry, as on neighbouring lanes; nearest in time first, since they
// drifted least.
std::vector<FramePair> SidewaysPairs(const std::vector<BuildFrame>& frames, int survey, const RectM& floor) {
  std::vector<std::optional<Pose2>> odom_from_base(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].survey == survey) {
      odom_from_base[i] = frames[i].odom_from_base;
    }
  }
  std::vector<FramePair> pairs =
      SelectNearbyPairs(odom_from_base, std::vector<RectM>(frames.size(), floor), NearbyOptions{});
  std::erase_if(pairs, [&](const FramePair& pair) { return !IsSideways(OfView(*pair.first_from_second, floor)); });
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const FramePair& a, const FramePair& b) { return a.second - a.first < b.second - b.first; });
  pairs.resize(std::min(pairs.size(), kSampledSideways));
  for (FramePair& pair : pairs) {
    pair.first_from_second.reset();
  }
  return pairs;
}

Pose2 OdometryBetween(const std::vector<BuildFrame>& frames, int first, int second) {
  return frames[static_cast<std::size_t>(first)].odom_from_base->Between(
      *frames[static_cast<std::size_t>(second)].odom_from_base);
}

std::vector<FramePair> TimedPairs(const std::vector<BuildFrame>& frames, int survey) {
  std::vector<int> known;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].survey == survey && frames[i].odom_from_base) {
      known.push_back(static_cast<int>(i));
    }
  }
  std::vector<FramePair> pairs;
  for (const int stride : kStrides) {
    std::vector<FramePair> apart;
    for (std::size_t i = 0; i + static_cast<std::size_t>(stride) < known.size(); ++i) {
      apart.push_back({known[i], known[i + static_cast<std::size_t>(stride)], std::nullopt, 0.0, 0.0});
    }
    const std::vector<FramePair> sample = SpreadEvenly(apart, kSampledPerStride);
    pairs.insert(pairs.end(), sample.begin(), sample.end());
  }
  return pairs;
}

// Way that odometry travelled up to each frame of a survey.
std::vector<double> Mileage(const std::vector<BuildFrame>& frames, int survey) {
  std::vector<double> mileage_m(frames.size(), 0.0);
  const BuildFrame* last = nullptr;
  double sum_m = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].survey == survey && frames[i].odom_from_base) {
      sum_m += last == nullptr ? 0.0 : last->odom_from_base->Between(*frames[i].odom_from_base).translation().norm();
      last = &frames[i];
    }
    mileage_m[i] = sum_m;
  }
  return mileage_m;
}

// Length by vision over length by odometry, of the median pair.
double LengthRatio(const std::vector<BuildFrame>& frames, const std::vector<Link>& links) {
  std::vector<double> ratios;
  for (const Link& link : links) {
    const double said_m = OdometryBetween(frames, link.first, link.second).translation().norm();
    if (said_m > 0.0) {
      ratios.push_back(link.first_from_second.translation().norm() / said_m);
    }
  }
  if (ratios.empty()) {
    return 1.0;
  }
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

MeasuredMotions CompareLinks(const std::vector<BuildFrame>& frames, const std::vector<Link>& links,
                             const RectM& floor) {
  MeasuredMotions measured;
  if (links.empty()) {
    return measured;
  }
  const double ratio = LengthRatio(frames, links);
  measured.unit = std::abs(std::log(ratio)) > std::log(kOtherUnit) ? ratio : 1.0;
  const std::vector<double> mileage_m = Mileage(frames, frames[static_cast<std::size_t>(links.front().first)].survey);
  for (const Link& link : links) {
    const Pose2 said = OdometryBetween(frames, link.first, link.second);
    const double way_m =
        mileage_m[static_cast<std::size_t>(link.second)] - mileage_m[static_cast<std::size_t>(link.first)];
    measured.motions.push_back({OfView(Pose2(measured.unit * said.x(), measured.unit * said.y(), said.yaw()), floor),
                                OfView(link.first_from_second, floor),
                                frames[static_cast<std::size_t>(link.first)].odom_from_base->yaw(),
                                measured.unit * std::abs(way_m)});
  }
  return measured;
}

}  // namespace

MeasuredMotions MeasureMotions(const std::vector<BuildFrame>& frames, int survey, const RectM& floor,
                               PairRegistrationOptions registration) {
  registration.run.progress = {};
  const std::vector<RectM> floors(frames.size(), floor);
  std::vector<Link> links = RegisterPairs(frames, floors, ForwardPairs(frames, survey, floor), registration);
  if (static_cast<int>(links.size()) < kMinMotions) {
    return CompareLinks(frames, RegisterPairs(frames, floors, TimedPairs(frames, survey), registration), floor);
  }
  const std::vector<Link> sideways = RegisterPairs(frames, floors, SidewaysPairs(frames, survey, floor), registration);
  links.insert(links.end(), sideways.begin(), sideways.end());
  return CompareLinks(frames, links, floor);
}

}  // namespace floorloc
