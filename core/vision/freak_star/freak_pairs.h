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

/// Chosen by tests/bench/features/train_freak_pairs.cpp, which says how, on the sample survey's images. Maps hold
/// descriptors made with these pairs: they must not change.
extern const std::array<FreakPair, kFreakPairCount> kFreakPairs;

}  // namespace floorloc
