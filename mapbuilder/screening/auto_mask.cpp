// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/auto_mask.h"

#include <algorithm>
#include <map>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/io/camera_mask.h"
#include "core/io/image.h"
#include "core/io/input_error.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// Usable frames of a survey, by time.
std::vector<int> FramesOf(const FrameSet& set, int survey) {
  std::vector<int> order;
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    if (set.frames[i].survey == survey && set.frames[i].unreadable.empty()) {
      order.push_back(static_cast<int>(i));
    }
  }
  return order;
}

// Images that cannot be read any more are left out: the stages that need them say so.
std::vector<MovedImages> ReadImages(const FrameSet& set, const std::vector<MovingPair>& pairs, int threads) {
  std::map<int, cv::Mat> images;
  for (const MovingPair& pair : pairs) {
    images[pair.first];
    images[pair.second];
  }
  std::vector<std::pair<const int, cv::Mat>*> entries;
  for (auto& entry : images) {
    entries.push_back(&entry);
  }
  ParallelFor(static_cast<int>(entries.size()), threads, [&](int i) {
    auto& [index, image] = *entries[static_cast<std::size_t>(i)];
    const BuildFrame& frame = set.frames[static_cast<std::size_t>(index)];
    const Survey& survey = set.surveys[static_cast<std::size_t>(frame.survey)].survey;
    const CameraModel& camera = survey.camera.camera;
    try {
      image = ReadGrayImage(survey.ImagePath(frame.info), camera.width_px, camera.height_px);
    } catch (const InputError&) {
      image = cv::Mat();
    }
  });
  std::vector<MovedImages> moved;
  for (const MovingPair& pair : pairs) {
    if (!images[pair.first].empty() && !images[pair.second].empty()) {
      moved.push_back({images[pair.first], images[pair.second], pair.first_from_second});
    }
  }
  return moved;
}

// JPEG of an image with what is masked in red.
std::vector<std::uint8_t> DrawMask(const cv::Mat& image, const cv::Mat& mask) {
  constexpr int kWidthPx = 480;
  constexpr int kQuality = 80;
  const cv::Scalar red(60, 40, 220);
  const cv::Size size(kWidthPx, std::max(1, kWidthPx * image.rows / image.cols));
  cv::Mat picture;
  cv::cvtColor(image, picture, cv::COLOR_GRAY2BGR);
  cv::Mat tinted;
  cv::addWeighted(picture, 0.5, cv::Mat(image.size(), CV_8UC3, red), 0.5, 0.0, tinted);
  tinted.copyTo(picture, mask == 0);
  cv::resize(picture, picture, size, 0, 0, cv::INTER_AREA);
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  return jpeg;
}

// Of the first image, if it can be read.
std::vector<std::uint8_t> DrawGivenMask(const FrameSet& set, int survey) {
  const std::vector<int> frames = FramesOf(set, survey);
  if (frames.empty()) {
    return {};
  }
  const std::vector<MovedImages> images = ReadImages(set, {{frames.front(), frames.front(), Pose2()}}, 1);
  return images.empty() ? std::vector<std::uint8_t>()
                        : DrawMask(images.front().first, set.surveys[static_cast<std::size_t>(survey)].survey.mask);
}

CameraMaskFinding FindCameraMask(const FrameSet& set, int survey, const PairRegistrationOptions& registration,
                                 const AutoMaskOptions& options) {
  const LoadedSurvey& loaded = set.surveys[static_cast<std::size_t>(survey)];
  CameraMaskFinding finding;
  if (!loaded.survey.mask.empty()) {
    finding.status = CameraMaskStatus::kGiven;
    finding.applied = true;
    finding.mask = loaded.survey.mask;
    finding.share = MaskedShare(finding.mask);
    finding.picture = DrawGivenMask(set, survey);
    return finding;
  }
  const std::vector<MovingPair> pairs = FindMovingPairs(set, FramesOf(set, survey), registration, options.pairs);
  const std::vector<MovedImages> images = ReadImages(set, pairs, options.run.threads);
  const FixedStructure fixed = FindFixedStructure(loaded.survey.camera, images, options.structure, options.run.threads);
  finding.pairs = fixed.pairs;
  finding.mask = fixed.mask;
  finding.share = MaskedShare(fixed.mask);
  if (fixed.decided) {
    finding.status = fixed.mask.empty() ? CameraMaskStatus::kNothing : CameraMaskStatus::kFound;
  }
  if (finding.status == CameraMaskStatus::kFound) {
    finding.picture = DrawMask(images.front().first, finding.mask);
  }
  finding.applied = options.apply && finding.status == CameraMaskStatus::kFound;
  return finding;
}

}  // namespace

void AutoMaskOptions::Check() const {
  pairs.Check();
  structure.Check();
  run.Check();
}

const char* ToString(CameraMaskStatus status) {
  switch (status) {
    case CameraMaskStatus::kGiven:
      return "given";
    case CameraMaskStatus::kNothing:
      return "nothing";
    case CameraMaskStatus::kUndecided:
      return "undecided";
    case CameraMaskStatus::kFound:
      break;
  }
  return "found";
}

std::optional<CameraMaskStatus> ParseCameraMaskStatus(const std::string& name) {
  for (const CameraMaskStatus status :
       {CameraMaskStatus::kGiven, CameraMaskStatus::kNothing, CameraMaskStatus::kUndecided, CameraMaskStatus::kFound}) {
    if (name == ToString(status)) {
      return status;
    }
  }
  return std::nullopt;
}

std::vector<CameraMaskFinding> FindCameraMasks(const FrameSet& set, const PairRegistrationOptions& registration,
                                               const AutoMaskOptions& options) {
  options.Check();
  std::vector<CameraMaskFinding> findings;
  for (std::size_t survey = 0; survey < set.surveys.size(); ++survey) {
    findings.push_back(FindCameraMask(set, static_cast<int>(survey), registration, options));
  }
  return findings;
}

LoadedSurvey WithMask(LoadedSurvey survey, const cv::Mat& mask) {
  survey.survey.mask = mask;
  survey.rectifier = std::make_shared<Rectifier>(survey.survey.camera, mask);
  return survey;
}

}  // namespace floorloc
