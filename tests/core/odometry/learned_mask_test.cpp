// SPDX-License-Identifier: Apache-2.0
#include "core/odometry/learned_mask.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/vision/image/rectifier.h"
#include "tests/option_test_support.h"
#include "tests/synthetic/synthetic_floor.h"

namespace floorloc {
namespace {

// A vehicle that drives in a circle over a floor, 24 views of which every two neighbours overlap by some 80 %.
class LearnedMaskTest : public testing::Test {
 protected:
  struct View {
    Pose2 map_from_base;
    cv::Mat raw;
  };
  static constexpr std::size_t kViews = 24;

  static const SyntheticFloor& Floor() {
    static const SyntheticFloor floor(1);
    return floor;
  }
  static const std::vector<View>& Views() {
    static const std::vector<View> views = [] {
      std::vector<View> rendered;
      for (std::size_t i = 0; i < kViews; ++i) {
        const double angle = 0.26 * static_cast<double>(i);
        const Pose2 pose = Floor().BaseForView(0.6 + 0.2 * std::cos(angle), 0.45 + 0.14 * std::sin(angle),
                                               0.5 * std::sin(0.4 * angle));
        rendered.push_back({pose, Gray(Floor().View(pose))});
      }
      return rendered;
    }();
    return views;
  }
  static cv::Mat Gray(const cv::Mat& image) {
    cv::Mat gray;
    cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
    return gray;
  }
  // The texture of another place of the floor.
  static cv::Mat Part(const cv::Rect& where) {
    static const cv::Mat elsewhere = Gray(Floor().View(Floor().BaseForView(0.9, 0.6, 2.0)));
    return elsewhere(where);
  }

  // Shows one view after the other; covered: by what travels with the camera.
  void Drive(const std::vector<View>& views, const cv::Rect& covered = {}) {
    for (const View& view : views) {
      cv::Mat raw = view.raw.clone();
      if (!covered.empty()) {
        Part(covered).copyTo(raw(covered));
      }
      const std::vector<Pose2> motions =
          last_ ? std::vector<Pose2>{last_->Between(view.map_from_base)} : std::vector<Pose2>{};
      if (mask_.Add(rectifier_.Rectify(raw), motions)) {
        last_ = view.map_from_base;
      }
    }
  }
  // What is left out, in the rectified image.
  cv::Mat LeftOut() const {
    cv::Mat shown;
    cv::resize(mask_.State().left_out, shown, rectifier_.mask().size(), 0, 0, cv::INTER_NEAREST);
    return shown & rectifier_.mask();
  }
  // Where a part of the raw image is in the rectified one.
  cv::Mat Rectified(const cv::Rect& part) const {
    cv::Mat raw = cv::Mat::zeros(480, 640, CV_8U);
    raw(part).setTo(255);
    return rectifier_.RectifyImage(raw) > 127;
  }
  double ShareOfView(const cv::Mat& where) const {
    return cv::countNonZero(where) / static_cast<double>(cv::countNonZero(rectifier_.mask()));
  }

  inline static const cv::Rect kPart{0, 240, 230, 240};
  Rectifier rectifier_{Floor().camera()};
  LearnedMask mask_;
  std::optional<Pose2> last_;
};

TEST_F(LearnedMaskTest, APartIsLeftOutAndNoMoreThanIt) {
  Drive(Views(), kPart);
  ASSERT_EQ(mask_.State().status, LearnedMaskStatus::kLearnt) << mask_.State().pairs << " pairs";
  const cv::Mat part = Rectified(kPart);
  EXPECT_GT(ShareOfView(LeftOut() & part), 0.8 * ShareOfView(part)) << "all but cells at its edge";
  EXPECT_LT(ShareOfView(LeftOut() & ~part), 0.02);
  EXPECT_NEAR(mask_.State().share, ShareOfView(LeftOut()), 0.02);
}

TEST_F(LearnedMaskTest, NothingOfACleanViewIsLeftOut) {
  for (int round = 0; round < 3; ++round) {
    Drive(Views());
    EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kNothing) << mask_.State().pairs << " pairs";
    EXPECT_EQ(mask_.State().share, 0.0);
  }
  EXPECT_GT(mask_.State().pairs, 30);
}

TEST_F(LearnedMaskTest, FewViewsAreLookedAtUntilOneShowsSomethingNew) {
  Drive(Views());
  Drive(Views());
  const int known = mask_.State().pairs;
  Drive(Views());
  EXPECT_LT(mask_.State().pairs, known + 5);
  Drive(Views(), kPart);
  EXPECT_GT(mask_.State().pairs, known + 10);
  Drive(Views(), kPart);
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kLearnt);
}

TEST_F(LearnedMaskTest, APlainFloorTellsNothing) {
  std::vector<View> plain = Views();
  cv::RNG noise(1);
  for (View& view : plain) {
    cv::Mat raw(view.raw.size(), CV_32F);
    noise.fill(raw, cv::RNG::NORMAL, 120.0, 3.0);
    view.raw = cv::Mat();
    raw.convertTo(view.raw, CV_8U);
  }
  Drive(plain, kPart);
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kLearning);
  EXPECT_EQ(mask_.State().pairs, 0) << "no floor was seen moving";
}

