// SPDX-License-Identifier: Apache-2.0
#include "tests/synthetic/synthetic_floor.h"

namespace floorloc {
namespace {

FloorTextureOptions SmallFloor(std::uint64_t seed) {
  FloorTextureOptions floor;
  floor.source = "concrete";
  floor.width_m = 1.2;
  floor.height_m = 0.9;
  floor.seed = seed;
  return floor;
}

}  // namespace

SyntheticFloor::SyntheticFloor(std::uint64_t seed)
    : seed_(seed),
      floor_(SmallFloor(seed)),
      camera_(MakeDownwardCamera()),
      renderer_(MakeFloorTexture(floor_), camera_) {}

Pose2 SyntheticFloor::BaseForView(double x_m, double y_m, double yaw_rad) const {
  const Eigen::Vector2d center = camera_.floor.roi.Center();
  return Pose2(x_m, y_m, yaw_rad) * Pose2(-center.x(), -center.y(), 0.0);
}

cv::Mat SyntheticFloor::View(const Pose2& map_from_base, const RenderConditions& conditions) const {
  return renderer_.Render(map_from_base, conditions);
}

SimulationResult SyntheticFloor::WriteSurvey(const std::filesystem::path& folder) const {
  return Simulate(SurveyOptions(folder));
}

SimulationResult SyntheticFloor::WriteDrive(const std::filesystem::path& folder, int frames) const {
  SimulateOptions options = SurveyOptions(folder);
  options.path.type = PathType::kDrive;
  options.path.frames = frames;
  options.seed = seed_ + 1;
  return Simulate(options);
}

SimulateOptions SyntheticFloor::SurveyOptions(const std::filesystem::path& folder) const {
  SimulateOptions options;
  options.out = folder;
  options.floor = floor_;
  options.camera = camera_;
  options.conditions = ConditionLevels::FromName("mild");
  options.seed = seed_;
  return options;
}

}  // namespace floorloc
