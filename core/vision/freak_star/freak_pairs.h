// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace floorloc {

/// Two receptive fields that a bit of the descriptor compares.
struct FreakPair {
  std::uint8_t brighter;  ///< the bit is set when this field is brighter ...
  std::uint8_t darker;    ///< ... than this one
};

constexpr int kFreakPairCount = 512;

/// Selected on the sample survey's images by tests/bench/features/train_freak_pairs.cpp, which documents how. Must not
/// change: maps hold descriptors made with these pairs.
extern const std::array<FreakPair, kFreakPairCount> kFreakPairs;

}  // namespace floorloc
