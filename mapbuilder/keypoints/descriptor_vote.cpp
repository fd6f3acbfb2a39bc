// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/keypoints/descriptor_vote.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>

namespace floorloc {
namespace {

using ByteVotes = std::array<std::int32_t, 8>;

// Per byte: +1 for each set bit, -1 for each other one, so that eight bits are counted at once.
constexpr std::array<ByteVotes, 256> MakeVotes() {
  std::array<ByteVotes, 256> votes{};
  for (std::size_t byte = 0; byte < votes.size(); ++byte) {
    for (std::size_t bit = 0; bit < 8; ++bit) {
      votes[byte][bit] = (byte >> bit & 1U) != 0 ? 1 : -1;
    }
  }
  return votes;
}

constexpr std::array<ByteVotes, 256> kVotes = MakeVotes();

}  // namespace

DescriptorVote::DescriptorVote(const cv::Mat& like) : binary_(like.depth() == CV_8U) {
  const auto columns = static_cast<std::size_t>(like.cols);
  if (binary_) {
    ones_.assign(8 * columns, 0);
    first_.assign(columns, 0);
  } else {
    sum_.assign(columns, 0.0F);
  }
}

void DescriptorVote::AddBits(const std::uint8_t* bytes, int votes) {
  if (added_ == 0) {
    std::copy_n(bytes, first_.size(), first_.begin());
  }
  for (std::size_t i = 0; i < first_.size(); ++i) {
    std::int32_t* ones = ones_.data() + 8 * i;
    const ByteVotes& byte = kVotes[bytes[i]];
    for (std::size_t bit = 0; bit < 8; ++bit) {
      ones[bit] += votes * byte[bit];
    }
  }
}

void DescriptorVote::Add(const cv::Mat& descriptors, int row, int votes) {
  if (binary_) {
    AddBits(descriptors.ptr(row), votes);
  } else {
    const float* values = descriptors.ptr<float>(row);
    for (std::size_t i = 0; i < sum_.size(); ++i) {
      sum_[i] += static_cast<float>(votes) * values[i];
    }
  }
  added_ += votes;
}

void DescriptorVote::Finish(cv::Mat* descriptors, int row) {
  assert(added_ > 0);
  if (binary_) {
    std::uint8_t* bytes = descriptors->ptr(row);
    for (std::size_t i = 0; i < first_.size(); ++i) {
      unsigned byte = 0;
      for (unsigned bit = 0; bit < 8; ++bit) {
        const std::int32_t ones = ones_[8 * i + bit];
        const bool set = ones > 0 || (ones == 0 && (first_[i] >> bit & 1U) != 0);
        byte |= static_cast<unsigned>(set) << bit;
      }
      bytes[i] = static_cast<std::uint8_t>(byte);
    }
    std::fill(ones_.begin(), ones_.end(), 0);
  } else {
    std::transform(sum_.begin(), sum_.end(), descriptors->ptr<float>(row),
                   [this](float sum) { return sum / static_cast<float>(added_); });
    std::fill(sum_.begin(), sum_.end(), 0.0F);
  }
  added_ = 0;
}

}  // namespace floorloc
