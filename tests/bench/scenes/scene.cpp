// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/scenes/scene.h"

#include <algorithm>
#include <set>

#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/simulation/simulated_noise.h"
#include "tests/bench/common/bench_frames.h"
#include "tests/bench/scenes/bench_floor.h"
#include "tests/bench/scenes/frame_plan.h"
#include "tests/bench/scenes/frame_runner.h"

namespace floorloc {
namespace {

constexpr double kWidthM = 2.2;
constexpr double kHeightM = 1.6;
constexpr std::uint64_t kFrameSeed = 21;

std::vector<ConditionCase> MildAndHard() {
  std::vector<ConditionCase> conditions = ConditionCases();
  std::erase_if(conditions, [](const ConditionCase& c) { return c.name != "mild" && c.name != "hard"; });
  return conditions;
}

// `count` plans per condition.
std::vector<std::vector<FramePlan>> PlanFrames(const FramePlanner& planner, int count) {
  std::vector<std::vector<FramePlan>> plans(planner.conditions);
  const auto full = [&](const std::vector<FramePlan>& some) { return static_cast<int>(some.size()) == count; };
  for (int i = 0; !std::all_of(plans.begin(), plans.end(), full); ++i) {
    const FramePlan plan = planner.Plan(i);
    if (!full(plans[plan.condition])) {
      plans[plan.condition].push_back(plan);
    }
  }
  return plans;
}

PosePrior PlannedPrior(const FramePlan& plan) {
  const auto is_prior = [](const PlannedSearch& search) { return search.kind == SearchKind::kPrior; };
  return std::find_if(plan.searches.begin(), plan.searches.end(), is_prior)->prior.value();
}

FrameGroup RenderGroup(const GrayFloor& floor, const ConditionCase& condition, const std::vector<FramePlan>& plans) {
  const GrayRenderer renderer(BenchCamera());
  FrameGroup group{condition.name, BenchCalibration(), std::vector<SceneFrame>(plans.size())};
  ParallelFor(static_cast<int>(plans.size()), 0, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const FramePlan& plan = plans[index];
    group.frames[index] = {RenderFrame(renderer, floor, condition, plan), plan.truth_from_base, PlannedPrior(plan)};
  });
  return group;
}

FrameGroup ReadGroup(const std::filesystem::path& folder) {
  const BenchFrames set = BenchFrames::Read(folder);
  FrameGroup group{folder.string(), set.rectifier.camera(), {}};
  for (std::size_t i = 0; i < set.size(); ++i) {
    cv::RNG rng(DeriveSeed(kFrameSeed, i));
    group.frames.push_back({set.Decode(i), set.truth_from_base[i], DrawPrior(set.truth_from_base[i], rng)});
  }
  return group;
}

}  // namespace

std::vector<FloorCase> SceneFloors(const std::string& photograph) {
  std::vector<FloorCase> floors = FloorCases(photograph);
  const std::set<std::string> wanted{"concrete", "carpet", "wood", "photo", "tiles"};
  std::erase_if(floors, [&](const FloorCase& floor) { return !wanted.contains(floor.name); });
  for (FloorCase& floor : floors) {
    floor.mapped_width_m = kWidthM;
    floor.texture.width_m = kWidthM;
    floor.texture.height_m = kHeightM;
  }
  return floors;
}

Scene SimulateScene(const std::filesystem::path& folder, const FloorCase& floor, int frames) {
  const FloorFiles files{folder, floor.name};
  MakeFloor(files, floor);
  const std::vector<ConditionCase> conditions = MildAndHard();
  const FramePlanner planner{floor, BenchCamera().floor.roi, conditions.size(), {}, kFrameSeed, true};
  const std::vector<std::vector<FramePlan>> plans = PlanFrames(planner, frames);
  Scene scene{files.Survey(), {}};
  for (std::size_t i = 0; i < conditions.size(); ++i) {
    scene.groups.push_back(RenderGroup(ReadGrayFloor(files, conditions[i].wear), conditions[i], plans[i]));
  }
  return scene;
}

Scene ReadScene(const std::filesystem::path& survey, const std::vector<std::filesystem::path>& frames) {
  Scene scene{survey, {}};
  for (const std::filesystem::path& folder : frames) {
    scene.groups.push_back(ReadGroup(folder));
  }
  return scene;
}

}  // namespace floorloc
