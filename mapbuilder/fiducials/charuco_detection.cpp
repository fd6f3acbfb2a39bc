// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fiducials/charuco_detection.h"

#include <array>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include "mapbuilder/fiducials/aruco_dictionary.h"

namespace floorloc {
namespace {

// Markers within this distance are used to interpolate a corner: several, since their own corners are only accurate to
// a pixel; no farther ones, because of lens distortion.
constexpr double kReachSquares = 1.7;

using MarkerCorners = std::array<cv::Point2f, 4>;

// Corners of the markers of a board, ordered by id: row by row from the top, in the white squares. Clockwise from the
// upper left, board frame, metres.
std::vector<MarkerCorners> MakeBoard(const Board& board, bool starts_black) {
  std::vector<MarkerCorners> markers;
  const double half = 0.5 * board.charuco->marker_m;
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column) {
      if (((row + column) % 2 == 0) == starts_black) {
        continue;
      }
      // Corner 0 is the lower left inner corner: the squares begin one square before it.
      const double x = (column - 0.5) * board.square_m;
      const double y = (board.rows - row - 0.5) * board.square_m;
      const auto point = [&](double dx, double dy) {
        return cv::Point2f(static_cast<float>(x + dx), static_cast<float>(y + dy));
      };
      markers.push_back({point(-half, half), point(half, half), point(half, -half), point(-half, -half)});
    }
  }
  return markers;
}

std::map<int, MarkerCorners> FindMarkers(const cv::Mat& gray, const Board& board) {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(gray, FindArucoDictionary(board.charuco->dictionary), corners, ids);
  std::map<int, MarkerCorners> found;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    found[ids[i]] = {corners[i][0], corners[i][1], corners[i][2], corners[i][3]};
  }
  return found;
}

// Corresponding corners of detected markers on the board and in the image.
struct PointPairs {
  std::vector<cv::Point2f> board;
  std::vector<cv::Point2f> image;

  void Add(const MarkerCorners& on_board, const MarkerCorners& in_image) {
    board.insert(board.end(), on_board.begin(), on_board.end());
    image.insert(image.end(), in_image.begin(), in_image.end());
  }
};

// Number of markers consistent with this layout, with a tolerance for lens distortion.
int CountFitting(const std::vector<MarkerCorners>& layout, const std::map<int, MarkerCorners>& found) {
  PointPairs pairs;
  for (const auto& [id, corners] : found) {
    if (static_cast<std::size_t>(id) < layout.size()) {
      pairs.Add(layout[static_cast<std::size_t>(id)], corners);
    }
  }
  if (pairs.board.size() < 8) {
    return 0;
  }
  const double tolerance_px = 0.5 * cv::norm(pairs.image[0] - pairs.image[1]);
  std::vector<unsigned char> fits;
  cv::findHomography(pairs.board, pairs.image, cv::RANSAC, tolerance_px, fits);
  return cv::countNonZero(fits) / 4;
}

// Image position of a corner, interpolated from the markers around it.
std::optional<Eigen::Vector2d> Interpolate(const Eigen::Vector2d& corner, const Board& board,
                                           const std::vector<MarkerCorners>& layout,
                                           const std::map<int, MarkerCorners>& found) {
  PointPairs pairs;
  const cv::Point2f target(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  for (const auto& [id, corners] : found) {
    if (static_cast<std::size_t>(id) >= layout.size()) {
      continue;
    }
    const MarkerCorners& on_board = layout[static_cast<std::size_t>(id)];
    if (cv::norm(0.5F * (on_board[0] + on_board[2]) - target) < kReachSquares * board.square_m) {
      pairs.Add(on_board, corners);
    }
  }
  if (pairs.board.empty()) {
    return std::nullopt;
  }
  const cv::Mat homography = cv::findHomography(pairs.board, pairs.image, 0);
  if (homography.empty()) {
    return std::nullopt;
  }
  std::vector<cv::Point2f> point{target};
  cv::perspectiveTransform(point, point, homography);
  return Eigen::Vector2d(point[0].x, point[0].y);
}

}  // namespace

std::optional<BoardView> DetectCharuco(const cv::Mat& gray, const Board& board) {
  const std::map<int, MarkerCorners> found = FindMarkers(gray, board);
  const std::vector<MarkerCorners> black = MakeBoard(board, true);
  const std::vector<MarkerCorners> white = MakeBoard(board, false);
  const int fit_black = CountFitting(black, found);
  // With an odd number of rows of squares, both layouts start with black.
  const int fit_white = board.rows % 2 == 1 ? CountFitting(white, found) : 0;
  if (std::max(fit_black, fit_white) < 2) {
    return std::nullopt;
  }
  const std::vector<MarkerCorners>& layout = fit_white > fit_black ? white : black;
  BoardView view;
  for (int i = 0; i < board.corner_count(); ++i) {
    const std::optional<Eigen::Vector2d> px = Interpolate(board.Corner(i), board, layout, found);
    if (px && px->x() >= 0 && px->y() >= 0 && px->x() < gray.cols && px->y() < gray.rows) {
      view.corners.push_back(i);
      view.raw_px.push_back(*px);
    }
  }
  return view;
}

}  // namespace floorloc
