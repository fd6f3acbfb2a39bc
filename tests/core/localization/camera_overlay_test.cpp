// SPDX-License-Identifier: Apache-2.0
// What travels with the camera and is in the map too is never a fix, whatever the number of its keypoints.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "core/localization/localizer.h"
#include "core/map/map_database.h"
#include "mapbuilder/build/build_map.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

// A map one frame of whose survey shows a part of the robot: its keypoints are at one place of the map.
class PartInMap {
 public:
  explicit PartInMap(double share) {
    SimulateOptions survey = floor_.SurveyOptions(folder_.path() / "survey");
    Simulate(survey);
    survey.out = folder_.path() / "with-part";
    survey.conditions.overlay.share = share;
    Simulate(survey);
    fs::copy_file(survey.out / "images/000000.jpg", folder_.path() / "survey/images/000000.jpg",
                  fs::copy_options::overwrite_existing);
    BuildOptions options;
    options.surveys = {folder_.path() / "survey"};
    options.out = folder_.path() / "part.floormap";
    options.poses = ReadTum(folder_.path() / "survey" / "groundtruth.tum");
    options.hold_out = false;
    options.auto_mask.apply = false;
    BuildMap(options);
    database_ = std::make_unique<MapDatabase>(options.out);
    localizer_ = std::make_unique<Localizer>(database_->ReadMap(), LocalizerOptions(),
                                             [this](const TileId& tile) { return database_->ReadMosaicTile(tile); });
    conditions_.overlay = std::make_shared<const CameraOverlay>(
        survey.conditions.overlay, cv::Size(floor_.camera().camera.width_px, floor_.camera().camera.height_px));
  }
  const SyntheticFloor& floor() const { return floor_; }

  // A frame with the part in view.
  LocalizationResult Localize(const SyntheticFloor& floor, const Pose2& pose) const {
    cv::Mat gray;
    cv::cvtColor(floor.View(pose, conditions_), gray, cv::COLOR_BGR2GRAY);
    return localizer_->Localize(Rectifier(floor.camera()), gray, std::nullopt);
  }

 private:
  TemporaryFolder folder_;
  SyntheticFloor floor_;
  std::unique_ptr<MapDatabase> database_;
  std::unique_ptr<Localizer> localizer_;
  RenderConditions conditions_;
};

TEST(CameraOverlayTest, APartInViewOfSurveyAndVehicleIsNoFix) {
  const PartInMap map(0.3);
  const SyntheticFloor elsewhere(2);
  for (const double yaw : {0.3, 2.0, -1.4}) {
    const LocalizationResult off_the_map = map.Localize(elsewhere, elsewhere.BaseForView(0.6, 0.45, yaw));
    EXPECT_EQ(off_the_map.status, LocalizationStatus::kNotLocalized) << yaw;
    EXPECT_EQ(off_the_map.reason, NotLocalizedReason::kViewDisagrees) << yaw;
    EXPECT_GT(off_the_map.inliers, 30) << "the part's keypoints matched";
    EXPECT_GT(off_the_map.p_wrong, 0.5) << yaw;
    EXPECT_LT(off_the_map.support_area.value_or(1.0), 0.4) << yaw;
    const Pose2 truth = map.floor().BaseForView(0.7, 0.5, yaw);
    const LocalizationResult on_the_map = map.Localize(map.floor(), truth);
    EXPECT_EQ(on_the_map.status, LocalizationStatus::kLocalized) << yaw;
    EXPECT_LT(truth.Between(on_the_map.map_from_base).translation().norm(), 0.005) << yaw;
    EXPECT_NEAR(on_the_map.support_area.value_or(0.0), 0.7, 0.15) << "all but the part agrees";
  }
}

}  // namespace
}  // namespace floorloc
