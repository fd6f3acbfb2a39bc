// SPDX-License-Identifier: Apache-2.0
#include "core/lattice/lattice_regions.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

// A square of the floor, and the lattice that its keypoints lie on. Positions are relative to the keypoints' origin.
struct Block {
  std::vector<int> keypoints;
  std::optional<FloorLattice> lattice;
  int region = -1;
};

// Columns and rows of equal blocks over the bounding box of the keypoints.
class BlockGrid {
 public:
  BlockGrid(const MapKeypoints& map, double block_m) {
    Eigen::AlignedBox2d box;
    for (const Keypoint& k : map.keypoints) {
      box.extend(k.Position());
    }
    corner_ = box.min();
    const Eigen::Vector2d counts = (box.sizes() / block_m).array().round().max(1.0);
    columns_ = static_cast<int>(counts.x());
    rows_ = static_cast<int>(counts.y());
    side_m_ = (box.sizes().array() / counts.array()).max(1e-9);
    for (int i = 0; i < static_cast<int>(map.size()); ++i) {
      const Eigen::Vector2d p = map.keypoints[static_cast<std::size_t>(i)].Position();
      const Eigen::Vector2d at = (p - corner_).array() / side_m_.array();
      const int column = std::min(static_cast<int>(at.x()), columns_ - 1);
      const int row = std::min(static_cast<int>(at.y()), rows_ - 1);
      blocks_[{row, column}].keypoints.push_back(i);
    }
  }

  // Without those that hold no keypoint, by row and column.
  std::map<std::pair<int, int>, Block>& blocks() { return blocks_; }

 private:
  Eigen::Vector2d corner_ = Eigen::Vector2d::Zero();
  Eigen::Array2d side_m_ = Eigen::Array2d::Ones();
  int columns_ = 1;
  int rows_ = 1;
  std::map<std::pair<int, int>, Block> blocks_;
};

MapKeypoints Subset(const MapKeypoints& map, const std::vector<int>& indices) {
  MapKeypoints part;
  part.descriptors = cv::Mat(static_cast<int>(indices.size()), map.descriptors.cols, map.descriptors.type());
  for (const int i : indices) {
    map.descriptors.row(i).copyTo(part.descriptors.row(static_cast<int>(part.keypoints.size())));
    part.keypoints.push_back(map.keypoints[static_cast<std::size_t>(i)]);
  }
  return part;
}

std::optional<FloorLattice> FindLattice(const MapKeypoints& map, const LatticeRegionOptions& options,
                                        std::uint32_t seed) {
  if (static_cast<int>(map.size()) < options.min_keypoints) {
    return std::nullopt;
  }
  const std::unique_ptr<DescriptorIndex> index = CreateDescriptorIndex(map.descriptors, {});
  return IsSelfSimilar(map, *index, options.self_similarity, seed)
             ? FindFloorLattice(map, *index, options.lattice, seed)
             : std::nullopt;
}

// The basis of `other` that is nearest to that of `lattice`, if both have the same whole multiples.
std::optional<Eigen::Matrix2d> SameBasis(const FloorLattice& lattice, const FloorLattice& other,
                                         double max_difference_m) {
  const Eigen::Matrix2d whole = (other.basis.inverse() * lattice.basis).array().round();
  const Eigen::Matrix2d same = other.basis * whole;
  const bool is_basis = std::abs(std::abs(whole.determinant()) - 1.0) < 0.5;
  return is_basis && (same - lattice.basis).colwise().norm().maxCoeff() <= max_difference_m ? std::optional(same)
                                                                                            : std::nullopt;
}

using Region = std::vector<const Block*>;

// Blocks with a lattice, each with those beside it that have the same one.
std::vector<Region> JoinBlocks(std::map<std::pair<int, int>, Block>* blocks, double max_difference_m) {
  std::vector<Region> regions;
  for (auto& [start, first] : *blocks) {
    if (!first.lattice || first.region >= 0) {
      continue;
    }
    const int region = static_cast<int>(regions.size());
    regions.emplace_back();
    std::vector<std::pair<int, int>> open = {start};
    first.region = region;
    while (!open.empty()) {
      const auto [row, column] = open.back();
      open.pop_back();
      const Block& block = blocks->at({row, column});
      regions.back().push_back(&block);
      for (const auto& [down, right] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
        const auto beside = blocks->find({row + down, column + right});
        if (beside != blocks->end() && beside->second.lattice && beside->second.region < 0 &&
            SameBasis(*block.lattice, *beside->second.lattice, max_difference_m)) {
          beside->second.region = region;
          open.push_back(beside->first);
        }
      }
    }
  }
  return regions;
}

const Block& Largest(const Region& region) {
  return **std::max_element(region.begin(), region.end(),
                            [](const Block* a, const Block* b) { return a->keypoints.size() < b->keypoints.size(); });
}

// Means over the blocks, each with the weight of its keypoints. Neighbours may differ by max_difference_m, blocks far
// apart by more: those are brought to one basis as well as can be.
FloorLattice MeanLattice(const Region& region) {
  const FloorLattice& reference = *Largest(region).lattice;
  FloorLattice mean{Eigen::Matrix2d::Zero(), 0.0, 0.0};
  double weights = 0.0;
  double squares = 0.0;
  for (const Block* block : region) {
    if (const auto basis = SameBasis(reference, *block->lattice, 0.5 * reference.basis.colwise().norm().minCoeff())) {
      const auto weight = static_cast<double>(block->keypoints.size());
      mean.basis += weight * *basis;
      mean.share += weight * block->lattice->share;
      squares += weight * block->lattice->residual_m * block->lattice->residual_m;
      weights += weight;
    }
  }
  return {mean.basis / weights, std::sqrt(squares / weights), mean.share / weights};
}

