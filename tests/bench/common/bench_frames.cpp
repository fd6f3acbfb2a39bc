// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/common/bench_frames.h"

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"

namespace floorloc {

BenchFrames BenchFrames::Read(const std::filesystem::path& folder) {
  const Survey survey = ReadSurvey(folder);
  BenchFrames set{folder.string(), Rectifier(survey.camera, survey.mask), {}, {}};
  for (const SurveyFrame& frame : survey.frames) {
    if (const std::optional<Pose2> truth = InterpolatePose(survey.ground_truth, frame.stamp_ns)) {
      set.encoded.push_back(ReadBinaryFile(survey.ImagePath(frame)));
      set.truth_from_base.push_back(*truth);
    }
  }
  if (set.encoded.empty()) {
    throw InputError(folder, "has no frame with a pose in groundtruth.tum; the benchmark needs the truth");
  }
  return set;
}

cv::Mat BenchFrames::Decode(std::size_t frame) const {
  const CameraModel& camera = rectifier.camera().camera;
  return DecodeGray(encoded[frame], camera.width_px, camera.height_px, name);
}

}  // namespace floorloc
