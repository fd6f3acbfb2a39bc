// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/index/index_trial.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <opencv2/flann.hpp>
#include <set>

#include "tests/bench/common/score.h"

namespace floorloc {
namespace {

// OpenCV's locality-sensitive hashing, with the parameters that its documentation proposes for ORB.
class OpenCvLsh final : public DescriptorIndex {
 public:
  explicit OpenCvLsh(const cv::Mat& descriptors)
      : train_(descriptors), index_(train_, cv::flann::LshIndexParams(12, 20, 2), cvflann::FLANN_DIST_HAMMING) {}

  std::vector<std::vector<Neighbour>> Search(const cv::Mat& descriptors, const NeighbourSearch& search) const override {
    cv::Mat indices(descriptors.rows, search.count, CV_32S, cv::Scalar(-1));
    cv::Mat distances(descriptors.rows, search.count, CV_32S, cv::Scalar(0));
    index_.knnSearch(descriptors, indices, distances, search.count, cv::flann::SearchParams());
    std::vector<std::vector<Neighbour>> neighbours(static_cast<std::size_t>(descriptors.rows));
    for (int q = 0; q < descriptors.rows; ++q) {
      for (int k = 0; k < search.count; ++k) {
        const auto distance = static_cast<float>(distances.at<int>(q, k));
        if (const int i = indices.at<int>(q, k); i >= 0 && i < size() && distance <= search.max_distance) {
          neighbours[static_cast<std::size_t>(q)].push_back({i, distance});
        }
      }
    }
    return neighbours;
  }
  int size() const override { return train_.rows; }

 private:
  cv::Mat train_;
  mutable cv::flann::Index index_;
};

std::size_t HeapBytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

bool IsRight(const Pose2& pose, const Pose2& truth) {
  const Pose2 off = truth.Between(pose);
  return off.translation().norm() <= Tolerance().position_m && std::abs(off.yaw()) <= Tolerance().yaw_rad;
}

// (true matches that were found, all true matches)
std::pair<int, int> CountFound(const std::vector<int>& truth, const std::vector<Match>& matches) {
  std::set<std::pair<int, int>> found;
  for (const Match& m : matches) {
    found.emplace(m.query, m.train);
  }
  int all = 0;
  int right = 0;
  for (std::size_t q = 0; q < truth.size(); ++q) {
    all += truth[q] >= 0 ? 1 : 0;
    right += found.count({static_cast<int>(q), truth[q]}) > 0 ? 1 : 0;
  }
  return {right, all};
}

}  // namespace

std::vector<IndexMethod> ComparedIndexes(const RegistrationOptions& registration, double baseline_area_m2) {
  const auto create = [](MatcherType type) {
    return [type](const cv::Mat& descriptors) { return CreateDescriptorIndex(descriptors, {.type = type}); };
  };
  GlobalSearchOptions staged;
  staged.registration = registration;
  GlobalSearchOptions once = staged;
  once.efforts = {1};  // the other methods have only one effort
  return {{"floorloc", create(MatcherType::kHash), staged, 1e9, 40},
          {"brute force", create(MatcherType::kBruteForce), once, baseline_area_m2, 5},
          {"FLANN clusters", create(MatcherType::kFlann), once, baseline_area_m2, 20},
          {"FLANN LSH", [](const cv::Mat& d) { return std::make_unique<OpenCvLsh>(d); }, once,
           std::min(100.0, baseline_area_m2), 10}};
}

IndexTrial TryIndex(const IndexMethod& method, const BigFloor& floor, const FloorMap& real,
                    const std::vector<QueryFrame>& frames) {
  IndexTrial trial{.method = method.name, .area_m2 = floor.area_m2()};
  const std::size_t before = HeapBytes();
  const auto start = std::chrono::steady_clock::now();
  const auto index = method.create(floor.descriptors());
  trial.build_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const auto grown = static_cast<double>(HeapBytes()) - static_cast<double>(before);
  trial.bytes_per_keypoint = floor.bytes_per_keypoint() + grown / index->size();
  std::vector<double> times;
  std::vector<double> efforts;
  int found = 0;
  int all = 0;
  trial.frames = std::min(method.frames, static_cast<int>(frames.size()));
  for (int f = 0; f < trial.frames; ++f) {
    const std::size_t spread = static_cast<std::size_t>(f) * frames.size() / static_cast<std::size_t>(trial.frames);
    const QueryFrame& frame = frames[spread];
    const GlobalSearchResult result = SearchGlobally(*index, floor, frame.features, method.search);
    const auto [right, truths] = CountFound(TrueMatches(frame, real), result.matches);
    found += right;
    all += truths;
    times.push_back(result.ms);
    efforts.push_back(result.effort);
    if (result.floor_from_base) {
      const bool is_right = IsRight(*result.floor_from_base, floor.floor_from_map() * frame.map_from_base);
      (is_right ? trial.right : trial.wrong) += 1;
    }
  }
  trial.search_ms = Percentile(times, 0.5);
  trial.effort = Percentile(efforts, 0.5);
  trial.recall = static_cast<double>(found) / std::max(1, all);
  return trial;
}

}  // namespace floorloc
