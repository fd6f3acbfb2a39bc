// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace floorloc {

/// Several views' descriptors of one point become one: each bit by the majority of votes, a tie by the first view
/// (binary); the weighted mean (float).
class DescriptorVote {
 public:
  explicit DescriptorVote(const cv::Mat& like);  ///< a matrix of such descriptors

  void Add(const cv::Mat& descriptors, int row, int votes = 1);
  /// Writes the result to a row of a matrix of such descriptors, and starts again.
  void Finish(cv::Mat* descriptors, int row);

 private:
  void AddBits(const std::uint8_t* bytes, int votes);

  bool binary_;
  int added_ = 0;                    // votes
  std::vector<std::int32_t> ones_;   // per bit: votes for 1 minus votes for 0
  std::vector<std::uint8_t> first_;  // the first view's bytes
  std::vector<float> sum_;
};

}  // namespace floorloc
