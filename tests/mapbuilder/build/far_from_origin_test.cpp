// SPDX-License-Identifier: Apache-2.0
// Maps in UTM or national coordinates, which float32 does not hold, are as exact as those near (0, 0).
#include <gtest/gtest.h>

#include "core/io/image.h"
#include "core/localization/localizer.h"
#include "core/map/map_database.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/merge/merge_maps.h"
#include "tests/mapbuilder/build/survey_copy.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

class FarFromOriginTest : public SurveyCopyTest {
 protected:
  FarFromOriginTest() { options_.hold_out = false; }

  // A map of the survey whose frame has the floor's corner at `corner`.
  BuildReport Build(const Pose2& corner, const fs::path& out, const fs::path& extend = {}) {
    options_.out = out;
    options_.extend = extend;
    options_.poses.clear();
    for (const StampedPose3& row : ReadSurvey(survey_).ground_truth) {
      options_.poses.push_back(StampedPose3::FromPose2(row.stamp_ns, corner * row.ToPose2()));
    }
    return BuildMap(options_);
  }

  // Localizes some survey frames in the map, without a prior and with one that is 50 mm off.
  void ExpectFound(const fs::path& map, const Pose2& corner) const {
    const MapDatabase database(map);
    const Localizer localizer(database.ReadMap(), {},
                              [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
    const Survey survey = ReadSurvey(survey_);
    const Rectifier rectifier(database.ReadInfo().camera());
    for (std::size_t i = 0; i < survey.frames.size(); i += 7) {
      const Pose2 truth = corner * InterpolatePose(survey.ground_truth, survey.frames[i].stamp_ns).value();
      const cv::Mat raw = ReadGrayImage(survey.ImagePath(survey.frames[i]), survey.camera.camera.width_px,
                                        survey.camera.camera.height_px);
      const PosePrior prior{truth * Pose2(0.03, -0.04, 0.02), 0.1, 0.1};
      for (const std::optional<PosePrior>& near : {std::optional<PosePrior>(), std::optional(prior)}) {
        const LocalizationResult found = localizer.Localize(rectifier, raw, near);
        ASSERT_EQ(found.status, LocalizationStatus::kLocalized) << i;
        EXPECT_LT(truth.Between(found.map_from_base).translation().norm(), 0.003) << i;
      }
    }
  }

  const fs::path near_ = folder_.path() / "near.floormap";
  const fs::path far_ = folder_.path() / "far.floormap";
  const fs::path both_ = folder_.path() / "both.floormap";
};

TEST_F(FarFromOriginTest, FramesAreFoundInUtmCoordinatesAlsoWhenTheMapIsExtended) {
  const Pose2 utm(691'234.567, 5'336'789.123, 0.4);
  EXPECT_EQ(Build(utm, far_).frames_used, Build(Pose2(), near_).frames_used);
  ExpectFound(far_, utm);
  Build(utm, both_, far_);
  ExpectFound(both_, utm);
}

TEST_F(FarFromOriginTest, TheSouthernHemisphereHasTheLargestNorthings) {
  const Pose2 nairobi(257'000.25, 9'857'000.75, -2.0);
  Build(nairobi, far_);
  ExpectFound(far_, nairobi);
}

TEST_F(FarFromOriginTest, MapsInDifferentPlacesAreMerged) {
  const Pose2 utm(691'234.567, 5'336'789.123, 0.4);
  Build(utm, far_);
  Build(Pose2(), near_);
  for (const bool near_first : {true, false}) {
    MergeOptions merge;
    merge.first = near_first ? near_ : far_;
    merge.second = near_first ? far_ : near_;
    merge.out = both_;
    const MergeReport report = MergeMaps(merge);
    EXPECT_GT(report.shared_keypoints, report.keypoints / 2);
    ExpectFound(both_, near_first ? Pose2() : utm);
  }
}

}  // namespace
}  // namespace floorloc
