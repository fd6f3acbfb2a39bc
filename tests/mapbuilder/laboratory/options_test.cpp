// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/experiment.h"
#include "mapbuilder/laboratory/feature_measurements.h"
#include "mapbuilder/laboratory/template_search.h"
#include "mapbuilder/laboratory/whole_floor.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(LaboratoryOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<CopyOptions>()
      .Refuses("features", &CopyOptions::features, {0})
      .Refuses("right_radius_px", &CopyOptions::right_radius_px, {0.0});
  OptionTable<DetectionOptions>()
      .Refuses("keypoints_per_m2", &DetectionOptions::keypoints_per_m2, {-1.0})
      .Refuses("max_keypoints", &DetectionOptions::max_keypoints, {0});
  OptionTable<PoseFromMatchesOptions>()
      .Refuses("max_ratio", &PoseFromMatchesOptions::max_ratio, {0.0, 1.1})
      .Refuses("inlier_radius_m", &PoseFromMatchesOptions::inlier_radius_m, {0.0})
      .Refuses("max_scale_error", &PoseFromMatchesOptions::max_scale_error, {0.0, 1.0});
  OptionTable<TemplateSearchOptions>()
      .Refuses("max_map_pixels", &TemplateSearchOptions::max_map_pixels, {0})
      .Refuses("headings", &TemplateSearchOptions::headings, {0})
      .Refuses("max_frames", &TemplateSearchOptions::max_frames, {0})
      .RefusesBadRun();
  OptionTable<TestFrameOptions>()
      .Refuses("skip_frames", &TestFrameOptions::skip_frames, {-1})
      .Refuses("max_frames", &TestFrameOptions::max_frames, {-1})
      .Refuses("resolution_m", &TestFrameOptions::resolution_m, {-1.0})
      .RefusesBadRun();
  OptionTable<ExperimentOptions>()
      .Refuses("repeat_radius_m", &ExperimentOptions::repeat_radius_m, {0.0})
      .RefusesBadRun();
}

}  // namespace
}  // namespace floorloc
