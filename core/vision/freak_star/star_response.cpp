// SPDX-License-Identifier: Apache-2.0
#include "core/vision/freak_star/star_response.h"

#include <array>
#include <cmath>

#include "core/vision/image/multiversion.h"

namespace floorloc {
namespace {

std::uint32_t* MutableRow(cv::Mat* sums, int y) { return reinterpret_cast<std::uint32_t*>(sums->ptr<int>(y + 2)) + 1; }

struct TipRows {
  const std::uint8_t* a;
  const std::uint8_t* b;
};

// A triangle is the union of the two with the neighbours above its tip as tips, minus their intersection, plus the tip.
FLOORLOC_WIDE_VECTORS void AddRow(const std::uint32_t* __restrict one_up, const std::uint32_t* __restrict two_up,
                                  const TipRows& tips, std::uint32_t* __restrict sums, int count) {
  const std::uint8_t* __restrict tip_a = tips.a;
  const std::uint8_t* __restrict tip_b = tips.b;
  for (std::ptrdiff_t x = 0; x < count; ++x) {
    sums[x] = one_up[x - 1] + one_up[x + 1] - two_up[x] + tip_a[x] + tip_b[x];
  }
}

// One star's sum at a row of pixels: corners in the two tables.
struct StarRows {
  const std::uint32_t* top;
  const std::uint32_t* bottom;
  const std::uint32_t* upper_tip;
  const std::uint32_t* lower_tip;
  const std::uint32_t* sides;
  int square;
  int tip;
};

StarRows RowsOf(const IntegralImage& squares, const TriangleSums& triangles, const StarShape& star, int y) {
  return {squares.row(y - star.square),
          squares.row(y + star.square + 1),
          triangles.odd(y - star.tip - 1),
          triangles.odd(y + star.tip),
          triangles.even(y - 1),
          star.square,
          star.tip};
}

FLOORLOC_INLINE float Sum(const StarRows& star, std::ptrdiff_t x) {
  const std::uint32_t square = star.bottom[x + star.square + 1] - star.bottom[x - star.square] -
                               star.top[x + star.square + 1] + star.top[x - star.square];
  const std::uint32_t tilted =
      star.lower_tip[x] - star.sides[x - star.tip - 1] - star.sides[x + star.tip] + star.upper_tip[x];
  return static_cast<float>(static_cast<std::int32_t>(square + tilted));
}

struct Areas {
  float inner;
  float ring;
};

FLOORLOC_WIDE_VECTORS void RespondRow(const StarRows& inner, const StarRows& outer, const Areas& areas,
                                      float* __restrict out, const cv::Range& columns) {
  const float per_inner = 1.0F / areas.inner;
  const float per_ring = 1.0F / areas.ring;
  for (std::ptrdiff_t x = columns.start; x < columns.end; ++x) {
    const float inside = Sum(inner, x);
    out[x] = (Sum(outer, x) - inside) * per_ring - inside * per_inner;
  }
}

}  // namespace

TriangleSums::TriangleSums(const cv::Mat& gray)
    : odd_(cv::Mat::zeros(gray.rows + 2, gray.cols + 2, CV_32SC1)),
      even_(cv::Mat::zeros(gray.rows + 2, gray.cols + 2, CV_32SC1)) {
  const int width = gray.cols;
  const cv::Mat black = cv::Mat::zeros(1, width, CV_8UC1);
  for (int y = 0; y < gray.rows; ++y) {
    const std::uint8_t* const pixels = gray.ptr(y);
    const std::uint8_t* const above = y > 0 ? gray.ptr(y - 1) : black.ptr();
    std::uint32_t* const odd_row = MutableRow(&odd_, y);
    AddRow(odd(y - 1), odd(y - 2), {pixels, above}, odd_row, width);
    // The part inside the image of a triangle whose tip is beside it is a triangle with its tip at a higher pixel of
    // the edge.
    odd_row[-1] = odd(y - 1)[0];
    odd_row[width] = odd(y - 1)[width - 1];
    std::uint32_t* const even_row = MutableRow(&even_, y);
    AddRow(even(y - 1), even(y - 2), {pixels, pixels + 1}, even_row, width - 1);
    even_row[-1] = odd_row[0];
    even_row[width - 1] = odd_row[width - 1];
  }
}

std::vector<StarScale> StarScales(int max_size_px) {
  constexpr std::array<int, 11> kSquares{1, 2, 3, 4, 6, 8, 11, 16, 22, 32, 45};
  const auto star = [&](std::size_t i) {
    return StarShape{kSquares[i], static_cast<int>(std::lround(std::sqrt(2.0) * kSquares[i]))};
  };
  std::vector<StarScale> scales;
  for (std::size_t i = 0; i + 2 < kSquares.size(); ++i) {
    const StarScale scale{star(i), star(i + 2)};
    if (scale.size_px() <= max_size_px) {
      scales.push_back(scale);
    }
  }
  return scales;
}

cv::Mat StarResponse(const IntegralImage& squares, const TriangleSums& triangles, const StarScale& scale) {
  cv::Mat response = cv::Mat::zeros(squares.height(), squares.width(), CV_32FC1);
  const int margin = scale.outer.tip;
  const Areas areas{scale.inner.area(), scale.outer.area() - scale.inner.area()};
  for (int y = margin; y < squares.height() - margin; ++y) {
    RespondRow(RowsOf(squares, triangles, scale.inner, y), RowsOf(squares, triangles, scale.outer, y), areas,
               response.ptr<float>(y), {margin, squares.width() - margin});
  }
  return response;
}

}  // namespace floorloc