// Where most of a block's keypoints lie modulo the lattice, relative to the keypoints' origin: a histogram over one
// cell of the lattice, then the mean in the neighbourhood of its peak.
Eigen::Vector2d FindPoint(const MapKeypoints& map, const Block& block, const FloorLattice& lattice,
                          const FloorLatticeOptions& options) {
  const Eigen::Matrix2d inverse = lattice.basis.inverse();
  const Eigen::Vector2d start = map.keypoints[static_cast<std::size_t>(block.keypoints.front())].Position();
  const auto columns = static_cast<int>(std::ceil(lattice.basis.col(0).norm() / options.bin_m));
  const auto rows = static_cast<int>(std::ceil(lattice.basis.col(1).norm() / options.bin_m));
  const auto cell_of = [&](int i) {  // both coordinates 0 to 1, of the basis
    const Eigen::Vector2d at = inverse * (map.keypoints[static_cast<std::size_t>(i)].Position() - start);
    return Eigen::Vector2d(at.array() - at.array().floor());
  };
  cv::Mat counts = cv::Mat::zeros(rows, columns, CV_32S);
  for (const int i : block.keypoints) {
    const Eigen::Vector2d cell = cell_of(i);
    ++counts.at<int>(std::min(static_cast<int>(cell.y() * rows), rows - 1),
                     std::min(static_cast<int>(cell.x() * columns), columns - 1));
  }
  int peak[2] = {0, 0};
  cv::minMaxIdx(counts, nullptr, nullptr, nullptr, peak);
  Eigen::Vector2d point = start + lattice.basis * Eigen::Vector2d((peak[1] + 0.5) / columns, (peak[0] + 0.5) / rows);
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int near = 0;
    for (const int i : block.keypoints) {
      const Eigen::Vector2d apart = map.keypoints[static_cast<std::size_t>(i)].Position() - point;
      const Eigen::Vector2d off = apart - lattice.basis * lattice.Nearest(apart).cast<double>();
      if (off.norm() <= options.tolerance_m) {
        sum += off;
        ++near;
      }
    }
    point += near > 0 ? Eigen::Vector2d(sum / near) : Eigen::Vector2d(Eigen::Vector2d::Zero());
  }
  return point;
}

// Cells of the floor that hold a keypoint.
std::size_t CountCells(const MapKeypoints& map, const std::vector<int>& keypoints, double cell_m) {
  std::set<std::pair<int, int>> cells;
  for (const int i : keypoints) {
    const Eigen::Vector2d p = map.keypoints[static_cast<std::size_t>(i)].Position();
    cells.emplace(static_cast<int>(std::floor(p.x() / cell_m)), static_cast<int>(std::floor(p.y() / cell_m)));
  }
  return cells.size();
}

MapLattice Describe(const MapKeypoints& map, const Region& region, const LatticeRegionOptions& options) {
  const FloorLattice lattice = MeanLattice(region);
  MapLattice described{{}, 0.0, lattice.basis, {}, lattice.residual_m, lattice.share};
  Eigen::AlignedBox2d box;
  for (const Block* block : region) {
    described.floor_share += static_cast<double>(CountCells(map, block->keypoints, options.cell_m));
    for (const int i : block->keypoints) {
      box.extend(map.PositionInMap(static_cast<std::size_t>(i)));
    }
  }
  described.extent = {box.min().x(), box.max().x(), box.min().y(), box.max().y()};
  const Eigen::Vector2d point = map.origin_m + FindPoint(map, Largest(region), lattice, options.lattice);
  described.point_m = point + lattice.basis * lattice.Nearest(box.center() - point).cast<double>();
  return described;
}

}  // namespace

void LatticeRegionOptions::Check() const {
  self_similarity.Check();
  lattice.Check();
  RequireOption(block_m >= 2.0 * lattice.max_period_m, "block_m must be at least twice max_period_m");
  RequireOption(min_keypoints >= 2, "min_keypoints must be at least 2");
  RequireOption(max_difference_m > 0, "max_difference_m must be positive");
  RequireOption(cell_m > 0, "cell_m must be positive");
}

std::vector<MapLattice> FindLatticeRegions(const MapKeypoints& map, const LatticeRegionOptions& options,
                                           std::uint32_t seed) {
  options.Check();
  std::vector<MapLattice> found;
  if (map.size() < 2 || map.descriptors.depth() != CV_8U) {
    return found;
  }
  BlockGrid grid(map, options.block_m);
  std::size_t cells = 0;
  for (auto& [at, block] : grid.blocks()) {
    block.lattice = FindLattice(Subset(map, block.keypoints), options, seed);
    cells += CountCells(map, block.keypoints, options.cell_m);
  }
  for (const Region& region : JoinBlocks(&grid.blocks(), options.max_difference_m)) {
    found.push_back(Describe(map, region, options));
    found.back().floor_share /= static_cast<double>(cells);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const MapLattice& a, const MapLattice& b) { return a.floor_share > b.floor_share; });
  return found;
}

std::optional<FloorLattice> LargestLattice(const MapInfo& info) {
  if (info.lattices.empty()) {
    return std::nullopt;
  }
  const MapLattice& largest = info.lattices.front();
  return FloorLattice{largest.basis, largest.residual_m, largest.share};
}

}  // namespace floorloc
