// SPDX-License-Identifier: Apache-2.0
#include "core/vision/extractors/feature_extractor.h"
#include "core/vision/freak_star/freak.h"
#include "core/vision/freak_star/star.h"
#include "core/vision/image/contrast.h"
#include "core/vision/matching/descriptor_index.h"
#include "core/vision/surf/surf.h"
#include "tests/option_test_support.h"

namespace floorloc {
namespace {

TEST(VisionOptionsTest, EachBadFieldIsRefusedByName) {
  OptionTable<ContrastOptions>()
      .Refuses("radius_px", &ContrastOptions::radius_px, {-1, 513})
      .Refuses("smooth_sigma_px", &ContrastOptions::smooth_sigma_px, {-0.1, 21.0});
  OptionTable<IndexOptions>()
      .Refuses("trees", &IndexOptions::trees, {0, 65})
      .Refuses("checks", &IndexOptions::checks, {0, 1000001})
      .Refuses("probes", &IndexOptions::probes, {0, kMaxProbes + 1});
  OptionTable<ExtractorOptions>()
      .Refuses("max_keypoints", &ExtractorOptions::max_keypoints, {9, 100001})
      .Refuses("cell_px", &ExtractorOptions::cell_px, {3})
      .Refuses("levels", &ExtractorOptions::levels, {0, 9})
      .Refuses("scale_factor", &ExtractorOptions::scale_factor, {1.0})
      .Refuses("threshold", &ExtractorOptions::threshold, {-1.0, 256.0})
      .Refuses("normalize_radius_px", &ExtractorOptions::normalize_radius_px, {-1})
      .Refuses("smooth_sigma_px", &ExtractorOptions::smooth_sigma_px, {-1.0});
  OptionTable<FreakOptions>().Refuses("reach_per_size", &FreakOptions::reach_per_size, {0.0});
  OptionTable<StarOptions>()
      .Refuses("threshold", &StarOptions::threshold, {-1.0})
      .Refuses("max_size_px", &StarOptions::max_size_px, {16})
      .Refuses("line_ratio", &StarOptions::line_ratio, {0.5})
      .Refuses("max_keypoints", &StarOptions::max_keypoints, {-1});
  OptionTable<SurfOptions>()
      .Refuses("threshold", &SurfOptions::threshold, {-1.0})
      .Refuses("octaves", &SurfOptions::octaves, {0})
      .Refuses("layers", &SurfOptions::layers, {0})
      .Refuses("first_step_px", &SurfOptions::first_step_px, {3})
      .Refuses("max_keypoints", &SurfOptions::max_keypoints, {-1});
}

TEST(VisionOptionsTest, TheyAreCheckedWhereTheyAreUsed) {
  const cv::Mat gray(40, 40, CV_8UC1, cv::Scalar(90));
  EXPECT_THROW(NormalizeContrast(gray, gray, {-1, 1.0}), std::invalid_argument);
  IndexOptions index;
  index.probes = 0;
  EXPECT_THROW(CreateDescriptorIndex(cv::Mat(10, 32, CV_8UC1, cv::Scalar(0)), index), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
