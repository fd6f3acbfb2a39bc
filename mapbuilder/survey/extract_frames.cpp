// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/extract_frames.h"

#include <memory>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/survey/frame_journal.h"
#include "mapbuilder/survey/readout_motion.h"
#include "mapbuilder/survey/survey_texture.h"

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
  const GroundImage image = from.rectifier->Rectify(raw, frame->readout_motion);
  frame->features = extractor.Extract(image);
  frame->brightness = MeasureBrightness(image);
  frame->quality = MeasureQuality(image);
  frame->texture = SampleBlockTextures(image);
}

// Reads, or restores, the features of all frames or of some.
class Extraction {
 public:
  Extraction(const std::vector<LoadedSurvey>& surveys, const ExtractionOptions& options)
      : surveys_(surveys), options_(options), extractor_(CreateFeatureExtractor(options.extractor)) {}

  void Run(const std::vector<int>& some, std::vector<BuildFrame>* frames) const {
    ProgressBar progress("features", static_cast<std::int64_t>(some.size()), options_.run.progress);
    ParallelFor(static_cast<int>(some.size()), options_.run.threads, [&](int i) {
      RunOne(&(*frames)[static_cast<std::size_t>(some[static_cast<std::size_t>(i)])]);
      progress.Advance();
    });
  }

 private:
  void RunOne(BuildFrame* frame) const {
    if (options_.journal != nullptr && options_.journal->Restore(frame)) {
      return;
    }
    try {
      Extract(surveys_[static_cast<std::size_t>(frame->survey)], *extractor_, frame);
      if (options_.journal != nullptr) {
        options_.journal->Store(*frame);
      }
    } catch (const InputError& error) {
      if (options_.bad_frames == BadFramePolicy::kThrow) {
        throw;
      }
      frame->unreadable = error.what();
    }
  }

  const std::vector<LoadedSurvey>& surveys_;
  const ExtractionOptions& options_;
  std::unique_ptr<FeatureExtractor> extractor_;
};

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
      frame.readout_motion = ReadoutMotionByOdometry(surveys[s].survey, info);
      frames.push_back(std::move(frame));
    }
  }
  std::vector<int> all(frames.size());
  std::iota(all.begin(), all.end(), 0);
  Extraction(surveys, options).Run(all, &frames);
  ExtractionOptions again = options;
  again.journal = nullptr;  // it counts frames once
  for (std::size_t s = 0; s < surveys.size(); ++s) {
    if (NeedsMotionByImages(surveys[s].survey)) {
      Extraction(surveys, again).Run(SetReadoutMotionByImages(surveys[s], static_cast<int>(s), &frames), &frames);
    }
  }
  return frames;
}

}  // namespace floorloc
