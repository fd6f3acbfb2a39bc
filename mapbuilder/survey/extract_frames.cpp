// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/extract_frames.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/survey/frame_journal.h"

namespace floorloc {
namespace {

cv::Mat MeasureBrightness(const GroundImage& image) {
  const cv::Size cells(std::max(1, image.gray.cols / kBrightnessCellPx),
                       std::max(1, image.gray.rows / kBrightnessCellPx));
  cv::Mat mean;
  cv::Mat cell_mask;
  cv::resize(image.gray, mean, cells, 0, 0, cv::INTER_AREA);
  cv::resize(image.mask, cell_mask, cells, 0, 0, cv::INTER_AREA);
  cv::Mat brightness;
  mean.convertTo(brightness, CV_32F);
  brightness.setTo(0.0F, cell_mask < 255);  // partly masked cells are not used
  return brightness;
}

void Extract(const LoadedSurvey& from, const FeatureExtractor& extractor, BuildFrame* frame) {
  const CameraModel& camera = from.survey.camera.camera;
  const cv::Mat raw = ReadGrayImage(from.survey.ImagePath(frame->info), camera.width_px, camera.height_px);
  const GroundImage image = from.rectifier->Rectify(raw);
  frame->features = extractor.Extract(image);
  frame->brightness = MeasureBrightness(image);
  frame->quality = MeasureQuality(image);
}

}  // namespace

std::vector<LoadedSurvey> LoadSurveys(const std::vector<std::filesystem::path>& folders, BadFramePolicy bad_frames,
                                      double resolution_m) {
  std::vector<LoadedSurvey> surveys;
  for (const std::filesystem::path& folder : folders) {
    LoadedSurvey loaded{ReadSurvey(folder, bad_frames), {}, nullptr};
    FloorCamera& camera = loaded.survey.camera;
    if (resolution_m > 0.0 || !surveys.empty()) {
      camera =
          camera.AtResolution(resolution_m > 0.0 ? resolution_m : surveys.front().survey.camera.floor.resolution_m);
    }
    loaded.given_camera = camera;
    loaded.rectifier = std::make_shared<Rectifier>(camera, loaded.survey.mask);
    surveys.push_back(std::move(loaded));
  }
  return surveys;
}

void ExtractionOptions::Check() const {
  extractor.Check();
  run.Check();
}

std::vector<BuildFrame> ExtractSurveyFrames(const std::vector<LoadedSurvey>& surveys,
                                            const ExtractionOptions& options) {
  options.Check();
  std::vector<BuildFrame> frames;
  for (std::size_t s = 0; s < surveys.size(); ++s) {
    for (const SurveyFrame& info : surveys[s].survey.frames) {
      BuildFrame frame;
      frame.survey = static_cast<int>(s);
      frame.info = info;
      frame.odom_from_base = InterpolatePose(surveys[s].survey.odometry, info.stamp_ns);
      frames.push_back(std::move(frame));
    }
  }
  const auto extractor = CreateFeatureExtractor(options.extractor);
  ProgressBar progress("features", static_cast<std::int64_t>(frames.size()), options.run.progress);
  ParallelFor(static_cast<int>(frames.size()), options.run.threads, [&](int i) {
    BuildFrame& frame = frames[static_cast<std::size_t>(i)];
    if (options.journal != nullptr && options.journal->Restore(&frame)) {
      progress.Advance();
      return;
    }
    try {
      Extract(surveys[static_cast<std::size_t>(frame.survey)], *extractor, &frame);
      if (options.journal != nullptr) {
        options.journal->Store(frame);
      }
    } catch (const InputError& error) {
      if (options.bad_frames == BadFramePolicy::kThrow) {
        throw;
      }
      frame.unreadable = error.what();
    }
    progress.Advance();
  });
  return frames;
}

}  // namespace floorloc
