// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/mosaic/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "mapbuilder/coverage/coverage.h"
#include "mapbuilder/mosaic/mosaic.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

// Surveys of one floor in uneven light, at their true poses; all pairs of frames with large overlap are linked.
class ExposureTest : public ::testing::Test {
 protected:
  void Record(const ConditionLevels& conditions, std::uint64_t seed) {
    SimulateOptions options = SyntheticFloor(1).SurveyOptions(folder_.path() / std::to_string(surveys_.size()));
    options.conditions = conditions;
    options.seed = seed;
    Simulate(options);
    texture_ = MakeFloorTexture(options.floor);
    const Survey survey = ReadSurvey(options.out);
    surveys_.push_back({survey, survey.camera, std::make_shared<Rectifier>(survey.camera)});
    for (const SurveyFrame& info : survey.frames) {
      frames_.emplace_back();
      frames_.back().survey = static_cast<int>(surveys_.size()) - 1;
      frames_.back().info = info;
      poses_.push_back(InterpolatePose(survey.ground_truth, info.stamp_ns));
    }
  }

  Exposure Estimate(const MosaicBackground& background = nullptr) {
    const Eigen::Vector2d center = surveys_.front().survey.camera.floor.roi.Center();
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      for (std::size_t j = i + 1; j < poses_.size(); ++j) {
        if ((*poses_[i] * center - *poses_[j] * center).norm() < 0.25) {
          links_.push_back({static_cast<int>(i), static_cast<int>(j), poses_[i]->Between(*poses_[j])});
        }
      }
    }
    return EstimateExposure({frames_, surveys_, links_, poses_, background});
  }

  Exposure NoExposure() const {
    Exposure exposure;
    exposure.frame_gain.assign(frames_.size(), 1.0);
    for (const LoadedSurvey& survey : surveys_) {
      exposure.flat_field.emplace_back(survey.rectifier->mask().size(), CV_32F, cv::Scalar(1.0));
    }
    return exposure;
  }

  cv::Mat Mosaic(const Exposure& exposure) const {
    const RectM roi = surveys_.front().survey.camera.floor.roi;
    const RectM extent = CoverageGrid(poses_, std::vector<RectM>(poses_.size(), roi)).Extent();
    MosaicOptions options;
    options.resolution_m = kPixelM;
    options.tile_px = 512;
    cv::Mat mosaic;
    ComposeMosaic({frames_, surveys_, poses_, exposure, extent}, MakeMosaicLayout({0.0, 1.2, 0.0, 0.9}, options),
                  options, [&](const std::vector<MosaicTile>& tiles) {
                    for (const MosaicTile& tile : tiles) {
                      if (tile.id.x == 0 && tile.id.y == 0) {
                        mosaic = cv::imdecode(tile.jpeg, cv::IMREAD_COLOR);
                      }
                    }
                  });
    return mosaic;
  }

  // Remaining light: log ratio of the smoothed mosaic to the smoothed floor, per channel.
  std::vector<cv::Vec3f> LightLeft(const cv::Mat& mosaic) const {
    cv::Mat soft_mosaic;
    cv::Mat soft_floor;
    cv::blur(mosaic, soft_mosaic, cv::Size(11, 11));
    const double px = kPixelM / texture_.resolution_m;
    cv::blur(texture_.bgr, soft_floor, cv::Size(static_cast<int>(11 * px), static_cast<int>(11 * px)));
    std::vector<cv::Vec3f> left;
    for (double y = 0.08; y < 0.82; y += 0.02) {
      for (double x = 0.08; x < 1.12; x += 0.02) {
        const Eigen::Vector2d p = texture_.PixelFromMap({x, y});
        const auto& floor = soft_floor.at<cv::Vec3b>(static_cast<int>(p.y()), static_cast<int>(p.x()));
        const auto& valid =
            soft_mosaic.at<cv::Vec3b>(mosaic.rows - 1 - static_cast<int>(y / kPixelM), static_cast<int>(x / kPixelM));
        cv::Vec3f ratio;
        for (int c = 0; c < 3; ++c) {
          ratio[c] = std::log(static_cast<float>(std::max<int>(valid[c], 1)) / static_cast<float>(floor[c]));
        }
        left.push_back(ratio);
      }
    }
    return left;
  }

  // Standard deviations over the floor of the brightness and of the difference of blue and red.
  static std::pair<double, double> Spread(const std::vector<cv::Vec3f>& left) {
    cv::Scalar mean;
    cv::Scalar brightness;
    cv::Scalar tint;
    std::vector<float> sums;
    std::vector<float> differences;
    for (const cv::Vec3f& ratio : left) {
      sums.push_back((ratio[0] + ratio[1] + ratio[2]) / 3.0F);
      differences.push_back(ratio[0] - ratio[2]);
    }
    cv::meanStdDev(sums, mean, brightness);
    cv::meanStdDev(differences, mean, tint);
    return {brightness[0], tint[0]};
  }

  static constexpr double kPixelM = 0.0028;
  TemporaryFolder folder_;
  FloorTexture texture_;
  std::vector<LoadedSurvey> surveys_;
  std::vector<BuildFrame> frames_;
  std::vector<std::optional<Pose2>> poses_;
  std::vector<Link> links_;
};

