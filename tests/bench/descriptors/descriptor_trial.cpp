// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/descriptors/descriptor_trial.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "core/map/camera_correction.h"
#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/image/rectifier.h"
#include "core/vision/matching/hamming.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array<int, 6> kHeadingErrors{0, 3, 6, 8, 10, 15};
constexpr double kSamePlacePx = 1.5;
constexpr double kElsewhereM = 0.02;
constexpr int kSampleStep = 7;  // of the keypoints elsewhere

// A map as the trial needs it.
struct TrialMap {
  const FloorMap& map;
  PackedDescriptors steered;
  PackedDescriptors upright;
};

// A frame of the trial. place[i]: of keypoint i in the keypoints' frame of the map; match[i]: the map's keypoint there,
// or -1.
struct TrialFrame {
  Features features;
  UprightImage upright;
  double yaw_rad = 0.0;
  std::vector<Eigen::Vector2d> place;
  std::vector<int> match;
};

int NearestKeypoint(const MapKeypoints& map, const Eigen::Vector2d& place, double radius_m) {
  int nearest = -1;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double distance = (map.keypoints[i].Position() - place).norm();
    if (distance < radius_m) {
      radius_m = distance;
      nearest = static_cast<int>(i);
    }
  }
  return nearest;
}

int MostSimilarNear(const TrialMap& trial, const Eigen::Vector2d& place, const std::uint64_t* query) {
  int nearest = -1;
  int least = DescriptorScore::kBits / 4;
  for (int i = 0; i < trial.upright.rows(); ++i) {
    if ((trial.map.keypoints.keypoints[static_cast<std::size_t>(i)].Position() - place).norm() < kElsewhereM) {
      const int distance = HammingDistance(trial.upright, i, query);
      if (distance < least) {
        least = distance;
        nearest = i;
      }
    }
  }
  return nearest;
}

cv::Point2f ToPoint(const Eigen::Vector2d& p) { return {static_cast<float>(p.x()), static_cast<float>(p.y())}; }

// Affine map, 2 x 3, from the places by the true pose to those by the image; empty: too few matches.
std::optional<Eigen::Matrix<double, 2, 3>> FitVibration(const TrialMap& trial, const TrialFrame& frame) {
  constexpr int kMinInliers = 15;
  const cv::Mat descriptors = DescribeUpright(frame.upright, frame.features.keypoints, frame.yaw_rad);
  const PackedDescriptors query(descriptors);
  std::vector<cv::Point2f> from;
  std::vector<cv::Point2f> to;
  for (std::size_t i = 0; i < frame.place.size(); ++i) {
    const int similar = MostSimilarNear(trial, frame.place[i], query.row(static_cast<int>(i)));
    if (similar >= 0) {
      from.push_back(ToPoint(frame.place[i]));
      to.push_back(ToPoint(trial.map.keypoints.keypoints[static_cast<std::size_t>(similar)].Position()));
    }
  }
  cv::Mat inliers;
  const double radius_m = kSamePlacePx * trial.map.info.camera().floor.resolution_m;
  const cv::Mat fit = from.size() < 3 ? cv::Mat() : cv::estimateAffine2D(from, to, inliers, cv::RANSAC, radius_m);
  if (fit.empty() || cv::countNonZero(inliers) < kMinInliers) {
    return std::nullopt;
  }
  return Eigen::Map<const Eigen::Matrix<double, 2, 3, Eigen::RowMajor>>(fit.ptr<double>());
}

DescriptorScore Compare(const MapKeypoints& map, const PackedDescriptors& train, const TrialFrame& frame,
                        const PackedDescriptors& query, double radius_m) {
  DescriptorScore score;
  for (std::size_t i = 0; i < frame.place.size(); ++i) {
    if (frame.match[i] < 0) {
      continue;
    }
    const std::uint64_t* row = query.row(static_cast<int>(i));
    const auto is_at = [&](int k, double distance_m) {
      return (map.keypoints[static_cast<std::size_t>(k)].Position() - frame.place[i]).norm() < distance_m;
    };
    ++score.queries;
    score.right += is_at(FindTwoNearest(train, row).index, radius_m) ? 1 : 0;
    score.true_distance.push_back(HammingDistance(train, frame.match[i], row));
    for (int k = 0; k < train.rows(); k += kSampleStep) {
      if (!is_at(k, kElsewhereM)) {
        ++score.wrong_distance[static_cast<std::size_t>(HammingDistance(train, k, row))];
      }
    }
  }
  return score;
}

