// SPDX-License-Identifier: Apache-2.0
// Speed and repeatability of features: ours, dlib's and OpenCV's. Usage: surf_benchmark IMAGE...
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <opencv2/imgcodecs.hpp>

#include "tests/bench/features/feature_method.h"
#include "tests/bench/features/feature_score.h"
#include "tests/bench/features/image_change.h"

namespace floorloc {
namespace {

constexpr int kMaxKeypoints = 1000;
constexpr int kRepetitions = 11;

struct Row {
  std::string name;
  double median_ms = 0.0;
  double keypoints = 0.0;  // per image
  std::vector<FeatureScore> scores;
};

// CPU time of this thread, less sensitive to other load than wall time.
double ThreadMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Reads grey images, cropped to the central 640 x 480 pixels.
std::vector<cv::Mat> ReadImages(int count, char** names) {
  std::vector<cv::Mat> images;
  for (int i = 0; i < count; ++i) {
    const cv::Mat image = cv::imread(names[i], cv::IMREAD_GRAYSCALE);
    if (image.cols < 640 || image.rows < 480) {
      std::fprintf(stderr, "surf_benchmark: %s is no image of at least 640 x 480 pixels\n", names[i]);
      continue;
    }
    images.push_back(image(cv::Rect((image.cols - 640) / 2, (image.rows - 480) / 2, 640, 480)).clone());
  }
  return images;
}

Row Measure(const FeatureMethod& method, const std::vector<cv::Mat>& images) {
  Row row{.name = method.name, .scores = {}};
  std::vector<double> times_ms;
  const std::vector<ImageChange> changes = ImageChanges();
  row.scores.resize(changes.size());
  for (const cv::Mat& image : images) {
    ImageFeatures features;
    for (int i = 0; i < kRepetitions; ++i) {
      const double start_ms = ThreadMs();
      features = method.extract(image);
      times_ms.push_back(ThreadMs() - start_ms);
    }
    row.keypoints += static_cast<double>(features.keypoints.size()) / static_cast<double>(images.size());
    for (std::size_t i = 0; i < changes.size(); ++i) {
      const ImageFeatures after = method.extract(Apply(changes[i], image));
      row.scores[i].Add(ScoreFeatures(features, after, changes[i].motion(image.size()), image.size()));
    }
  }
  row.median_ms = Median(times_ms);
  return row;
}

void PrintScores(const char* title, const std::vector<Row>& rows, double (FeatureScore::*value)() const) {
  std::printf("\n%-14s", title);
  for (const ImageChange& change : ImageChanges()) {
    std::printf("%10s", change.name.c_str());
  }
  std::printf("%10s\n", "mean");
  for (const Row& row : rows) {
    std::printf("%-14s", row.name.c_str());
    double sum = 0.0;
    for (const FeatureScore& score : row.scores) {
      std::printf("%9.1f%%", 100.0 * (score.*value)());
      sum += (score.*value)() / static_cast<double>(row.scores.size());
    }
    std::printf("%9.1f%%\n", 100.0 * sum);
  }
}

void PrintSpeeds(const std::vector<Row>& rows, const Row& reference) {
  std::printf("\n%-14s%10s%10s%16s%22s\n", "speed", "ms", "keypoints", "us/keypoint", "times dlib's speed");
  for (const Row& row : rows) {
    const double us_per_keypoint = 1000.0 * row.median_ms / row.keypoints;
    std::printf("%-14s%10.2f%10.0f%16.2f%22.1f\n", row.name.c_str(), row.median_ms, row.keypoints, us_per_keypoint,
                reference.median_ms / row.median_ms);
  }
}

int Run(int count, char** names) {
  cv::setNumThreads(1);
  const std::vector<cv::Mat> images = ReadImages(count, names);
  if (images.empty()) {
    std::fprintf(stderr, "usage: surf_benchmark IMAGE...\n");
    return 2;
  }
  std::vector<Row> rows;
  for (const FeatureMethod& method : ComparedMethods(kMaxKeypoints)) {
    rows.push_back(Measure(method, images));
  }
  std::printf(
      "%zu images of 640 x 480 pixels, one thread, the strongest %d keypoints of each, threshold 1 for SURF.\n"
      "'surf as dlib' looks where dlib does: 4 octaves of 4 scales, first samples 2 px apart.\n",
      images.size(), kMaxKeypoints);
  PrintSpeeds(rows, rows[1]);
  PrintScores("repeatability", rows, &FeatureScore::repeatability);
  PrintScores("matching score", rows, &FeatureScore::matching_score);
  return 0;
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) { return floorloc::Run(argc - 1, argv + 1); }