ConditionLevels BadExposure() {
  ConditionLevels levels;
  levels.gain = 0.3;
  levels.white_balance = 0.1;
  levels.vignetting = 0.4;
  levels.light_gradient = 0.15;
  return levels;
}

TEST_F(ExposureTest, TheMosaicIsFreeOfIllumination) {
  Record(BadExposure(), 3);
  const auto before = Spread(LightLeft(Mosaic(NoExposure())));
  const auto after = Spread(LightLeft(Mosaic(Estimate())));
  EXPECT_GT(before.first, 0.1) << "the light is not bad";
  EXPECT_GT(before.second, 0.03) << "the light is not bad";
  EXPECT_LT(after.first, 0.03);
  EXPECT_LT(after.second, 0.012);
}

TEST_F(ExposureTest, AShadowThatFewFramesSeeFades) {
  Record(ConditionLevels(), 3);
  for (std::size_t i = 0; i < frames_.size(); i += 3) {
    const std::string file = surveys_[0].survey.ImagePath(frames_[i].info).string();
    cv::Mat image = cv::imread(file);
    cv::Mat third = image.colRange(i % 2 == 0 ? 0 : 430, i % 2 == 0 ? 210 : 640);
    third *= 0.6;
    cv::imwrite(file, image);
  }
  const auto before = Spread(LightLeft(Mosaic(NoExposure())));
  const auto after = Spread(LightLeft(Mosaic(Estimate())));
  EXPECT_GT(before.first, 0.06) << "the shadow is not dark";
  EXPECT_LT(after.first, 0.75 * before.first) << before.first;
}

TEST_F(ExposureTest, CamerasOfDifferentExposureMakeOneFloor) {
  Record(ConditionLevels(), 3);
  Record(ConditionLevels(), 4);
  for (const SurveyFrame& info : surveys_[1].survey.frames) {
    const std::string file = surveys_[1].survey.ImagePath(info).string();
    cv::imwrite(file, cv::imread(file) * 0.6);
  }
  const Exposure exposure = Estimate();
  double log_ratio = 0.0;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    log_ratio += (frames_[i].survey == 1 ? 1.0 : -1.0) * std::log(exposure.frame_gain[i]) /
                 static_cast<double>(surveys_[0].survey.frames.size());
  }
  EXPECT_NEAR(log_ratio, -std::log(0.6), 0.03);
  EXPECT_LT(Spread(LightLeft(Mosaic(exposure))).first, 0.02);
}

TEST_F(ExposureTest, FramesTakeOnTheExposureOfTheBackground) {
  Record(BadExposure(), 3);
  // The light is known in the west only and is propagated to the east by the links.
  const Exposure exposure = Estimate([this](const RectM& square, int side_px) {
    MosaicPatch patch = MosaicPatch::Empty(side_px);
    cv::Mat soft;
    cv::blur(texture_.bgr, soft, cv::Size(25, 25));
    for (int v = 0; v < side_px; ++v) {
      for (int u = 0; u < side_px; ++u) {
        const double step = square.width_m() / side_px;
        const Eigen::Vector2d p(square.x_min + (u + 0.5) * step, square.y_max - (v + 0.5) * step);
        const Eigen::Vector2d px = texture_.PixelFromMap(p);
        const cv::Rect inside(cv::Point(), soft.size());
        const cv::Point at(static_cast<int>(px.x()), static_cast<int>(px.y()));
        if (p.x() < 0.6 && inside.contains(at)) {
          patch.bgr.at<cv::Vec3b>(v, u) = soft.at<cv::Vec3b>(at) * 0.7;
          patch.valid.at<std::uint8_t>(v, u) = 255;
        }
      }
    }
    return patch;
  });
  const std::vector<cv::Vec3f> left = LightLeft(Mosaic(exposure));
  const cv::Vec3f mean =
      std::accumulate(left.begin(), left.end(), cv::Vec3f(0.0F, 0.0F, 0.0F)) / static_cast<float>(left.size());
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], std::log(0.7), 0.04) << c;
  }
}

}  // namespace
}  // namespace floorloc
