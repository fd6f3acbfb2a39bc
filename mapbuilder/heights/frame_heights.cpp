// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/heights/frame_heights.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "core/geometry/option_check.h"
#include "core/io/image.h"
#include "core/vision/image/rectifier.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/heights/height_scale.h"
#include "mapbuilder/placement/similar_pairs.h"

namespace floorloc {
namespace {

// Odometry drifts: views that share this much of their floor by odometry are likely to share some.
constexpr double kLikelyOverlap = 0.5;

// A link whose inliers are scaled by more than this is worth a measurement with free scale.
constexpr double kSuspiciousLog = 0.01;

cv::Mat ReadRaw(const BuildFrame& frame, const std::vector<LoadedSurvey>& surveys) {
  const Survey& survey = surveys[static_cast<std::size_t>(frame.survey)].survey;
  const CameraModel& camera = survey.camera.camera;
  return ReadGrayImage(survey.ImagePath(frame.info), camera.width_px, camera.height_px);
}

template <typename T>
std::vector<T> SpreadEvenly(const std::vector<T>& all, int count) {
  std::vector<T> sample;
  const auto wanted = static_cast<std::size_t>(count);
  for (std::size_t i = 0; i < std::min(wanted, all.size()); ++i) {
    sample.push_back(all[i * all.size() / std::min(wanted, all.size())]);
  }
  return sample;
}

// Pairs of frames, not next to each other in time, that see the same floor by odometry; the nearest in time first,
// since they drifted least.
std::vector<FramePair> PairsByOdometry(const FrameSet& set) {
  std::vector<FramePair> pairs;
  const std::vector<RectM> floors = set.FloorsInBase();
  for (std::size_t s = 0; s < set.surveys.size(); ++s) {
    std::vector<std::optional<Pose2>> odom_from_base(set.frames.size());
    for (std::size_t i = 0; i < set.frames.size(); ++i) {
      if (set.frames[i].survey == static_cast<int>(s)) {
        odom_from_base[i] = set.frames[i].odom_from_base;
      }
    }
    NearbyOptions nearby;
    nearby.min_overlap = kLikelyOverlap;
    for (const FramePair& pair : SelectNearbyPairs(odom_from_base, floors, nearby)) {
      if (pair.second - pair.first > 1) {
        pairs.push_back({pair.first, pair.second, std::nullopt, 0.0, 0.0});
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const FramePair& a, const FramePair& b) { return a.second - a.first < b.second - b.first; });
  return pairs;
}

class HeightFinder {
 public:
  HeightFinder(const FrameHeightOptions& options, const HeightSources& sources, FrameSet* set)
      : options_(options), sources_(sources), set_(*set), sift_(set->frames.size()) {
    options_.scale.resolution_m = sources.registration.resolution_m;
    options_.scale.run = sources.registration.run;
    options_.scale.seed = sources.registration.registration.seed;
    ExtractorOptions sift;
    sift.type = ExtractorType::kSift;
    sift.max_keypoints = options.keypoints;
    extractor_ = CreateFeatureExtractor(sift);
  }

  FrameHeights Run() {
    FrameHeights heights;
    const bool uneven = options_.mode == FreeHeight::kOn || MeasureSample(&heights.spread);
    if (options_.mode != FreeHeight::kOff && uneven) {
      SetFree(&heights);
    }
    return heights;
  }

 private:
  bool MeasureSample(double* spread);
  // Pairs that match at one height, and those that do not, or better at another scale.
  struct Sample {
    std::size_t even = 0;
    std::vector<FramePair> suspicious;
  };
  Sample MatchSample() const;
  std::vector<FramePair> SimilarPairs();
  bool HasOdometry() const {
    return std::any_of(set_.frames.begin(), set_.frames.end(),
                       [](const BuildFrame& frame) { return frame.odom_from_base.has_value(); });
  }
  void ExtractSift(std::vector<int> frames);
  std::vector<ScaleLink> Measure(const std::vector<FramePair>& pairs);
  std::vector<FramePair> FartherPairs(const std::vector<ScaleLink>& neighbours) const;
  void SetFree(FrameHeights* heights);
  void Apply(const std::vector<double>& log_height);

  FrameHeightOptions options_;
  const HeightSources& sources_;
  FrameSet& set_;
  std::vector<BuildFrame> sift_;  // with SIFT features; empty where they were not needed yet
  std::vector<bool> has_sift_ = std::vector<bool>(sift_.size(), false);
  std::unique_ptr<FeatureExtractor> extractor_;
};

// A sample of neighbours in time and by odometry.
HeightFinder::Sample HeightFinder::MatchSample() const {
  std::vector<FramePair> sample = SpreadEvenly(SelectConsecutivePairs(set_.frames), options_.sampled_pairs);
  const std::vector<FramePair> farther = SpreadEvenly(PairsByOdometry(set_), options_.sampled_pairs);
  sample.insert(sample.end(), farther.begin(), farther.end());
  PairRegistrationOptions quiet = sources_.registration;
  quiet.run.progress = {};
  std::set<std::pair<int, int>> even;
  for (const Link& link : RegisterPairs(set_.frames, set_.FloorsInBase(), sample, quiet)) {
    if (std::abs(std::log(link.scale)) < kSuspiciousLog) {
      even.emplace(link.first, link.second);
    }
  }
  std::erase_if(sample, [&](const FramePair& pair) { return even.contains({pair.first, pair.second}); });
  return {even.size(), std::move(sample)};
}

// Pairs of a sample of frames that resemble each other, in surveys without an order.
std::vector<FramePair> HeightFinder::SimilarPairs() {
  std::vector<int> numbers(set_.frames.size());
  std::iota(numbers.begin(), numbers.end(), 0);
  ExtractSift(SpreadEvenly(numbers, options_.searched_frames));
  return SelectSimilarPairs(sift_, numbers, {options_.pairs_per_frame, options_.scale.run});
}

// Returns whether the heights of enough pairs are uneven, and their spread.
bool HeightFinder::MeasureSample(double* spread) {
  const Sample sample = MatchSample();
  std::vector<ScaleLink> links = Measure(sample.suspicious);
  if (!HasOdometry() && 2 * (sample.even + links.size()) < sample.even + sample.suspicious.size()) {
    links = Measure(SimilarPairs());
  }
  std::vector<double> uneven;
  for (const ScaleLink& link : links) {
    const double off = std::abs(std::log(link.first_from_second.scale()));
    if (off > std::log1p(options_.max_spread)) {
      uneven.push_back(off);
    }
  }
  if (static_cast<int>(uneven.size()) < options_.min_uneven_pairs) {
    return false;
  }
  *spread = std::expm1(*std::max_element(uneven.begin(), uneven.end()));
  return true;
}

// Of those frames that have none yet.
void HeightFinder::ExtractSift(std::vector<int> frames) {
  std::erase_if(frames, [&](int frame) { return has_sift_[static_cast<std::size_t>(frame)]; });
  ParallelFor(static_cast<int>(frames.size()), options_.scale.run.threads, [&](int k) {
    const auto i = static_cast<std::size_t>(frames[static_cast<std::size_t>(k)]);
    const BuildFrame& frame = set_.frames[i];
    const LoadedSurvey& from = set_.surveys[static_cast<std::size_t>(frame.survey)];
    sift_[i].survey = frame.survey;
    sift_[i].features =
        extractor_->Extract(from.rectifier->Rectify(ReadRaw(frame, set_.surveys), frame.readout_motion));
  });
  for (const int frame : frames) {
    has_sift_[static_cast<std::size_t>(frame)] = true;
  }
}

std::vector<ScaleLink> HeightFinder::Measure(const std::vector<FramePair>& pairs) {
  std::set<int> involved;
  for (const FramePair& pair : pairs) {
    involved.insert({pair.first, pair.second});
  }
  ExtractSift({involved.begin(), involved.end()});
  ScaleRegistrationOptions quiet = options_.scale;
  quiet.run.progress = {};
  return MeasureScales(sift_, set_.FloorsInBase(), pairs, quiet);
}

// Pairs beyond the neighbours in time: by odometry where there is some, else by appearance.
std::vector<FramePair> HeightFinder::FartherPairs(const std::vector<ScaleLink>& neighbours) const {
  std::vector<FramePair> pairs;
  std::map<int, int> count;
  for (const FramePair& pair : PairsByOdometry(set_)) {
    if (std::max(count[pair.first], count[pair.second]) < options_.pairs_per_frame) {
      ++count[pair.first];
      ++count[pair.second];
      pairs.push_back(pair);
    }
  }
  const std::vector<int> part = LinkedGroups(static_cast<int>(set_.frames.size()), neighbours);
  const std::vector<FramePair> similar =
      SelectSimilarPairs(sift_, part, {options_.pairs_per_frame, options_.scale.run});
  pairs.insert(pairs.end(), similar.begin(), similar.end());
  if (!HasOdometry()) {
    std::vector<int> each(set_.frames.size());
    std::iota(each.begin(), each.end(), 0);
    const std::vector<FramePair> loops =
        SelectSimilarPairs(sift_, each, {options_.pairs_per_frame, options_.scale.run});
    pairs.insert(pairs.end(), loops.begin(), loops.end());
  }
  return pairs;
}

void HeightFinder::SetFree(FrameHeights* heights) {
  std::vector<FramePair> neighbours = SelectConsecutivePairs(set_.frames);
  std::vector<int> all(set_.frames.size());
  std::iota(all.begin(), all.end(), 0);
  ExtractSift(all);
  std::vector<ScaleLink> links = Measure(neighbours);
  const std::vector<ScaleLink> farther = Measure(FartherPairs(links));
  links.insert(links.end(), farther.begin(), farther.end());
  std::vector<double> log_height = SolveHeights(static_cast<int>(set_.frames.size()), links, options_.graph);
  const ScaledGroups scaled = ScaleByMotion(set_, sources_.poses, links, &log_height);
  heights->free = true;
  heights->asked = options_.mode == FreeHeight::kOn;
  heights->scale_by = scaled.moved < std::max(1, scaled.all) ? "the calibrated height, which is the frames' mean"
                      : sources_.poses.empty()               ? "odometry"
                                                             : "the known poses";
  const auto [lowest, highest] = std::minmax_element(log_height.begin(), log_height.end());
  heights->lowest = std::exp(*lowest);
  heights->highest = std::exp(*highest);
  heights->spread = std::expm1(*highest - *lowest);
  Apply(log_height);
}

// Extracts the features again: descriptors are of one scale of the floor.
void HeightFinder::Apply(const std::vector<double>& log_height) {
  const auto extractor = CreateFeatureExtractor(sources_.extractor);
  ProgressBar progress("heights", static_cast<std::int64_t>(set_.frames.size()), options_.scale.run.progress);
  ParallelFor(static_cast<int>(set_.frames.size()), options_.scale.run.threads, [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    BuildFrame& frame = set_.frames[i];
    frame.height_ratio = std::exp(log_height[i]);
    const cv::Mat& mask = set_.surveys[static_cast<std::size_t>(frame.survey)].survey.mask;
    const Rectifier rectifier(CameraOf(frame, set_.surveys), mask);
    frame.features = extractor->Extract(rectifier.Rectify(ReadRaw(frame, set_.surveys), frame.readout_motion));
    progress.Advance();
  });
}

}  // namespace

FreeHeight ParseFreeHeight(const std::string& name) {
  if (name == "auto" || name == "on" || name == "off") {
    return name == "auto" ? FreeHeight::kAuto : name == "on" ? FreeHeight::kOn : FreeHeight::kOff;
  }
  throw std::invalid_argument("--free-height: '" + name + "' is not auto, on or off");
}

void FrameHeightOptions::Check() const {
  RequireOption(max_spread > 0.0 && max_spread < 1.0, "max_spread must be between 0 and 1");
  RequireOption(sampled_pairs >= 1, "sampled_pairs must be at least 1");
  RequireOption(searched_frames >= 2, "searched_frames must be at least 2");
  RequireOption(min_uneven_pairs >= 1, "min_uneven_pairs must be at least 1");
  RequireOption(keypoints >= 12, "keypoints must be at least 12");
  RequireOption(pairs_per_frame >= 1, "pairs_per_frame must be at least 1");
  scale.Check();
  graph.Check();
}

FrameHeights FindHeights(const FrameHeightOptions& options, const HeightSources& sources, FrameSet* set) {
  options.Check();
  return HeightFinder(options, sources, set).Run();
}

std::string HeightWarning(const FrameHeights& heights) {
  if (heights.spread <= 0.0 || heights.asked) {
    return "";
  }
  char text[256];
  if (heights.free) {
    std::snprintf(text, sizeof(text),
                  "the frames differ by %.0f %% in height (%.2f to %.2f of the calibrated height): each has its own in "
                  "this map, whose scale comes from %s",
                  100.0 * heights.spread, heights.lowest, heights.highest, heights.scale_by.c_str());
  } else {
    std::snprintf(text, sizeof(text),
                  "your frames differ by %.0f %% in height; floorloc assumes one height: use --free-height",
                  100.0 * heights.spread);
  }
  return text;
}

}  // namespace floorloc
