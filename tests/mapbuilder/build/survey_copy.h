// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

#include "mapbuilder/build/build_options.h"
#include "tests/synthetic/synthetic_floor.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {

/// A copy of a synthetic survey that each test may change, and the options to build its map.
class SurveyCopyTest : public ::testing::Test {
 protected:
  SurveyCopyTest() {
    static const TemporaryFolder recorded;
    static const bool written = SyntheticFloor(1).WriteSurvey(recorded.path() / "survey").frames > 0;
    EXPECT_TRUE(written);
    std::filesystem::copy(recorded.path() / "survey", survey_, std::filesystem::copy_options::recursive);
    options_.surveys = {survey_};
    options_.out = folder_.path() / "floor.floormap";
    options_.mosaic.resolution_m = 0.0028;
  }

  TemporaryFolder folder_;
  std::filesystem::path survey_ = folder_.path() / "survey";
  BuildOptions options_;
};

}  // namespace floorloc
