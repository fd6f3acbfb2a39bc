// SPDX-License-Identifier: Apache-2.0
#include "core/vision/matching/hamming_kernels.h"

#include <cstddef>

#if defined(__x86_64__)
#include <immintrin.h>
#define FLOORLOC_TARGET(isa) __attribute__((target(isa)))
#endif

namespace floorloc {
namespace {

constexpr int kWords256 = 4;

// Successive rows.
struct EachRow {
  int operator[](std::size_t i) const { return static_cast<int>(i); }
};

// Inlined into functions for several instruction sets, each with its own popcount.
template <int kWords>
[[gnu::always_inline]] inline int Distance(const std::uint64_t* a, const std::uint64_t* b, int words) {
  int distance = 0;
  for (int w = 0; w < (kWords > 0 ? kWords : words); ++w) {
    distance += __builtin_popcountll(a[w] ^ b[w]);
  }
  return distance;
}

template <int kWords, typename Indices>
[[gnu::always_inline]] inline void Fill(const HammingTask& task, const Indices& indices, std::size_t count,
                                        int* distances) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t* row = task.rows + static_cast<std::ptrdiff_t>(indices[i]) * task.words_per_row;
    distances[i] = Distance<kWords>(row, task.query, task.words_per_row);
  }
}

template <typename Indices>
[[gnu::always_inline]] inline void FillAny(const HammingTask& task, const Indices& indices, std::size_t count,
                                           int* distances) {
  if (task.words_per_row == kWords256) {
    Fill<kWords256>(task, indices, count, distances);
  } else {
    Fill<0>(task, indices, count, distances);
  }
}

void SuccessivePortable(const HammingTask& task, int count, int* distances) {
  FillAny(task, EachRow(), static_cast<std::size_t>(count), distances);
}
void ChosenPortable(const HammingTask& task, std::span<const int> indices, int* distances) {
  FillAny(task, indices.data(), indices.size(), distances);
}

#if defined(__x86_64__)

FLOORLOC_TARGET("popcnt") void SuccessivePopcnt(const HammingTask& task, int count, int* distances) {
  FillAny(task, EachRow(), static_cast<std::size_t>(count), distances);
}
FLOORLOC_TARGET("popcnt")
void ChosenPopcnt(const HammingTask& task, std::span<const int> indices, int* distances) {
  FillAny(task, indices.data(), indices.size(), distances);
}

#define FLOORLOC_AVX512 FLOORLOC_TARGET("popcnt,avx2,avx512f,avx512vl,avx512vpopcntdq")

// Bits that differ in each of the four words of a row.
FLOORLOC_AVX512 inline __m256i CountWords(const std::uint64_t* row, __m256i query) {
  const __m256i words = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(row));
  return _mm256_popcnt_epi64(_mm256_xor_si256(words, query));
}

// Four rows of four words at a time.
template <typename Indices>
FLOORLOC_AVX512 inline std::size_t FillFours(const HammingTask& task, const Indices& indices, std::size_t count,
                                             int* distances) {
  const __m256i query = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(task.query));
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    const auto row = [&](std::size_t k) { return task.rows + static_cast<std::ptrdiff_t>(indices[i + k]) * kWords256; };
    const __m256i a = CountWords(row(0), query);
    const __m256i b = CountWords(row(1), query);
    const __m256i c = CountWords(row(2), query);
    const __m256i d = CountWords(row(3), query);
    const __m256i ab = _mm256_add_epi64(_mm256_unpacklo_epi64(a, b), _mm256_unpackhi_epi64(a, b));
    const __m256i cd = _mm256_add_epi64(_mm256_unpacklo_epi64(c, d), _mm256_unpackhi_epi64(c, d));
    const __m256i abcd =
        _mm256_add_epi64(_mm256_permute2x128_si256(ab, cd, 0x20), _mm256_permute2x128_si256(ab, cd, 0x31));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(distances + i), _mm256_maskz_cvtepi64_epi32(0xF, abcd));
  }
  return i;
}

FLOORLOC_AVX512 void SuccessiveAvx512(const HammingTask& task, int count, int* distances) {
  const auto rows = static_cast<std::size_t>(count);
  const std::size_t done = task.words_per_row == kWords256 ? FillFours(task, EachRow(), rows, distances) : 0;
  for (std::size_t i = done; i < rows; ++i) {
    distances[i] =
        Distance<0>(task.rows + static_cast<std::ptrdiff_t>(i) * task.words_per_row, task.query, task.words_per_row);
  }
}
FLOORLOC_AVX512 void ChosenAvx512(const HammingTask& task, std::span<const int> indices, int* distances) {
  const std::size_t done =
      task.words_per_row == kWords256 ? FillFours(task, indices.data(), indices.size(), distances) : 0;
  FillAny(task, indices.data() + done, indices.size() - done, distances + done);
}

#endif

HammingKernels ChooseBest() { return SupportedHammingKernels().back(); }

}  // namespace

std::vector<HammingKernels> SupportedHammingKernels() {
  std::vector<HammingKernels> kernels = {{"portable", SuccessivePortable, ChosenPortable}};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("popcnt")) {
    kernels.push_back({"popcnt", SuccessivePopcnt, ChosenPopcnt});
  }
  if (__builtin_cpu_supports("avx512vpopcntdq") && __builtin_cpu_supports("avx512vl")) {
    kernels.push_back({"avx512", SuccessiveAvx512, ChosenAvx512});
  }
#endif
  return kernels;
}

const HammingKernels& BestHammingKernels() {
  static const HammingKernels best = ChooseBest();
  return best;
}

}  // namespace floorloc
