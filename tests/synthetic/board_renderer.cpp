// SPDX-License-Identifier: Apache-2.0
#include "tests/synthetic/board_renderer.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "mapbuilder/fiducials/aruco_dictionary.h"

namespace floorloc {
namespace {

constexpr double kPrintResolutionM = 5e-4;
constexpr int kSamplesPerSide = 4;
constexpr unsigned char kBlack = 35;
constexpr unsigned char kWhite = 225;

// Squares and rim; row 0 is the top row.
PrintedBoard PrintSquares(const Board& board, bool top_left_black) {
  const int square = static_cast<int>(std::lround(board.square_m / kPrintResolutionM));
  const cv::Size size((board.columns + 3) * square, (board.rows + 3) * square);
  PrintedBoard print{cv::Mat(size, CV_8UC1, cv::Scalar(kWhite)), kPrintResolutionM, {}};
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column) {
      if (((row + column) % 2 == 0) == top_left_black) {
        print.gray(cv::Rect((column + 1) * square, (row + 1) * square, square, square)) = kBlack;
      }
    }
  }
  print.corner0_px = Eigen::Vector2d(2.0 * square, (board.rows + 1.0) * square);
  return print;
}

}  // namespace

PrintedBoard PrintChessboard(const Board& board) { return PrintSquares(board, board.rows % 2 == 0); }

PrintedBoard PrintCharuco(const Board& board, bool black_first) {
  const bool top_left_black = black_first || board.rows % 2 == 0;
  PrintedBoard print = PrintSquares(board, top_left_black);
  const int square = static_cast<int>(std::lround(board.square_m / kPrintResolutionM));
  const int side = static_cast<int>(std::lround(board.charuco->marker_m / kPrintResolutionM));
  const cv::Ptr<cv::aruco::Dictionary> dictionary = FindArucoDictionary(board.charuco->dictionary);
  int id = 0;
  for (int row = 0; row <= board.rows; ++row) {
    for (int column = 0; column <= board.columns; ++column) {
      if (((row + column) % 2 == 0) == top_left_black) {
        continue;
      }
      cv::Mat marker;
      cv::aruco::drawMarker(dictionary, id++, side, marker);
      marker.convertTo(marker, CV_8U, (kWhite - kBlack) / 255.0, kBlack);
      const int gap = (square - side) / 2;
      marker.copyTo(print.gray(cv::Rect((column + 1) * square + gap, (row + 1) * square + gap, side, side)));
    }
  }
  return print;
}

BoardRenderer::BoardRenderer(const CameraModel& camera) : camera_(camera) {
  for (int v = 0; v <= camera.height_px; ++v) {
    for (int u = 0; u <= camera.width_px; ++u) {
      const Eigen::Vector2d p = camera.Undistort({u - 0.5, v - 0.5});
      rays_.emplace_back((p.x() - camera.cx) / camera.fx, (p.y() - camera.cy) / camera.fy);
    }
  }
}

cv::Mat BoardRenderer::Render(const PrintedBoard& board, const Eigen::Isometry3d& camera_from_board) const {
  Eigen::Matrix3d columns;
  columns << camera_from_board.linear().leftCols<2>(), camera_from_board.translation();
  const Eigen::Matrix3d board_from_ray = columns.inverse();
  cv::Mat image(camera_.height_px, camera_.width_px, CV_8UC1);
  const auto stride = static_cast<std::size_t>(camera_.width_px) + 1;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const std::size_t i = static_cast<std::size_t>(v) * stride + static_cast<std::size_t>(u);
      const int background = 90 + 60 * v / image.rows;
      int sum = 0;
      for (int s = 0; s < kSamplesPerSide * kSamplesPerSide; ++s) {
        const int sample_row = s / kSamplesPerSide;
        const double a = (s % kSamplesPerSide + 0.5) / kSamplesPerSide;
        const double b = (sample_row + 0.5) / kSamplesPerSide;
        const Eigen::Vector2d ray = (1.0 - b) * ((1.0 - a) * rays_[i] + a * rays_[i + 1]) +
                                    b * ((1.0 - a) * rays_[i + stride] + a * rays_[i + stride + 1]);
        const Eigen::Vector3d h = board_from_ray * ray.homogeneous();
        const int column = static_cast<int>(std::floor(board.corner0_px.x() + h.x() / h.z() / board.resolution_m));
        const int row = static_cast<int>(std::floor(board.corner0_px.y() - h.y() / h.z() / board.resolution_m));
        const bool inside = h.z() > 0.0 && column >= 0 && row >= 0 && column < board.gray.cols && row < board.gray.rows;
        sum += inside ? board.gray.at<unsigned char>(row, column) : background;
      }
      image.at<unsigned char>(v, u) = static_cast<unsigned char>(sum / (kSamplesPerSide * kSamplesPerSide));
    }
  }
  return image;
}

