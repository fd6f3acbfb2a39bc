// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/frame_screening.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

#include "core/io/input_error.h"
#include "mapbuilder/screening/compression.h"
#include "mapbuilder/screening/standstill.h"

namespace floorloc {
namespace {

// A larger share of unreadable images indicates an incompletely copied survey.
constexpr double kMaxUnreadableShare = 0.05;

// Frames with fewer keypoints never register.
constexpr std::size_t kMinKeypoints = 12;

// Images whose bright level is below this grey value contain only noise.
constexpr float kMinBrightLevel = 12.0F;
constexpr float kMaxClippedShare = 0.5F;

// Relative to the frames before and after, lower sharpness means blur: on one floor it varies by about a fifth, and
// only blur of several pixels halves it. Less blurred images still register.
constexpr float kMinRelativeSharpness = 0.5F;
constexpr std::size_t kSharpnessNeighbours = 5;

float Median(std::vector<float> values) {
  if (values.empty()) {
    return std::numeric_limits<float>::infinity();
  }
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

class Screener {
 public:
  Screener(const std::vector<LoadedSurvey>& surveys, const std::vector<BuildFrame>& frames)
      : surveys_(surveys), frames_(frames), reason_(frames.size()) {}

  void FindUnreadable();
  void FindPoorExposure();
  void FindRepeatedFiles();
  void FindBlurred();
  void FindStandstill(const PairRegistrationOptions& registration);
  void FindWithoutTexture();
  ScreenedFrames Result() const;
  const std::vector<std::string>& reasons() const { return reason_; }

 private:
  std::vector<int> Remaining(int survey) const;
  bool HasControlPoint(int frame) const;
  void WarnOfPersistentBlur(const std::vector<int>& remaining);

  const std::vector<LoadedSurvey>& surveys_;
  const std::vector<BuildFrame>& frames_;
  std::vector<std::string> reason_;
  std::vector<std::string> warnings_;
};

// Frames of a survey not rejected so far, ordered by time.
std::vector<int> Screener::Remaining(int survey) const {
  std::vector<int> remaining;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (frames_[i].survey == survey && reason_[i].empty()) {
      remaining.push_back(static_cast<int>(i));
    }
  }
  return remaining;
}

bool Screener::HasControlPoint(int frame) const {
  const BuildFrame& f = frames_[static_cast<std::size_t>(frame)];
  const auto& points = surveys_[static_cast<std::size_t>(f.survey)].survey.control_points;
  return std::any_of(points.begin(), points.end(),
                     [&](const ControlPoint& point) { return point.filename == f.info.filename; });
}

void Screener::FindUnreadable() {
  std::size_t count = 0;
  std::string first;
  for (const LoadedSurvey& loaded : surveys_) {
    count += loaded.survey.skipped_frames.size();
    for (const SkippedFrame& frame : loaded.survey.skipped_frames) {
      first = first.empty() ? (loaded.survey.folder / frame.filename).string() + ": the " + frame.reason : first;
    }
  }
  const std::size_t listed = frames_.size() + count;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const BuildFrame& frame = frames_[i];
    if (!frame.unreadable.empty()) {
      const Survey& survey = surveys_[static_cast<std::size_t>(frame.survey)].survey;
      const std::string path = survey.ImagePath(frame.info).string() + ": ";
      reason_[i] = frame.unreadable.starts_with(path) ? frame.unreadable.substr(path.size()) : frame.unreadable;
      first = first.empty() ? frame.unreadable : first;
      ++count;
    }
  }
  const double limit = std::max(1.0, kMaxUnreadableShare * static_cast<double>(listed));
  if (static_cast<double>(count) > limit || count == listed) {
    throw InputError(first + " (" + std::to_string(count) + " of " + std::to_string(listed) +
                     " frames can't be used like this one; up to 5 % would have been left out)");
  }
}

void Screener::FindPoorExposure() {
  std::vector<float> keypoints;
  for (const BuildFrame& frame : frames_) {
    keypoints.push_back(static_cast<float>(frame.features.keypoints.size()));
  }
  const float median_keypoints = Median(keypoints);
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    const ImageQuality& quality = frames_[i].quality;
    const bool few = 2.0F * keypoints[i] < median_keypoints || frames_[i].features.keypoints.size() < kMinKeypoints;
    if (!reason_[i].empty()) {
      continue;
    }
    if (quality.bright_level < kMinBrightLevel) {
      reason_[i] = "too dark";
    } else if (quality.clipped_share > kMaxClippedShare && few) {
      reason_[i] = "overexposed";
    }
  }
}

void Screener::FindWithoutTexture() {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (reason_[i].empty() && frames_[i].features.keypoints.size() < kMinKeypoints) {
      reason_[i] = "no texture";
    }
  }
}

// Identical images are copies, since sensor noise makes every image unique.
void Screener::FindRepeatedFiles() {
  std::unordered_map<std::uint64_t, std::size_t> first_with;
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!reason_[i].empty()) {
      continue;
    }
    const auto [first, is_new] = first_with.try_emplace(frames_[i].quality.pixel_hash, i);
    if (!is_new) {
      reason_[i] = "the same image as an earlier one";
    }
  }
}

