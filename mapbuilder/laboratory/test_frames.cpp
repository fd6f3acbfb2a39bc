// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/laboratory/test_frames.h"

#include "core/geometry/option_check.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {

void TestFrameOptions::Check() const {
  RequireOption(skip_frames >= 0, "skip_frames must be 0 or more");
  RequireOption(max_frames >= 0, "max_frames must be 0 (all) or more");
  RequireOption(resolution_m >= 0.0 && resolution_m < 1.0, "resolution_m must be a positive number of metres below 1");
  run.Check();
}

FrameBag ReadFrameBag(const std::filesystem::path& folder, const TestFrameOptions& options) {
  options.Check();
  const Survey survey = ReadSurvey(folder);
  const Rectifier rectifier(survey.camera.AtResolution(options.resolution_m), survey.mask);
  FrameBag bag;
  bag.name = FolderName(folder);
  int with_truth = 0;
  for (const SurveyFrame& frame : survey.frames) {
    const std::optional<Pose2> truth = InterpolatePose(survey.ground_truth, frame.stamp_ns);
    const bool wanted = options.max_frames == 0 || static_cast<int>(bag.frames.size()) < options.max_frames;
    if (truth && ++with_truth > options.skip_frames && wanted) {
      bag.frames.push_back({frame.filename, {}, *truth, InterpolatePose(survey.odometry, frame.stamp_ns)});
    }
  }
  if (bag.frames.empty()) {
    throw InputError(folder, "has no frame with a pose in groundtruth.tum" +
                                 std::string(options.skip_frames > 0 ? " after those that are skipped" : "") +
                                 "; the laboratory needs the truth");
  }
  const CameraModel& camera = survey.camera.camera;
  ParallelFor(static_cast<int>(bag.frames.size()), options.run.threads, [&](int i) {
    TestFrame& frame = bag.frames[static_cast<std::size_t>(i)];
    const cv::Mat raw = ReadGrayImage(folder / frame.filename, camera.width_px, camera.height_px);
    const FloorImage image = FloorImage::FromGround(rectifier.Rectify(raw));
    frame.image = options.normalize ? Normalized(image) : image;
  });
  return bag;
}

}  // namespace floorloc