Eigen::Isometry3d PlaceBoard(const CameraModel& camera, const Board& board, const BoardPlacement& placement) {
  const Eigen::Vector3d ray((placement.middle_px.x() - camera.cx) / camera.fx,
                            (placement.middle_px.y() - camera.cy) / camera.fy, 1.0);
  const Eigen::Vector2d middle = 0.5 * board.Corner(board.corner_count() - 1);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(placement.distance_m * ray);
  pose.rotate(Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d::UnitX()));  // the printed side faces the camera
  pose.rotate(Eigen::AngleAxisd(placement.turn_rad, Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(placement.tilt_x_rad, Eigen::Vector3d::UnitX()));
  pose.rotate(Eigen::AngleAxisd(placement.tilt_y_rad, Eigen::Vector3d::UnitY()));
  pose.translate(Eigen::Vector3d(-middle.x(), -middle.y(), 0.0));
  return pose;
}

std::vector<BoardPlacement> VariedPlacements(const CameraModel& camera, const Board& board, int count) {
  // Distances at which the board fills about half of the image's height.
  const double side_m = std::max(board.columns, board.rows) * board.square_m;
  const double distance_m = 1.8 * camera.fy * side_m / camera.height_px;
  std::vector<BoardPlacement> placements;
  for (int i = 0; i < count; ++i) {
    const double across = 0.2 + 0.3 * (i % 3);
    const double down = 0.22 + 0.28 * (i / 3 % 3);
    const double angle = 2.4 * i;
    placements.push_back({{across * camera.width_px, down * camera.height_px},
                          distance_m * (0.85 + 0.12 * (i % 4)),
                          0.5 * std::cos(angle),
                          0.5 * std::sin(angle),
                          0.35 * (i % 5) - 0.7});
  }
  return placements;
}

BoardView ProjectBoard(const CameraModel& camera, const Board& board, const Eigen::Isometry3d& camera_from_board,
                       double noise_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  BoardView view;
  for (int i = 0; i < board.corner_count(); ++i) {
    const Eigen::Vector2d corner = board.Corner(i);
    const Eigen::Vector3d p = camera_from_board * Eigen::Vector3d(corner.x(), corner.y(), 0.0);
    const Eigen::Vector2d undistorted(camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy);
    const Eigen::Vector2d error = noise_px * Eigen::Vector2d(noise(random), noise(random));
    const Eigen::Vector2d raw_px = camera.Distort(undistorted) + error;
    if (camera.Contains(raw_px)) {
      view.corners.push_back(i);
      view.raw_px.push_back(raw_px);
    }
  }
  return view;
}

CameraModel MakeBoardCamera() {
  CameraModel camera;
  camera.name = "board camera";
  camera.width_px = 480;
  camera.height_px = 360;
  camera.fx = 441.0;
  camera.fy = 439.5;
  camera.cx = 243.2;
  camera.cy = 176.4;
  camera.distortion_model = DistortionModel::kPlumbBob;
  camera.distortion = {-0.25, 0.07, 0.0008, -0.0005, 0.0};
  return camera;
}

}  // namespace floorloc
