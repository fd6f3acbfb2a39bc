// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/plot/plot_trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

// A drive along a circle with an error growing from 0 to 10 mm.
ErrorPlot Drive(int count) {
  ErrorPlot plot{"ape of a circle", "mm", {}, {}};
  for (int i = 0; i < count; ++i) {
    const double angle = 6.0 * i / count;
    const Eigen::Vector2d on_circle(std::cos(angle), std::sin(angle));
    plot.reference_m.push_back(on_circle);
    plot.samples.push_back({1000.0 + i, 1.01 * on_circle, 10.0 * i / count});
  }
  return plot;
}

int CountColor(const cv::Mat& image, const cv::Vec3b& color) {
  int count = 0;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      count += image.at<cv::Vec3b>(v, u) == color ? 1 : 0;
    }
  }
  return count;
}

TEST(ErrorPlot, ShowsTheWholeRangeOfColours) {
  const cv::Mat image = DrawErrorPlot(Drive(200));
  ASSERT_EQ(image.type(), CV_8UC3);
  EXPECT_GT(CountColor(image, {59, 18, 48}), 50) << "no error: the dark blue end of the colours";
  EXPECT_GT(CountColor(image, {3, 4, 122}), 50) << "largest errors: the dark red end";
  EXPECT_GT(CountColor(image, {190, 190, 190}), 200) << "the reference";
}

TEST(ErrorPlot, MarksTheStatistics) {
  const cv::Mat image = DrawErrorPlot(Drive(200));
  EXPECT_GT(CountColor(image, {40, 40, 200}), 400) << "rmse, a line across the time";
  EXPECT_GT(CountColor(image, {40, 130, 40}), 300) << "median, partly covered by the mean";
}

TEST(ErrorPlot, DrawsDegenerateDrives) {
  EXPECT_FALSE(DrawErrorPlot(Drive(1)).empty());
  ErrorPlot standing = Drive(3);
  for (ErrorSample& sample : standing.samples) {
    sample = {1.0, {5, 5}, 0.0};
  }
  EXPECT_FALSE(DrawErrorPlot(standing).empty());
}

TEST(ErrorPlot, WritesAPng) {
  const std::filesystem::path file = std::filesystem::path(::testing::TempDir()) / "floorloc_plot_test.png";
  WriteErrorPlot(file, Drive(20));
  const std::optional<ImageHeader> header = ProbeImage(ReadBinaryFile(file));
  ASSERT_TRUE(header.has_value());
  EXPECT_EQ(header->format, ImageFormat::kPng);
  std::filesystem::remove(file);
  EXPECT_THROW(WriteErrorPlot("/nonexistent/plot.png", Drive(20)), InputError);
}

}  // namespace
}  // namespace floorloc