TEST_F(LearnedMaskTest, AStandingVehicleLearnsNothingWhateverItsWheelsSay) {
  std::vector<View> standing(kViews, Views()[0]);
  Drive(standing, kPart);
  for (std::size_t i = 0; i < kViews; ++i) {
    standing[i].map_from_base = Views()[i].map_from_base;  // the wheels slip
  }
  Drive(standing, kPart);
  EXPECT_EQ(mask_.State().pairs, 0);
  EXPECT_TRUE(mask_.State().left_out.empty());
}

TEST_F(LearnedMaskTest, APartThatIsGoneIsUnlearnt) {
  Drive(Views(), kPart);
  ASSERT_EQ(mask_.State().status, LearnedMaskStatus::kLearnt);
  Drive(Views());
  Drive(Views());
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kNothing) << mask_.State().share;
}

TEST_F(LearnedMaskTest, LightThatTravelsWithTheCameraIsFloor) {
  std::vector<View> lit = Views();
  for (View& view : lit) {
    cv::Mat bright;
    view.raw = view.raw.clone();
    view.raw(cv::Rect(60, 60, 200, 160)).convertTo(bright, CV_8U, 0.6);  // a shadow with sharp edges
    bright.copyTo(view.raw(cv::Rect(60, 60, 200, 160)));
  }
  Drive(lit);
  EXPECT_LT(mask_.State().share, 0.01);
}

TEST_F(LearnedMaskTest, TooMuchIsSaidAndNothingLeftOut) {
  Drive(Views(), {0, 0, 330, 480});
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kTooMuch) << mask_.State().share;
  EXPECT_GT(mask_.State().share, 0.4);
  EXPECT_TRUE(mask_.State().left_out.empty());
  EXPECT_EQ(mask_.State().LeftOutShare(), 0.0);
}

TEST_F(LearnedMaskTest, WhatIsNotToBeAppliedIsReportedOnly) {
  LearnedMaskOptions options;
  options.apply = false;
  mask_ = LearnedMask(options);
  Drive(Views(), kPart);
  EXPECT_GT(mask_.State().share, 0.05);
  EXPECT_TRUE(mask_.State().left_out.empty());
}

TEST_F(LearnedMaskTest, AnotherGoesOnWithWhatWasLearnt) {
  Drive(Views(), kPart);
  const LearnedMaskState known = mask_.State();
  const cv::Mat left_out = known.left_out.clone();
  const MaskEvidence learnt = mask_.Learnt();
  Drive(Views());
  Drive(Views());
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kNothing);
  mask_ = LearnedMask();
  mask_.Resume(learnt);
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kLearnt);
  EXPECT_EQ(mask_.State().pairs, known.pairs);
  EXPECT_EQ(mask_.State().share, known.share);
  EXPECT_EQ(cv::norm(mask_.State().left_out, left_out, cv::NORM_INF), 0.0) << "learning on did not change it";
  Drive(Views(), kPart);
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kLearnt);
  EXPECT_GT(mask_.State().pairs, known.pairs);
  Drive(Views());
  Drive(Views());
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kNothing) << "the part is gone";
}

TEST_F(LearnedMaskTest, WhatWasLearntOfAnotherViewIsForgotten) {
  Drive(Views(), kPart);
  MaskEvidence learnt = mask_.Learnt();
  learnt.grid.x_top_m += 0.02;
  mask_.Resume(learnt);
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kLearnt);
  mask_.Add(rectifier_.Rectify(Views()[0].raw), {});
  EXPECT_EQ(mask_.State().status, LearnedMaskStatus::kLearning);
  EXPECT_EQ(mask_.State().pairs, 0);
}

TEST(LearnedMaskOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<ViewCellOptions>()
      .Refuses("cells", &ViewCellOptions::cells, {7, 257})
      .Refuses("noise", &ViewCellOptions::noise, {0.0})
      .Refuses("min_moving_share", &ViewCellOptions::min_moving_share, {0.0, 1.0})
      .Refuses("min_decided_share", &ViewCellOptions::min_decided_share, {0.0, 1.0})
      .Refuses("min_correlation", &ViewCellOptions::min_correlation, {0.0, 1.0})
      .Refuses("min_lead", &ViewCellOptions::min_lead, {0.0, 1.0});
  OptionTable<LearnedMaskOptions>()
      .Refuses("min_motion", &LearnedMaskOptions::min_motion, {0.0})
      .Refuses("max_motion", &LearnedMaskOptions::max_motion, {0.05, 1.1})
      .Refuses("min_background", &LearnedMaskOptions::min_background, {0})
      .Refuses("min_pairs", &LearnedMaskOptions::min_pairs, {0})
      .Refuses("memory_pairs", &LearnedMaskOptions::memory_pairs, {1.0})
      .Refuses("min_standing", &LearnedMaskOptions::min_standing, {0.5, 1.1})
      .Refuses("min_beside", &LearnedMaskOptions::min_beside, {0.0, 0.9})
      .Refuses("max_floor", &LearnedMaskOptions::max_floor, {-0.1, 1.0})
      .Refuses("min_region_cells", &LearnedMaskOptions::min_region_cells, {0})
      .Refuses("rest_views", &LearnedMaskOptions::rest_views, {-1})
      .Refuses("news_share", &LearnedMaskOptions::news_share, {-0.1, 1.0})
      .Refuses("max_share", &LearnedMaskOptions::max_share, {0.0, 1.0});
}

}  // namespace
}  // namespace floorloc
