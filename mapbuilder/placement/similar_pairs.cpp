// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/similar_pairs.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <unordered_map>

#include "core/geometry/option_check.h"
#include "core/vision/matching/descriptor_index.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// Keypoints per frame used in the search, and nearest neighbours retrieved for each.
constexpr int kKeypoints = 250;
constexpr int kNeighbours = 8;

// Parts of at least this many frames get an index of their own.
constexpr std::size_t kLargePart = 50;

constexpr int kSharedIndex = -1;

// Features are evenly spread over the image and sorted, strongest first.
cv::Mat StrongestDescriptors(const BuildFrame& frame) {
  const cv::Mat& descriptors = frame.features.descriptors;
  return descriptors.empty() ? descriptors : descriptors.rowRange(0, std::min(descriptors.rows, kKeypoints));
}

// Descriptor index over the strongest keypoints of some frames.
class FrameIndex {
 public:
  FrameIndex(const std::vector<BuildFrame>& frames, const std::vector<int>& members) {
    for (const int frame : members) {
      const cv::Mat descriptors = StrongestDescriptors(frames[static_cast<std::size_t>(frame)]);
      if (descriptors.rows > 0) {
        all_.push_back(descriptors);
        owner_.insert(owner_.end(), static_cast<std::size_t>(descriptors.rows), frame);
      }
    }
    if (!all_.empty()) {
      index_ = CreateDescriptorIndex(all_, IndexOptions{});
    }
  }

  // Adds to each frame's votes the number of descriptors that have a near neighbour in it.
  void Vote(const cv::Mat& descriptors, std::unordered_map<int, int>* votes) const {
    if (!index_) {
      return;
    }
    for (const std::vector<Neighbour>& neighbours : index_->FindNeighbours(descriptors, kNeighbours)) {
      std::vector<int> counted;
      for (const Neighbour& n : neighbours) {
        const int frame = owner_[static_cast<std::size_t>(n.index)];
        if (std::find(counted.begin(), counted.end(), frame) == counted.end()) {
          counted.push_back(frame);
          ++(*votes)[frame];
        }
      }
    }
  }

 private:
  cv::Mat all_;
  std::vector<int> owner_;
  std::unique_ptr<DescriptorIndex> index_;
};

// One index per large part, and one shared by all small parts.
std::map<int, FrameIndex> BuildIndexes(const std::vector<BuildFrame>& frames, const std::vector<int>& part) {
  std::map<int, std::vector<int>> members;
  for (std::size_t i = 0; i < part.size(); ++i) {
    members[part[i]].push_back(static_cast<int>(i));
  }
  std::map<int, FrameIndex> indexes;
  std::vector<int> small;
  for (const auto& [number, list] : members) {
    if (list.size() >= kLargePart) {
      indexes.emplace(number, FrameIndex(frames, list));
    } else {
      small.insert(small.end(), list.begin(), list.end());
    }
  }
  indexes.emplace(kSharedIndex, FrameIndex(frames, small));
  return indexes;
}

// Appends the frames with most votes; ties are broken by frame number.
void KeepBest(const std::unordered_map<int, int>& votes, int count, std::vector<int>* best) {
  std::vector<std::pair<int, int>> ranked;  // votes, frame
  for (const auto& [frame, number] : votes) {
    ranked.emplace_back(number, frame);
  }
  std::sort(ranked.rbegin(), ranked.rend());
  ranked.resize(std::min(ranked.size(), static_cast<std::size_t>(count)));
  for (const auto& [number, frame] : ranked) {
    best->push_back(frame);
  }
}

}  // namespace

void SimilarPairsOptions::Check() const {
  RequireOption(pairs_per_frame >= 1, "pairs_per_frame must be at least 1");
  run.Check();
}

std::vector<FramePair> SelectSimilarPairs(const std::vector<BuildFrame>& frames, const std::vector<int>& part,
                                          const SimilarPairsOptions& options) {
  options.Check();
  const std::map<int, FrameIndex> indexes = BuildIndexes(frames, part);
  std::vector<std::vector<int>> similar(frames.size());
  ParallelFor(static_cast<int>(frames.size()), options.run.threads, [&](int self) {
    const auto i = static_cast<std::size_t>(self);
    const cv::Mat descriptors = StrongestDescriptors(frames[i]);
    for (const auto& [number, index] : indexes) {
      if (descriptors.rows == 0 || number == part[i]) {
        continue;
      }
      std::unordered_map<int, int> votes;
      index.Vote(descriptors, &votes);
      std::erase_if(votes, [&](const auto& vote) { return part[static_cast<std::size_t>(vote.first)] == part[i]; });
      KeepBest(votes, options.pairs_per_frame, &similar[i]);
    }
  });
  std::set<std::pair<int, int>> chosen;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const int other : similar[i]) {
      chosen.insert(std::minmax({static_cast<int>(i), other}));
    }
  }
  std::vector<FramePair> pairs;
  for (const auto& [first, second] : chosen) {
    pairs.push_back({first, second, std::nullopt, 0.0, 0.0});
  }
  return pairs;
}

}  // namespace floorloc
