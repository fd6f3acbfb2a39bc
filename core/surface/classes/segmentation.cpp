// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/segmentation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

constexpr int kStepsPerLevel = 128;  // of an edge's weight; 441 levels (black to white) fit into 16 bits
constexpr int kWeights = 1 << 16;

// The edges of the pixel grid, the lightest first.
struct SortedEdges {
  std::vector<std::uint32_t> edges;  // 2 * first pixel + (0: to the right, 1: down)
  std::vector<std::uint16_t> weights;
};

// 8 bits to 16 with kStepsPerLevel, so that the filter does not round to whole levels.
cv::Mat Smooth(const cv::Mat& image, double sigma_px) {
  cv::Mat fine;
  image.convertTo(fine, CV_16U, kStepsPerLevel);
  if (sigma_px > 0.0) {
    cv::GaussianBlur(fine, fine, {}, sigma_px, sigma_px);
  }
  return fine;
}

std::uint16_t Weight(const std::uint16_t* a, const std::uint16_t* b) {
  const float d0 = static_cast<float>(a[0]) - static_cast<float>(b[0]);
  const float d1 = static_cast<float>(a[1]) - static_cast<float>(b[1]);
  const float d2 = static_cast<float>(a[2]) - static_cast<float>(b[2]);
  // Never negative: truncation rounds it.
  const float shifted = std::sqrt(d0 * d0 + d1 * d1 + d2 * d2) + 0.5F;
  return static_cast<std::uint16_t>(shifted);
}

// Weights of all edges, two per pixel; those that lead out of the image are not used.
std::vector<std::uint16_t> EdgeWeights(const cv::Mat& fine) {
  std::vector<std::uint16_t> weights(2 * fine.total());
  for (int y = 0; y < fine.rows; ++y) {
    const auto* row = fine.ptr<std::uint16_t>(y);
    const auto* next = fine.ptr<std::uint16_t>(std::min(y + 1, fine.rows - 1));
    std::uint16_t* out = weights.data() + 2 * static_cast<std::size_t>(y) * static_cast<std::size_t>(fine.cols);
    for (int x = 0; x < fine.cols; ++x) {
      out[2 * x] = Weight(row + 3 * x, row + 3 * std::min(x + 1, fine.cols - 1));
      out[2 * x + 1] = Weight(row + 3 * x, next + 3 * x);
    }
  }
  return weights;
}

template <typename Use>
void ForEachEdge(cv::Size size, Use use) {
  for (int y = 0; y < size.height; ++y) {
    const std::uint32_t first = 2 * static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(size.width);
    for (int x = 0; x < size.width; ++x) {
      const std::uint32_t edge = first + 2 * static_cast<std::uint32_t>(x);
      if (x + 1 < size.width) {
        use(edge);
      }
      if (y + 1 < size.height) {
        use(edge + 1);
      }
    }
  }
}

// Counting sort.
SortedEdges SortEdges(const std::vector<std::uint16_t>& weights, cv::Size size) {
  std::vector<std::uint32_t> places(kWeights + 1, 0);
  ForEachEdge(size, [&](std::uint32_t edge) { ++places[weights[edge] + 1U]; });
  std::partial_sum(places.begin(), places.end(), places.begin());
  SortedEdges sorted;
  sorted.edges.resize(places.back());
  sorted.weights.resize(places.back());
  ForEachEdge(size, [&](std::uint32_t edge) {
    const std::uint32_t place = places[weights[edge]]++;
    sorted.edges[place] = edge;
    sorted.weights[place] = weights[edge];
  });
  return sorted;
}

// Disjoint sets of pixels with what equation (2) asks of them.
class Forest {
 public:
  Forest(std::size_t pixels, double k) : k_(static_cast<float>(k * kStepsPerLevel)), nodes_(pixels) {
    for (std::size_t i = 0; i < pixels; ++i) {
      nodes_[i] = {static_cast<std::uint32_t>(i), 1, k_};
    }
  }

