// SPDX-License-Identifier: Apache-2.0
// Writes the frames of a survey rectified for other stitchers: undistorted, top-down, one scale.
// rectify_frames SURVEY OUT COUNT: OUT/0000.png ... of the first COUNT frames, and OUT/truth.csv: true position of each
// image's centre in the ground truth's frame, and its position in the base frame (metres).
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/vision/image/rectifier.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

std::string ImageName(std::size_t index) {
  char name[32];
  std::snprintf(name, sizeof(name), "%04zu.png", index);
  return name;
}

void RectifyFrames(const fs::path& folder, const fs::path& out, std::size_t count) {
  const Survey survey = ReadSurvey(folder);
  const Rectifier rectifier(survey.camera, survey.mask);
  const CameraModel& camera = survey.camera.camera;
  const GroundGrid& grid = rectifier.grid();
  const Eigen::Vector2d middle = grid.BaseFromPixel(0.5 * (grid.width_px - 1), 0.5 * (grid.height_px - 1));
  fs::create_directories(out);
  std::ofstream truth(out / "truth.csv");
  truth.precision(12);
  truth << "filename,timestamp,x,y,middle_x,middle_y\n";
  for (std::size_t i = 0; i < std::min(count, survey.frames.size()); ++i) {
    const fs::path file = survey.ImagePath(survey.frames[i]);
    const cv::Mat raw = ReadColorImage(file, camera.width_px, camera.height_px);
    const fs::path image = out / ImageName(i);
    if (!cv::imwrite(image.string(), rectifier.RectifyImage(raw))) {
      throw InputError(image, "cannot be written; is the disk full?");
    }
    const auto pose = InterpolatePose(survey.ground_truth, survey.frames[i].stamp_ns);
    if (!pose) {
      throw InputError(folder / "groundtruth.tum", "does not cover every frame; the comparison needs the truth");
    }
    const Eigen::Vector2d p = *pose * middle;
    truth << image.filename().string() << "," << FormatSeconds(survey.frames[i].stamp_ns) << "," << p.x() << ","
          << p.y() << "," << middle.x() << "," << middle.y() << "\n";
  }
}

}  // namespace
}  // namespace floorloc

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: rectify_frames SURVEY OUT COUNT\n";
    return 2;
  }
  try {
    floorloc::RectifyFrames(argv[1], argv[2], std::stoul(argv[3]));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "rectify_frames: " << error.what() << "\n";
    return 1;
  }
}
