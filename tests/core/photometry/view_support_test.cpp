// SPDX-License-Identifier: Apache-2.0
#include "core/photometry/view_support.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace floorloc {
namespace {

constexpr int kCells = 130;  // of a frame of 0.31 x 0.415 m

// Views of cells that agree, the first ones, and of cells that show different floor.
class ViewSupportTest : public ::testing::Test {
 protected:
  std::vector<float> View(double agreeing_share, float correlation, int cells = kCells) {
    std::vector<float> view;
    for (int i = 0; i < cells; ++i) {
      const bool agrees = i < agreeing_share * cells;
      view.push_back(agrees ? correlation + 0.3F * noise_(random_) : noise_(random_));
    }
    return view;
  }
  static ViewSupport Measure(const std::vector<float>& view) { return MeasureViewSupport(view, ViewModel()); }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<float> noise_{0.0F, 0.15F};
};

TEST_F(ViewSupportTest, FloorThatAgreesEverywhereIsCertain) {
  const ViewSupport support = Measure(View(1.0, 0.8F));
  EXPECT_GT(support.area, 0.95);
  EXPECT_LT(support.LocalProbability(), 1e-12);
}

TEST_F(ViewSupportTest, APartThatAgreesAloneIsNoPlaceHoweverWell) {
  for (const double part : {0.05, 0.13, 0.3, 0.35}) {
    const ViewSupport support = Measure(View(part, 0.95F));
    EXPECT_NEAR(support.area, part, 0.07);
    EXPECT_GT(support.LocalProbability(), 0.95) << part;
  }
}

TEST_F(ViewSupportTest, APartThatContradictsOnAgreeingFloorIsFine) {
  for (const double part : {0.05, 0.13, 0.3, 0.5}) {
    const ViewSupport support = Measure(View(1.0 - part, 0.6F));
    EXPECT_NEAR(support.area, 1.0 - part, 0.1);
    EXPECT_LT(support.LocalProbability(), 1e-4) << part;
  }
}

// Blur and noise lower the correlation of all cells: the best ones say what can be expected of the others.
TEST_F(ViewSupportTest, WeakAgreementEverywhereIsStillAgreement) {
  EXPECT_LT(Measure(View(1.0, 0.25F)).LocalProbability(), 1e-6);
}

TEST_F(ViewSupportTest, ChanceIsNoSupport) {
  const ViewSupport support = Measure(View(0.0, 0.0F));
  EXPECT_LT(support.area, 0.1);
  EXPECT_GT(support.LocalProbability(), 0.9);
}

TEST_F(ViewSupportTest, AHandfulOfCellsBeyondWhichTheMapEndsDecidesToo) {
  EXPECT_LT(Measure(View(1.0, 0.8F, 8)).LocalProbability(), 1e-4);
  EXPECT_GT(Measure(View(0.3, 0.9F, 8)).LocalProbability(), 0.5);
}

TEST_F(ViewSupportTest, ExtremesStayFinite) {
  for (const float correlation : {-1.0F, 0.0F, 1.0F}) {
    const ViewSupport support = Measure(std::vector<float>(5000, correlation));
    EXPECT_TRUE(support.log10_odds > -1000.0 && support.log10_odds < 1000.0) << correlation;
    EXPECT_TRUE(support.area >= 0.0 && support.area <= 1.0) << correlation;
  }
  const ViewSupport one = Measure({0.9F});
  EXPECT_GT(one.LocalProbability(), 1e-9) << "one cell is little evidence";
}

}  // namespace
}  // namespace floorloc