  std::uint32_t Find(std::uint32_t pixel) {
    while (nodes_[pixel].parent != pixel) {
      nodes_[pixel].parent = nodes_[nodes_[pixel].parent].parent;
      pixel = nodes_[pixel].parent;
    }
    return pixel;
  }

  // a, b: roots.
  bool MayJoin(std::uint32_t a, std::uint32_t b, float weight) const {
    return weight <= std::min(nodes_[a].limit, nodes_[b].limit);
  }
  bool IsSmaller(std::uint32_t a, std::uint32_t b, int size) const {
    const auto least = static_cast<std::uint32_t>(size);
    return nodes_[a].size < least || nodes_[b].size < least;
  }
  void Join(std::uint32_t a, std::uint32_t b, float weight) {
    if (nodes_[a].size < nodes_[b].size) {
      std::swap(a, b);
    }
    nodes_[b].parent = a;
    nodes_[a].size += nodes_[b].size;
    // Edges come sorted: the newest is the heaviest inside.
    nodes_[a].limit = weight + k_ / static_cast<float>(nodes_[a].size);
  }

 private:
  struct Node {
    std::uint32_t parent;
    std::uint32_t size;  // of roots: pixels
    float limit;         // of roots: INT(v) + k / Size(v)
  };

  float k_;
  std::vector<Node> nodes_;
};

struct Ends {
  std::uint32_t a, b;
};

Ends RootsOf(std::uint32_t edge, std::uint32_t width, Forest* forest) {
  const std::uint32_t pixel = edge / 2;
  return {forest->Find(pixel), forest->Find(pixel + ((edge & 1U) != 0 ? width : 1U))};
}

Segmentation Label(cv::Size size, Forest* forest) {
  Segmentation result{cv::Mat(size, CV_32SC1), 0};
  std::vector<int> label_of_root(static_cast<std::size_t>(size.area()), -1);
  std::uint32_t pixel = 0;
  for (int y = 0; y < size.height; ++y) {
    int* row = result.labels.ptr<int>(y);
    for (int x = 0; x < size.width; ++x, ++pixel) {
      int& label = label_of_root[forest->Find(pixel)];
      label = label < 0 ? result.count++ : label;
      row[x] = label;
    }
  }
  return result;
}

}  // namespace

void SegmentationOptions::Check() const {
  RequireOption(sigma_px >= 0.0 && sigma_px <= 10.0, "sigma_px must be 0 to 10");
  RequireOption(k >= 0.0 && k <= 1e5, "k must be 0 to 100000");
  RequireOption(min_size_px >= 1 && min_size_px <= 1'000'000'000, "min_size_px must be 1 to 1000000000");
}

Segmentation SegmentImage(const cv::Mat& image, const SegmentationOptions& options) {
  options.Check();
  RequireOption(!image.empty() && image.type() == CV_8UC3, "the image must have 3 channels of 8 bits");
  const auto width = static_cast<std::uint32_t>(image.cols);
  const SortedEdges sorted = SortEdges(EdgeWeights(Smooth(image, options.sigma_px)), image.size());
  Forest forest(image.total(), options.k);
  std::vector<std::uint32_t> kept;  // edges that still separate segments
  for (std::size_t i = 0; i < sorted.edges.size(); ++i) {
    const auto [a, b] = RootsOf(sorted.edges[i], width, &forest);
    if (a == b) {
      continue;
    }
    const auto weight = static_cast<float>(sorted.weights[i]);
    forest.MayJoin(a, b, weight) ? forest.Join(a, b, weight) : kept.push_back(sorted.edges[i]);
  }
  for (const std::uint32_t edge : kept) {
    const auto [a, b] = RootsOf(edge, width, &forest);
    if (a != b && forest.IsSmaller(a, b, options.min_size_px)) {
      forest.Join(a, b, 0.0F);
    }
  }
  return Label(image.size(), &forest);
}

}  // namespace floorloc
