// SPDX-License-Identifier: Apache-2.0
// board_images OUT chessboard|charuco|flat: renders images of a board by a known camera for calibrate_test.py: 12 of a
// hand-held board (flat: none of them tilted), and floor.jpg with the board on the floor. camera.yaml and floor.yaml
// are the truth, board_pose.txt is the board's pose on the floor.
#include <cmath>
#include <filesystem>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/geometry/pose2.h"
#include "core/io/camera_yaml.h"
#include "core/io/text_file.h"
#include "tests/synthetic/board_renderer.h"

namespace floorloc {
namespace {

constexpr int kImages = 12;
const Pose2 kBaseFromBoard(0.33, -0.07, 0.2);

// 0.4 m above the floor, looking forward and 60 degrees down.
Eigen::Isometry3d BaseFromCamera() {
  Eigen::Matrix3d forward;
  forward << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << 0.15, 0.01, 0.4;
  pose.linear() = Eigen::AngleAxisd(std::acos(0.5), Eigen::Vector3d::UnitY()) * forward;
  return pose;
}

FloorPlane TrueFloor(const CameraModel& camera) {
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Isometry3d camera_from_base = BaseFromCamera().inverse();
  Eigen::Matrix3d columns;
  columns << camera_from_base.linear().leftCols<2>(), camera_from_base.translation();
  FloorPlane floor;
  floor.base_from_pixel = (k * columns).inverse();
  floor.base_from_pixel /= floor.base_from_pixel(2, 2);
  floor.roi = {0.25, 0.5, -0.15, 0.15};
  floor.resolution_m = 0.001;
  return floor;
}

// Blurred as by a lens.
void WriteImage(const std::filesystem::path& file, const cv::Mat& image) {
  cv::Mat soft;
  cv::GaussianBlur(image, soft, {}, 0.6);
  cv::imwrite(file.string(), soft);
}

void Write(const std::filesystem::path& folder, const std::string& kind) {
  const CameraModel camera = MakeBoardCamera();
  Board board{9, 6, 0.02, {}};
  if (kind == "charuco") {
    board = {8, 5, 0.025, CharucoPattern{"DICT_4X4_50", 0.018}};
  }
  const PrintedBoard print = board.charuco ? PrintCharuco(board, true) : PrintChessboard(board);
  const BoardRenderer renderer(camera);
  int number = 0;
  for (BoardPlacement placement : VariedPlacements(camera, board, kImages)) {
    if (kind == "flat") {
      placement.tilt_x_rad = placement.tilt_y_rad = 0.0;
    }
    // A chessboard must be entirely in the image.
    placement.middle_px = 0.7 * placement.middle_px + 0.3 * Eigen::Vector2d(camera.cx, camera.cy);
    placement.distance_m *= 1.15;
    const std::string name = std::to_string(100 + number++) + ".jpg";
    WriteImage(folder / name, renderer.Render(print, PlaceBoard(camera, board, placement)));
  }
  Eigen::Isometry3d base_from_board = Eigen::Isometry3d::Identity();
  base_from_board.translation() << kBaseFromBoard.translation(), 0.0;
  base_from_board.rotate(Eigen::AngleAxisd(kBaseFromBoard.yaw(), Eigen::Vector3d::UnitZ()));
  WriteImage(folder / "floor.jpg", renderer.Render(print, BaseFromCamera().inverse() * base_from_board));
  WriteFileAtomically(folder / "camera.yaml", FormatCameraYaml(camera));
  WriteFileAtomically(folder / "floor.yaml", FormatFloorYaml(TrueFloor(camera)));
  WriteFileAtomically(folder / "board_pose.txt", "0.33,-0.07,0.2");
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: board_images OUT chessboard|charuco|flat\n";
    return 2;
  }
  floorloc::Write(argv[1], argv[2]);
  return 0;
}
