// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fiducials/board_detection.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "mapbuilder/fiducials/charuco_detection.h"

namespace floorloc {
namespace {

constexpr std::size_t kMinCorners = 6;

// Corners of a chessboard in rows of `columns`, in the detector's order.
using CornerGrid = std::vector<Eigen::Vector2d>;

std::optional<CornerGrid> FindChessboard(const cv::Mat& gray, const cv::Size& size) {
  std::vector<cv::Point2f> found;
  if (!cv::findChessboardCornersSB(gray, size, found, cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_EXHAUSTIVE) &&
      !cv::findChessboardCorners(gray, size, found, cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE)) {
    return std::nullopt;
  }
  CornerGrid grid;
  for (const cv::Point2f& p : found) {
    grid.emplace_back(p.x, p.y);
  }
  return grid;
}

// Twice the signed area spanned by the board's x and y in the image: negative when z points to the camera, because v
// points down.
double Handedness(const CornerGrid& grid, int columns) {
  const Eigen::Vector2d x = grid[static_cast<std::size_t>(columns) - 1] - grid.front();
  const Eigen::Vector2d y = grid[grid.size() - static_cast<std::size_t>(columns)] - grid.front();
  return x.x() * y.y() - x.y() * y.x();
}

void MirrorRows(CornerGrid* grid, int columns) {
  for (auto row = grid->begin(); row != grid->end(); row += columns) {
    std::reverse(row, row + columns);
  }
}

double MeanOfSquare(const cv::Mat& gray, const Eigen::Vector2d& center) {
  const int u = std::clamp(static_cast<int>(std::lround(center.x())), 1, gray.cols - 2);
  const int v = std::clamp(static_cast<int>(std::lround(center.y())), 1, gray.rows - 2);
  return cv::mean(gray(cv::Rect(u - 1, v - 1, 3, 3)))[0];
}

// Whether the square diagonally outside corner 0 is black, derived from the squares between the corners, since the
// board's rim may be outside the image.
bool StartsBlack(const cv::Mat& gray, const CornerGrid& grid, const Board& board) {
  double same = 0.0;
  double other = 0.0;
  int same_count = 0;
  int other_count = 0;
  for (int row = 0; row + 1 < board.rows; ++row) {
    for (int column = 0; column + 1 < board.columns; ++column) {
      const int corner = row * board.columns + column;
      const auto i = static_cast<std::size_t>(corner);
      const auto below = i + static_cast<std::size_t>(board.columns);
      const double mean = MeanOfSquare(gray, 0.25 * (grid[i] + grid[i + 1] + grid[below] + grid[below + 1]));
      const bool is_same = (row + column) % 2 == 0;
      (is_same ? same : other) += mean;
      ++(is_same ? same_count : other_count);
    }
  }
  return same / same_count < other / other_count;
}

// Numbers the corners as defined in Board, as far as the board's colours determine it.
void SortCorners(const cv::Mat& gray, const Board& board, CornerGrid* grid) {
  if (Handedness(*grid, board.columns) > 0.0) {
    MirrorRows(grid, board.columns);
  }
  if (!StartsBlack(gray, *grid, board)) {
    std::reverse(grid->begin(), grid->end());  // by 180 degrees
  }
}

double ShortestSidePx(const BoardView& view, const Board& board) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    for (std::size_t j = i + 1; j < view.corners.size(); ++j) {
      if ((board.Corner(view.corners[i]) - board.Corner(view.corners[j])).norm() < 1.1 * board.square_m) {
        shortest = std::min(shortest, (view.raw_px[i] - view.raw_px[j]).norm());
      }
    }
  }
  return shortest;
}

// Sub-pixel corners from the gradients around them (Foerstner); the window excludes the neighbouring corners.
void Refine(const cv::Mat& gray, double half_window_share, const Board& board, BoardView* view) {
  const double reach = std::min(half_window_share * ShortestSidePx(*view, board), 0.02 * gray.cols);
  const int half = std::max(2, static_cast<int>(reach));
  cv::Mat smooth;
  cv::GaussianBlur(gray, smooth, {}, std::min(1.0, 0.25 * half));  // sharp edges are aliased, which biases the corners
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector2d& p : view->raw_px) {
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  cv::cornerSubPix(smooth, points, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-4});
  for (std::size_t i = 0; i < points.size(); ++i) {
    view->raw_px[i] = {points[i].x, points[i].y};
  }
}

bool AreCollinear(const BoardView& view, const Board& board) {
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const int corner : view.corners) {
    const Eigen::Vector2d d = board.Corner(corner) - board.Corner(view.corners.front());
    scatter += d * d.transpose();
  }
  return scatter.determinant() < std::pow(board.square_m, 4);
}

}  // namespace

std::optional<BoardView> DetectBoard(const cv::Mat& gray, const Board& board) {
  if (board.charuco) {
    std::optional<BoardView> view = DetectCharuco(gray, board);
    if (!view || view->corners.size() < kMinCorners || AreCollinear(*view, board)) {
      return std::nullopt;
    }
    // The window must exclude the markers' corners.
    Refine(gray, 0.4 * (1.0 - board.charuco->marker_m / board.square_m), board, &*view);
    return view;
  }
  std::optional<CornerGrid> grid = FindChessboard(gray, {board.columns, board.rows});
  if (!grid) {
    return std::nullopt;
  }
  SortCorners(gray, board, &*grid);
  BoardView view{{}, std::move(*grid)};
  for (int i = 0; i < board.corner_count(); ++i) {
    view.corners.push_back(i);
  }
  Refine(gray, 0.4, board, &view);
  return view;
}

}  // namespace floorloc