void Screener::FindBlurred() {
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    const std::vector<int> remaining = Remaining(static_cast<int>(s));
    std::vector<float> sharpness;
    for (const int i : remaining) {
      sharpness.push_back(frames_[static_cast<std::size_t>(i)].quality.sharpness);
    }
    for (std::size_t k = 0; k < remaining.size(); ++k) {
      // At a change of the floor, the frames on one side are similar to this one.
      const auto at = sharpness.begin() + static_cast<std::ptrdiff_t>(k);
      const auto reach_before = static_cast<std::ptrdiff_t>(std::min(k, kSharpnessNeighbours));
      const auto reach_after = static_cast<std::ptrdiff_t>(std::min(remaining.size() - k - 1, kSharpnessNeighbours));
      const float around = std::min(Median({at - reach_before, at}), Median({at + 1, at + 1 + reach_after}));
      if (std::isfinite(around) && *at < kMinRelativeSharpness * around) {
        reason_[static_cast<std::size_t>(remaining[k])] = "blurred";
      }
    }
    WarnOfPersistentBlur(Remaining(static_cast<int>(s)));
  }
}

// Long stretches of low sharpness may be a smooth floor, so they only cause a warning.
void Screener::WarnOfPersistentBlur(const std::vector<int>& remaining) {
  std::vector<float> sharpness;
  for (const int i : remaining) {
    sharpness.push_back(frames_[static_cast<std::size_t>(i)].quality.sharpness);
  }
  const float median_sharpness = Median(sharpness);
  std::vector<std::string> files;
  for (std::size_t k = 0; k < remaining.size(); ++k) {
    if (sharpness[k] < kMinRelativeSharpness * median_sharpness) {
      files.push_back(frames_[static_cast<std::size_t>(remaining[k])].info.filename);
    }
  }
  if (!files.empty()) {
    warnings_.push_back(std::to_string(files.size()) + " images from " + files.front() + " to " + files.back() +
                        " are less than half as sharp as the others: blurred, or of a smoother floor; check them");
  }
}

void Screener::FindStandstill(const PairRegistrationOptions& registration) {
  for (std::size_t s = 0; s < surveys_.size(); ++s) {
    const FloorPlane& floor = surveys_[s].survey.camera.floor;
    const StandstillResult still =
        FindStationaryFrames(frames_, Remaining(static_cast<int>(s)), floor.roi, registration);
    for (const int frame : still.repeated) {
      if (!HasControlPoint(frame)) {
        reason_[static_cast<std::size_t>(frame)] = kStoodStill;
      }
    }
    if (still.moved_by_odometry > 0) {
      warnings_.push_back(std::to_string(still.moved_by_odometry) +
                          " images repeat the one before although odometry moved on: check whether the camera "
                          "delivered old images");
    }
  }
}

ScreenedFrames Screener::Result() const {
  ScreenedFrames result;
  result.warnings = warnings_;
  for (const LoadedSurvey& loaded : surveys_) {
    const Survey& survey = loaded.survey;
    for (const SkippedFrame& frame : survey.skipped_frames) {
      result.dropped.push_back({frame.filename, frame.reason});
    }
    if (survey.rows_out_of_order > 0) {
      result.warnings.push_back((survey.folder / "frames.csv").string() + ": " +
                                std::to_string(survey.rows_out_of_order) +
                                " rows are earlier than the row before; the frames were taken in the order of their "
                                "time stamps");
    }
  }
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    if (!reason_[i].empty()) {
      const BuildFrame& frame = frames_[i];
      result.dropped.push_back({frame.info.filename, reason_[i], std::nullopt, frame.survey, frame.info.stamp_ns});
    }
  }
  return result;
}

// Removes control points whose images are not among the frames; returns their number.
std::size_t RemoveLostControlPoints(FrameSet* set) {
  std::vector<std::set<std::string>> kept(set->surveys.size());
  for (const BuildFrame& frame : set->frames) {
    kept[static_cast<std::size_t>(frame.survey)].insert(frame.info.filename);
  }
  std::size_t lost = 0;
  for (std::size_t s = 0; s < set->surveys.size(); ++s) {
    lost += std::erase_if(set->surveys[s].survey.control_points,
                          [&](const ControlPoint& point) { return !kept[s].contains(point.filename); });
  }
  return lost;
}

}  // namespace

ScreenedFrames ScreenFrames(FrameSet set, const PairRegistrationOptions& registration) {
  Screener screener(set.surveys, set.frames);
  screener.FindUnreadable();
  screener.FindPoorExposure();
  screener.FindWithoutTexture();
  screener.FindRepeatedFiles();
  screener.FindBlurred();
  screener.FindStandstill(registration);
  const std::vector<std::string> reasons = screener.reasons();
  ScreenedFrames result = screener.Result();
  const std::vector<std::string> compression = FindPoorCompression(set);
  result.warnings.insert(result.warnings.end(), compression.begin(), compression.end());

  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    if (reasons[i].empty()) {
      result.kept.frames.push_back(std::move(set.frames[i]));
    }
  }
  if (result.kept.frames.empty()) {
    throw InputError("no image of the survey can be used: " + result.dropped.front().filename + " is left out (" +
                     result.dropped.front().reason + "), and so are all others; check the images");
  }
  result.kept.surveys = std::move(set.surveys);
  if (const std::size_t lost = RemoveLostControlPoints(&result.kept); lost > 0) {
    result.warnings.push_back(std::to_string(lost) + " control points are in images that were left out, and not used");
  }
  return result;
}

}  // namespace floorloc
