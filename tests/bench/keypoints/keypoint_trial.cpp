// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/keypoints/keypoint_trial.h"

#include <unordered_map>

#include "core/io/survey.h"
#include "core/map/camera_correction.h"
#include "core/map/map_database.h"
#include "core/map/map_writer.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/build/build_map.h"
#include "mapbuilder/survey/extract_frames.h"
#include "tests/bench/common/score.h"

namespace floorloc {
namespace {

// A built map and its frames.
struct BuiltMap {
  FloorMap map;
  std::vector<BuildFrame> frames;
  std::vector<std::optional<Pose2>> map_from_base;
  std::vector<RectM> floor_in_base;
  Pose2 map_from_truth;
};

void Build(const std::filesystem::path& survey, const std::filesystem::path& file) {
  BuildOptions options;
  options.surveys = {survey};
  options.out = file;
  BuildMap(options);
}

BuiltMap Read(const MapDatabase& database, const std::filesystem::path& survey) {
  BuiltMap built;
  built.map = database.ReadMap();
  const std::vector<LoadedSurvey> surveys = LoadSurveys({survey});
  built.frames = ExtractSurveyFrames(surveys, {.extractor = built.map.info.extractor});
  const std::vector<MapFrame> placed = database.ReadFrames();
  std::unordered_map<std::string, Pose2> pose_of;
  for (const MapFrame& frame : placed) {
    pose_of.emplace(frame.filename, frame.map_from_base);
  }
  for (const BuildFrame& frame : built.frames) {
    const auto pose = pose_of.find(frame.info.filename);
    built.map_from_base.push_back(pose == pose_of.end() ? std::nullopt : std::optional(pose->second));
  }
  built.floor_in_base.assign(built.frames.size(), built.map.info.camera().floor.roi);
  built.map_from_truth = AlignMapToTruth(placed, surveys.front().survey.ground_truth).Inverse();
  return built;
}

KeypointFusionOptions OptionsFor(const BuiltMap& built, double budget_per_m2) {
  const MapInfo& info = built.map.info;
  KeypointFusionOptions options = KeypointFusionOptions().ForCamera(info.camera().floor, info.extractor.max_keypoints);
  options.pruning.max_per_m2 = budget_per_m2;
  return options;
}

std::size_t BytesOfFile(const FloorMap& map, const std::filesystem::path& file) {
  MapWriter writer(file);
  writer.WriteKeypoints(map.keypoints, DescriptorType::kBinary);
  writer.Commit(map.info, map.mosaic);
  return std::filesystem::file_size(file);
}

void TryGroup(const Localizer& localizer, const Pose2& map_from_truth, const FrameGroup& group, GroupTally* tally) {
  const MapInfo& info = localizer.map().info;
  const Rectifier rectifier(CorrectedOrGiven(info, group.camera).AtResolution(info.camera().floor.resolution_m));
  std::vector<std::pair<LocalizationResult, LocalizationResult>> results(group.frames.size());
  ParallelFor(static_cast<int>(results.size()), 0, [&](int i) {
    const SceneFrame& frame = group.frames[static_cast<std::size_t>(i)];
    PosePrior prior = frame.prior;
    prior.map_from_base = map_from_truth * prior.map_from_base;
    results[static_cast<std::size_t>(i)] = {localizer.Localize(rectifier, frame.raw, std::nullopt),
                                            localizer.Localize(rectifier, frame.raw, prior)};
  });
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Pose2 truth = map_from_truth * group.frames[i].truth_from_base;
    tally->global.Add(results[i].first, truth);
    tally->with_prior.Add(results[i].second, truth);
  }
}

}  // namespace

void TryBudgets(const Scene& scene, const std::filesystem::path& folder, std::vector<KeypointTally>* tallies,
                const std::function<void()>& advance) {
  const std::filesystem::path file = folder / "bench.floormap";
  Build(scene.survey, file);
  const MapDatabase database(file);
  const BuiltMap built = Read(database, scene.survey);
  const KeypointFusionInput input{built.frames, built.map_from_base, built.floor_in_base};
  for (KeypointTally& tally : *tallies) {
    FloorMap map = built.map;
    map.keypoints = FuseByRule(tally.rule, input, OptionsFor(built, tally.budget_per_m2));
    tally.keypoints += map.keypoints.size();
    tally.file_bytes += BytesOfFile(map, folder / "pruned.floormap");
    tally.area_m2 += map.info.area_m2;
    const Localizer localizer(std::move(map), LocalizerOptions(),
                              [&](const TileId& tile) { return database.ReadMosaicTile(tile); });
    for (const FrameGroup& group : scene.groups) {
      TryGroup(localizer, built.map_from_truth, group, &tally.groups[group.name]);
    }
    advance();
  }
}

}  // namespace floorloc
