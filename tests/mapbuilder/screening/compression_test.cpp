// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/compression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A survey of images of the given JPEG qualities.
LoadedSurvey SurveyOf(const std::filesystem::path& folder, const std::vector<int>& qualities) {
  LoadedSurvey loaded;
  loaded.survey.folder = folder;
  std::filesystem::create_directories(folder / "images");
  cv::Mat image(32, 32, CV_8UC1);
  for (const int quality : qualities) {
    cv::randu(image, 0, 256);
    const std::string name = "images/" + std::to_string(loaded.survey.frames.size()) + ".jpg";
    cv::imwrite((folder / name).string(), image, {cv::IMWRITE_JPEG_QUALITY, quality});
    loaded.survey.frames.push_back({0, name});
  }
  return loaded;
}

TEST(CompressionTest, EachSurveyThatIsCompressedTooMuchIsNamed) {
  const TemporaryFolder folder;
  const FrameSet set{{SurveyOf(folder.path() / "good", {90, 90, 90}), SurveyOf(folder.path() / "poor", {20, 25, 90})},
                     {}};
  EXPECT_THAT(FindPoorCompression(set), ElementsAre(AllOf(HasSubstr("poor: "), HasSubstr("JPEG quality 25"))));
}

TEST(CompressionTest, ImagesThatCannotBeReadDoNotCount) {
  const TemporaryFolder folder;
  FrameSet set{{SurveyOf(folder.path(), {})}, {}};
  set.surveys[0].survey.frames.push_back({0, "images/missing.jpg"});
  EXPECT_THAT(FindPoorCompression(set), IsEmpty());
}

TEST(CompressionTest, BadOptionsAreRefused) {
  EXPECT_THROW(FindPoorCompression({}, {.min_jpeg_quality = 101}), std::invalid_argument);
  EXPECT_THROW(FindPoorCompression({}, {.sampled_images = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
