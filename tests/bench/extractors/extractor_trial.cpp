// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/extractors/extractor_trial.h"

#include "core/io/survey.h"
#include "core/map/camera_correction.h"
#include "core/map/map_database.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/laboratory/image_features.h"
#include "tests/bench/common/score.h"

namespace floorloc {
namespace {

// Bytes of a keypoint in a map file besides its descriptor: x, y, angle, size, response (float32), observations
// (uint16).
constexpr std::size_t kPlaceBytes = 5 * sizeof(float) + sizeof(std::uint16_t);

struct FrameOutcome {
  std::size_t keypoints = 0;
  double extract_ms = 0.0;
  double search_ms = 0.0;
  LocalizationResult global;
  LocalizationResult with_prior;
};

// The map of one trial.
struct MapUnderTest {
  const Localizer& localizer;
  const FeatureExtractor& extractor;
  Pose2 map_from_truth;
};

FrameOutcome TryFrame(const MapUnderTest& map, const Rectifier& rectifier, const SceneFrame& frame) {
  FrameOutcome outcome;
  const GroundImage image = rectifier.Rectify(frame.raw);
  const double start_ms = ThreadMilliseconds();
  outcome.keypoints = map.extractor.Extract(image).keypoints.size();
  outcome.extract_ms = ThreadMilliseconds() - start_ms;
  const double search_start_ms = ThreadMilliseconds();
  outcome.global = map.localizer.Localize(rectifier, frame.raw, std::nullopt);
  outcome.search_ms = ThreadMilliseconds() - search_start_ms;
  PosePrior prior = frame.prior;
  prior.map_from_base = map.map_from_truth * prior.map_from_base;
  outcome.with_prior = map.localizer.Localize(rectifier, frame.raw, prior);
  return outcome;
}

void TryGroup(const MapUnderTest& map, const FrameGroup& group, GroupTally* tally) {
  const Rectifier rectifier(CorrectedOrGiven(map.localizer.map().info, group.camera)
                                .AtResolution(map.localizer.map().info.camera().floor.resolution_m));
  std::vector<FrameOutcome> outcomes(group.frames.size());
  ParallelFor(static_cast<int>(outcomes.size()), 0, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    outcomes[index] = TryFrame(map, rectifier, group.frames[index]);
  });
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const Pose2 truth = map.map_from_truth * group.frames[i].truth_from_base;
    tally->keypoints.push_back(static_cast<double>(outcomes[i].keypoints));
    tally->extract_ms.push_back(outcomes[i].extract_ms);
    tally->search_ms.push_back(outcomes[i].search_ms);
    tally->global.Add(outcomes[i].global, truth);
    tally->with_prior.Add(outcomes[i].with_prior, truth);
  }
}

void AddMap(const FloorMap& map, ExtractorTally* tally) {
  const cv::Mat& descriptors = map.keypoints.descriptors;
  tally->map_keypoints += map.keypoints.size();
  tally->map_area_m2 += map.info.area_m2;
  tally->keypoint_bytes = static_cast<std::size_t>(descriptors.cols) * descriptors.elemSize() + kPlaceBytes;
}

}  // namespace

void TryExtractor(const ExtractorVariant& variant, const Scene& scene, const std::filesystem::path& map_file,
                  ExtractorTally* tally) {
  BuildOptions options;
  options.surveys = {scene.survey};
  options.out = map_file;
  options.extractor = variant.options;
  BuildMap(options);
  const MapDatabase database(map_file);
  const Localizer localizer(database.ReadMap(), LocalizerOptions(),
                            [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
  const std::unique_ptr<FeatureExtractor> extractor = CreateFeatureExtractor(localizer.map().info.extractor);
  const Trajectory truth = ReadSurvey(scene.survey).ground_truth;
  const MapUnderTest map{localizer, *extractor, AlignMapToTruth(database.ReadFrames(), truth).Inverse()};
  AddMap(localizer.map(), tally);
  for (const FrameGroup& group : scene.groups) {
    TryGroup(map, group, &tally->groups[group.name]);
  }
}

}  // namespace floorloc
