// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace floorloc {

/// Combines the descriptors of several views of one point: bitwise majority, ties decided by the first view (binary);
/// weighted mean (float).
class DescriptorVote {
 public:
  explicit DescriptorVote(const cv::Mat& like);  ///< any matrix of the same descriptor type and length

  void Add(const cv::Mat& descriptors, int row, int votes = 1);
  /// Writes the result to a row of such a matrix and resets the vote.
  void Finish(cv::Mat* descriptors, int row);

 private:
  void AddBits(const std::uint8_t* bytes, int votes);

  bool binary_;
  int added_ = 0;                    // votes
  std::vector<std::int32_t> ones_;   // per bit: votes for 1 minus votes for 0
  std::vector<std::uint8_t> first_;  // descriptor of the first view
  std::vector<float> sum_;
};

}  // namespace floorloc
