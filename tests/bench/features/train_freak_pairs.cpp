// SPDX-License-Identifier: Apache-2.0
// Chooses the pairs of receptive fields that FREAK compares and prints core/vision/freak_star/freak_pairs.cpp.
// Usage: train_freak_pairs IMAGE...   (the table in use: maps/sample/survey/images/*.jpg)
//
// As in the FREAK paper, all pairs of fields are candidates, sorted by the distance of their mean over the keypoints
// from 0.5 (highest variance first). A candidate is taken when its correlation with every pair already taken is below a
// limit; the limit is raised until there are enough pairs.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "core/vision/features/keypoint_selection.h"
#include "core/vision/freak_star/freak_pairs.h"
#include "core/vision/freak_star/freak_pattern.h"
#include "core/vision/freak_star/star.h"

namespace floorloc {
namespace {

constexpr double kReachPerSize = 22.0 / 7.0;

struct Candidate {
  FreakPair pair;
  int column;
  double mean;
};

std::vector<FreakPair> AllPairs() {
  std::vector<FreakPair> pairs;
  for (int a = 0; a < kFreakFields; ++a) {
    for (int b = a + 1; b < kFreakFields; ++b) {
      pairs.push_back({static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(b)});
    }
  }
  return pairs;
}

// Appends one row per keypoint with one column per pair, CV_32F, 0 or 1.
void AddRows(const cv::Mat& gray, const std::vector<FreakPair>& pairs, cv::Mat* bits) {
  const IntegralImage image(gray);
  BoxSampler sampler(image);
  std::vector<cv::KeyPoint> keypoints = Star({.threshold = 2.0, .max_keypoints = 800}).Detect(gray);
  const auto reach = [](const cv::KeyPoint& k) { return static_cast<float>(kReachPerSize) * k.size; };
  DropNearEdge(gray.size(), reach, &keypoints);
  for (const cv::KeyPoint& keypoint : keypoints) {
    FreakPatternPose place{keypoint.pt, reach(keypoint), 0.0F};
    place.angle_deg = FreakOrientation(SampleFreakFields(place, &sampler));
    const FreakFields fields = SampleFreakFields(place, &sampler);
    cv::Mat row(1, static_cast<int>(pairs.size()), CV_32F);
    for (int i = 0; i < row.cols; ++i) {
      const FreakPair& pair = pairs[static_cast<std::size_t>(i)];
      row.at<float>(i) = fields[pair.brighter] > fields[pair.darker] ? 1.0F : 0.0F;
    }
    bits->push_back(row);
  }
}

std::vector<Candidate> Rank(const std::vector<FreakPair>& pairs, const cv::Mat& means) {
  std::vector<Candidate> candidates;
  for (int i = 0; i < means.cols; ++i) {
    candidates.push_back({pairs[static_cast<std::size_t>(i)], i, means.at<double>(i)});
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::abs(a.mean - 0.5) < std::abs(b.mean - 0.5);
  });
  return candidates;
}

std::vector<Candidate> Choose(std::vector<Candidate> candidates, const cv::Mat& covariance) {
  const auto correlation = [&](int a, int b) {
    return std::abs(covariance.at<double>(a, b)) / std::sqrt(covariance.at<double>(a, a) * covariance.at<double>(b, b));
  };
  std::vector<Candidate> chosen;
  for (double limit = 0.2; chosen.size() < kFreakPairCount && limit <= 1.05; limit += 0.02) {
    std::erase_if(candidates, [&](const Candidate& candidate) {
      const bool take =
          chosen.size() < kFreakPairCount && std::all_of(chosen.begin(), chosen.end(), [&](const Candidate& other) {
            return correlation(candidate.column, other.column) < limit;
          });
      if (take) {
        chosen.push_back(candidate);
      }
      return take;
    });
  }
  return chosen;
}

void Print(const std::vector<Candidate>& chosen) {
  std::printf(
      "// SPDX-License-Identifier: Apache-2.0\n#include \"core/vision/freak_pairs.h\"\n\n"
      "namespace floorloc {\n\nconst std::array<FreakPair, kFreakPairCount> kFreakPairs{{\n");
  for (const Candidate& candidate : chosen) {
    std::printf("{%d, %d},\n", candidate.pair.brighter, candidate.pair.darker);
  }
  std::printf("}};\n\n}  // namespace floorloc\n");
}

void Run(int count, char** names) {
  const std::vector<FreakPair> pairs = AllPairs();
  cv::Mat bits;
  for (int i = 0; i < count; ++i) {
    AddRows(cv::imread(names[i], cv::IMREAD_GRAYSCALE), pairs, &bits);
  }
  std::fprintf(stderr, "%d keypoints\n", bits.rows);
  cv::Mat covariance;
  cv::Mat means;
  cv::calcCovarMatrix(bits, covariance, means, cv::COVAR_NORMAL | cv::COVAR_ROWS, CV_64F);
  Print(Choose(Rank(pairs, means), covariance));
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: train_freak_pairs IMAGE...\n");
    return 2;
  }
  floorloc::Run(argc - 1, argv + 1);
  return 0;
}
