// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <opencv2/core/mat.hpp>
#include <span>

#include "core/photometry/photometric_aligner.h"
#include "core/vision/image/multiversion.h"

namespace floorloc {

/// The estimated motion, as numbers for the inner loop: a pixel of the frame -> a pixel of the mosaic.
struct CellWarp {
  float cos_yaw, sin_yaw;
  float camera_x, camera_y, height;  // base frame
  float center_x, center_y;          // base frame, about which the frame turns
  float middle_u, middle_v;          // mosaic pixel of the centre
  float per_m;                       // px per metre
  float rotation_x, rotation_y, rotation_z, height_share;

  struct Point {
    float u, v;
  };

  FLOORLOC_INLINE Point At(const FrameSamples::Sample& s) const {
    const float x = s.x_m - camera_x;
    const float y = s.y_m - camera_y;
    const float inverse = 1.0F / height;
    // Columns of MountingJacobian().
    const float ax = x * y * inverse, ay = height + y * y * inverse;
    const float bx = -(height + x * x * inverse), by = -x * y * inverse;
    const float px = s.x_m - center_x + ax * rotation_x + bx * rotation_y - y * rotation_z + x * height_share;
    const float py = s.y_m - center_y + ay * rotation_x + by * rotation_y + x * rotation_z + y * height_share;
    return {middle_u + (cos_yaw * px - sin_yaw * py) * per_m, middle_v - (sin_yaw * px + cos_yaw * py) * per_m};
  }
};

/// Where a frame lies in the map.
struct FramePlacement {
  double yaw_rad = 0.0;
  Eigen::Vector2d middle_in_map = Eigen::Vector2d::Zero();  ///< of FrameSamples::center, metres
  Eigen::Vector4d mounting = Eigen::Vector4d::Zero();       ///< MountingError: rotation, height share
};

CellWarp MakeCellWarp(const FrameSamples& frame, const FramePlacement& placement, const RasterPatch& patch);

/// Sums over pixels of a cell that lie on surveyed floor: how well frame and mosaic correlate there.
struct CellCorrelation {
  float n = 0.0F, f = 0.0F, m = 0.0F, ff = 0.0F, mm = 0.0F, fm = 0.0F;

  void Add(float frame, float mosaic) {
    n += 1.0F;
    f += frame;
    m += mosaic;
    ff += frame * frame;
    mm += mosaic * mosaic;
    fm += frame * mosaic;
  }
  void AddCounts(const CellCorrelation& other);
  float VarianceOfFrame() const { return ff - f * f / n; }  ///< times n, as the next two
  float VarianceOfMosaic() const { return mm - m * m / n; }
  float Covariance() const { return fm - f * m / n; }
  float Correlation() const;
};

/// What the pixels tell of a displacement that is linear in the cell: their slopes (gx, gy), and the slopes times the
/// position (dx, dy) relative to the cell's centre: (gx, gy, gx dx, gx dy, gy dx, gy dy).
using CellVector = Eigen::Matrix<double, 6, 1>;
using CellMatrix = Eigen::Matrix<double, 6, 6>;

/// The same with what the pixels tell of the displacement. Slopes are grey levels per metre in the map.
struct CellSums : CellCorrelation {
  /// Of row row^T, row: CellVector of a pixel.
  CellMatrix Information() const;
  /// Of row (frame - gain mosaic).
  CellVector Pull(double gain) const;

  // Products of slopes (xx, xy, yy) times (1, dx, dy, dx dx, dx dy, dy dy, 0, 0).
  std::array<std::array<float, 8>, 3> slopes{};
  // Slopes (x, y) times (1, dx, dy, 0): times the frame's grey level, then times the mosaic's.
  std::array<std::array<float, 8>, 2> pulls{};
};

/// Adds samples of a cell, but for those beside floor that was not surveyed. center: of the cell.
void AddCell(std::span<const FrameSamples::Sample> samples, const Eigen::Vector2f& center, const CellWarp& warp,
             const RasterPatch& patch, CellSums* sums);

/// Grey levels of the mosaic under the samples, mean 0; not a number beyond the surveyed floor. gray:
/// RasterPatch::gray.
void SampleMosaic(std::span<const FrameSamples::Sample> samples, const CellWarp& warp, const cv::Mat& gray,
                  std::span<float> values);

/// Only how well they correlate, all of them. gray: RasterPatch::gray.
CellCorrelation CorrelateCell(std::span<const FrameSamples::Sample> samples, const CellWarp& warp, const cv::Mat& gray);

}  // namespace floorloc