DescriptorTally TryFrame(const TrialMap& trial, TrialFrame frame) {
  DescriptorTally tally;
  const auto vibration = FitVibration(trial, frame);
  if (!vibration) {
    return tally;
  }
  const MapKeypoints& map = trial.map.keypoints;
  const double radius_m = kSamePlacePx * trial.map.info.camera().floor.resolution_m;
  for (std::size_t i = 0; i < frame.place.size(); ++i) {
    frame.place[i] = *vibration * frame.place[i].homogeneous();
    frame.match.push_back(NearestKeypoint(map, frame.place[i], radius_m));
    ++tally.keypoints;
    if (frame.match[i] >= 0) {
      const double angle = map.keypoints[static_cast<std::size_t>(frame.match[i])].angle_rad;
      const double off = WrapAngle(angle - frame.features.keypoints[i].angle_rad - frame.yaw_rad);
      ++tally.repeated;
      tally.angles_within_10 += std::abs(off) < 10.0 * kDegree ? 1 : 0;
    }
  }
  tally.steered = Compare(map, trial.steered, frame, PackedDescriptors(frame.features.descriptors), radius_m);
  for (const int error : kHeadingErrors) {
    const cv::Mat descriptors =
        DescribeUpright(frame.upright, frame.features.keypoints, frame.yaw_rad + error * kDegree);
    tally.upright[error] = Compare(map, trial.upright, frame, PackedDescriptors(descriptors), radius_m);
  }
  return tally;
}

}  // namespace

void DescriptorScore::Add(const DescriptorScore& other) {
  queries += other.queries;
  right += other.right;
  true_distance.insert(true_distance.end(), other.true_distance.begin(), other.true_distance.end());
  std::transform(wrong_distance.begin(), wrong_distance.end(), other.wrong_distance.begin(), wrong_distance.begin(),
                 std::plus<>());
}

double DescriptorScore::RankOneShare() const {
  return queries > 0 ? static_cast<double>(right) / static_cast<double>(queries) : 0.0;
}

double DescriptorScore::FalseShareAtRecall(double recall) const {
  if (true_distance.empty()) {
    return 1.0;
  }
  std::vector<int> sorted = true_distance;
  std::sort(sorted.begin(), sorted.end());
  const auto place = static_cast<std::size_t>(recall * static_cast<double>(sorted.size() - 1));
  const auto end = wrong_distance.begin() + sorted[place] + 1;
  const auto all = std::accumulate(wrong_distance.begin(), wrong_distance.end(), std::int64_t{0});
  return static_cast<double>(std::accumulate(wrong_distance.begin(), end, std::int64_t{0})) /
         static_cast<double>(std::max(all, std::int64_t{1}));
}

void DescriptorTally::Add(const DescriptorTally& other) {
  keypoints += other.keypoints;
  repeated += other.repeated;
  angles_within_10 += other.angles_within_10;
  steered.Add(other.steered);
  for (const auto& [error, score] : other.upright) {
    upright[error].Add(score);
  }
}

DescriptorTally TryDescriptors(const MapDatabase& database, const FrameGroup& group, const Pose2& map_from_truth) {
  const FloorMap map = database.ReadMap();
  const TrialMap trial{map, PackedDescriptors(map.keypoints.descriptors), PackedDescriptors(map.keypoints.upright)};
  const std::unique_ptr<FeatureExtractor> extractor = CreateFeatureExtractor(map.info.extractor);
  const Rectifier rectifier(
      CorrectedOrGiven(map.info, group.camera).AtResolution(map.info.camera().floor.resolution_m));
  const Pose2 origin_from_truth = map.keypoints.MapFromOrigin().Inverse() * map_from_truth;
  DescriptorTally tally;
  std::mutex adding;
  ParallelFor(static_cast<int>(group.frames.size()), 0, [&](int i) {
    const SceneFrame& scene = group.frames[static_cast<std::size_t>(i)];
    const Pose2 pose = origin_from_truth * scene.truth_from_base;
    const GroundImage image = rectifier.Rectify(scene.raw);
    TrialFrame frame;
    frame.features = extractor->Extract(image, extractor->Prepare(image), &frame.upright);
    frame.yaw_rad = pose.yaw();
    for (const Keypoint& k : frame.features.keypoints) {
      frame.place.emplace_back(pose * k.Position());
    }
    const DescriptorTally of_frame = TryFrame(trial, std::move(frame));
    const std::scoped_lock lock(adding);
    tally.Add(of_frame);
  });
  return tally;
}

}  // namespace floorloc
