// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/fiducials/board_detection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/synthetic/board_renderer.h"

namespace floorloc {
namespace {

const Board kChessboard{9, 6, 0.02, {}};
const Board kCharuco{8, 5, 0.03, CharucoPattern{"DICT_5X5_100", 0.021}};

class BoardDetection : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { renderer_ = new BoardRenderer(MakeBoardCamera()); }
  static void TearDownTestSuite() { delete renderer_; }

  // Largest error of the detected corners in a sharp, small image; infinite when corners are missing or the board is
  // not found.
  static double WorstErrorPx(const PrintedBoard& print, const Board& board, const BoardPlacement& placement) {
    const CameraModel camera = MakeBoardCamera();
    const Eigen::Isometry3d pose = PlaceBoard(camera, board, placement);
    const std::optional<BoardView> view = DetectBoard(renderer_->Render(print, pose), board);
    const BoardView truth = ProjectBoard(camera, board, pose, 0.0, 1);
    if (!view || view->corners != truth.corners) {
      return std::numeric_limits<double>::infinity();
    }
    double worst = 0.0;
    for (std::size_t i = 0; i < truth.raw_px.size(); ++i) {
      worst = std::max(worst, (view->raw_px[i] - truth.raw_px[i]).norm());
    }
    return worst;
  }

  static BoardRenderer* renderer_;
};

BoardRenderer* BoardDetection::renderer_ = nullptr;

TEST_F(BoardDetection, NumbersTheCornersOfAChessboardFromTheBlackSideHoweverItIsTurned) {
  const PrintedBoard print = PrintChessboard(kChessboard);
  for (const double turn : {0.0, 1.2, 2.0, 3.1, -2.2, -1.0}) {
    EXPECT_LT(WorstErrorPx(print, kChessboard, {{240, 180}, 0.4, 0.3, -0.2, turn}), 0.3) << "turn " << turn;
  }
}

TEST_F(BoardDetection, TakesTheBoardInEitherOrientation) {
  const Board upright{6, 9, 0.02, {}};
  for (const double turn : {0.0, 3.1}) {
    EXPECT_LT(WorstErrorPx(PrintChessboard(upright), upright, {{240, 180}, 0.45, 0.2, 0.2, turn}), 0.3);
  }
}

TEST_F(BoardDetection, NumbersTheCornersOfACharucoBoardUpToOpenCv46AndSince) {
  for (const bool black_first : {false, true}) {
    const PrintedBoard print = PrintCharuco(kCharuco, black_first);
    for (const double turn : {0.0, 1.5, 3.1, -1.6}) {
      EXPECT_LT(WorstErrorPx(print, kCharuco, {{240, 180}, 0.55, 0.3, 0.2, turn}), 0.4)
          << "black first " << black_first << ", turn " << turn;
    }
  }
}

TEST_F(BoardDetection, KnowsAPartOfACharucoBoard) {
  const CameraModel camera = MakeBoardCamera();
  const Eigen::Isometry3d pose = PlaceBoard(camera, kCharuco, {{20, 60}, 0.4, 0.1, 0.2, 0.3});
  const auto view = DetectBoard(renderer_->Render(PrintCharuco(kCharuco, false), pose), kCharuco);
  ASSERT_TRUE(view.has_value());
  EXPECT_GE(view->corners.size(), 6u);
  EXPECT_LT(view->corners.size(), 40u);
  for (std::size_t i = 0; i < view->corners.size(); ++i) {
    const Eigen::Vector2d corner = kCharuco.Corner(view->corners[i]);
    const Eigen::Vector3d p = pose * Eigen::Vector3d(corner.x(), corner.y(), 0.0);
    const Eigen::Vector2d px =
        camera.Distort({camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy});
    EXPECT_LT((view->raw_px[i] - px).norm(), 0.6) << "corner " << view->corners[i];
  }
}

TEST_F(BoardDetection, FindsNoBoardWhereThereIsNoneOrAnotherOne) {
  EXPECT_FALSE(DetectBoard(cv::Mat(360, 480, CV_8UC1, cv::Scalar(128)), kChessboard));
  EXPECT_FALSE(DetectBoard(cv::Mat(360, 480, CV_8UC1, cv::Scalar(128)), kCharuco));
  const Eigen::Isometry3d pose = PlaceBoard(MakeBoardCamera(), kChessboard, {{240, 180}, 0.4, 0, 0, 0});
  const cv::Mat image = renderer_->Render(PrintChessboard(kChessboard), pose);
  EXPECT_FALSE(DetectBoard(image, Board{8, 7, 0.02, {}}));
  EXPECT_FALSE(DetectBoard(image, kCharuco));
}

TEST(Board, SaysWhatMakesNoSense) {
  const auto check = [](const Board& board) { board.Check(); };
  EXPECT_NO_THROW(check(kChessboard));
  EXPECT_NO_THROW(check(kCharuco));
  EXPECT_THROW(check({2, 6, 0.02, {}}), std::invalid_argument);
  EXPECT_THROW(check({9, 6, 20.0, {}}), std::invalid_argument);  // given in millimetres
  EXPECT_THROW(check({9, 6, 0.0, {}}), std::invalid_argument);
  EXPECT_THROW(check({8, 5, 0.03, CharucoPattern{"DICT_5X5_100", 0.04}}), std::invalid_argument);
  EXPECT_THROW(check({8, 5, 0.03, CharucoPattern{"DICT_9X9", 0.02}}), std::invalid_argument);
  EXPECT_THROW(check({20, 20, 0.03, CharucoPattern{"DICT_4X4_50", 0.02}}), std::invalid_argument);
}

TEST(Board, KnowsWhetherHalfATurnShows) {
  EXPECT_TRUE((Board{9, 6, 0.02, {}}).HasUniqueOrigin());
  EXPECT_FALSE((Board{9, 7, 0.02, {}}).HasUniqueOrigin());
  EXPECT_FALSE((Board{8, 6, 0.02, {}}).HasUniqueOrigin());
  EXPECT_TRUE((Board{8, 6, 0.03, CharucoPattern{"DICT_4X4_50", 0.02}}).HasUniqueOrigin());
}

}  // namespace
}  // namespace floorloc
