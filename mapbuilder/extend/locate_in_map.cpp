// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/extend/locate_in_map.h"

#include <cmath>
#include <optional>

#include "core/io/image.h"
#include "core/localization/localizer.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// Search radius of a prior by odometry: a constant and a share of the distance from the localized frame.
constexpr double kStartRadiusM = 0.05;
constexpr double kRadiusShare = 0.1;
constexpr double kStartYawRadius = 0.05;
constexpr double kYawRadiusPerM = 0.1;
constexpr double kMaxRadiusM = 0.5;

class Locator {
 public:
  Locator(const BaseMap& base_map, const std::vector<LoadedSurvey>& surveys, const std::vector<BuildFrame>& frames,
          const LocateOptions& options)
      : base_map_(base_map), surveys_(surveys), frames_(frames), options_(options), fixes_(frames.size()) {
    LocalizerOptions localizer;
    localizer.index.seed = options.seed;
    localizer.registration.seed = options.seed;
    localizer_.emplace(base_map.map, localizer,
                       [&](const TileId& tile) { return base_map_.database.ReadMosaicTile(tile); });
  }

  std::vector<PosePriorFactor> Run() {
    std::vector<int> all;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      all.push_back(static_cast<int>(i));
    }
    Locate(all, std::vector<std::optional<PosePrior>>(all.size()));
    LocateAlongOdometry();
    std::vector<PosePriorFactor> found;
    for (const auto& fix : fixes_) {
      if (fix) {
        found.push_back(*fix);
      }
    }
    return found;
  }

 private:
  void Locate(const std::vector<int>& which, const std::vector<std::optional<PosePrior>>& priors) {
    ProgressBar progress("finding the frames in " + base_map_.file.filename().string(),
                         static_cast<std::int64_t>(which.size()), options_.run.progress);
    ParallelFor(static_cast<int>(which.size()), options_.run.threads, [&](int k) {
      const int i = which[static_cast<std::size_t>(k)];
      const BuildFrame& frame = frames_[static_cast<std::size_t>(i)];
      const LoadedSurvey& from = surveys_[static_cast<std::size_t>(frame.survey)];
      const CameraModel& camera = from.survey.camera.camera;
      const cv::Mat raw = ReadGrayImage(from.survey.ImagePath(frame.info), camera.width_px, camera.height_px);
      const LocalizationResult result = localizer_->Localize(*from.rectifier, raw, priors[static_cast<std::size_t>(k)]);
      if (result.status == LocalizationStatus::kLocalized) {
        fixes_[static_cast<std::size_t>(i)] = {i, result.map_from_base, result.covariance};
      }
      progress.Advance();
    });
  }

  void LocateAlongOdometry() {
    std::vector<int> which;
    std::vector<std::optional<PosePrior>> priors;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      if (const auto prior = fixes_[i] ? std::nullopt : PriorOf(i)) {
        which.push_back(static_cast<int>(i));
        priors.push_back(prior);
      }
    }
    Locate(which, priors);
  }

  // Prior from the localized frame nearest in time, before or after, if the frame may show floor of the base map.
  std::optional<PosePrior> PriorOf(std::size_t frame) const {
    constexpr std::ptrdiff_t kMaxSteps = 200;
    const auto length = static_cast<std::ptrdiff_t>(frames_.size());
    for (std::ptrdiff_t step = 1; step <= kMaxSteps; ++step) {
      for (const std::ptrdiff_t sign : {-1, 1}) {
        const std::ptrdiff_t other = static_cast<std::ptrdiff_t>(frame) + sign * step;
        if (other < 0 || other >= length || !fixes_[static_cast<std::size_t>(other)]) {
          continue;
        }
        const BuildFrame& from = frames_[static_cast<std::size_t>(other)];
        if (from.survey == frames_[frame].survey && from.odom_from_base && frames_[frame].odom_from_base) {
          return PriorFrom(static_cast<std::size_t>(other), frame);
        }
      }
    }
    return std::nullopt;
  }

  std::optional<PosePrior> PriorFrom(std::size_t found, std::size_t frame) const {
    const Pose2 motion = frames_[found].odom_from_base->Between(*frames_[frame].odom_from_base);
    const double way_m = motion.translation().norm();
    const PosePrior prior{fixes_[found]->map_from_base * motion, kStartRadiusM + kRadiusShare * way_m,
                          kStartYawRadius + kYawRadiusPerM * way_m};
    if (prior.radius_m > kMaxRadiusM || !SeesBaseMapFloor(frames_[frame].survey, prior.map_from_base)) {
      return std::nullopt;
    }
    return prior;
  }

  bool SeesBaseMapFloor(int survey, const Pose2& map_from_base) const {
    const RectM& roi = surveys_[static_cast<std::size_t>(survey)].survey.camera.floor.roi;
    for (const double x : {roi.x_min, roi.Center().x(), roi.x_max}) {
      for (const double y : {roi.y_min, roi.Center().y(), roi.y_max}) {
        if (base_map_.coverage.CountAt(map_from_base * Eigen::Vector2d(x, y)) > 0) {
          return true;
        }
      }
    }
    return false;
  }

  const BaseMap& base_map_;
  const std::vector<LoadedSurvey>& surveys_;
  const std::vector<BuildFrame>& frames_;
  const LocateOptions& options_;
  std::optional<Localizer> localizer_;
  std::vector<std::optional<PosePriorFactor>> fixes_;
};

}  // namespace

void LocateOptions::Check() const { run.Check(); }

std::vector<PosePriorFactor> LocateInMap(const BaseMap& base_map, const std::vector<LoadedSurvey>& surveys,
                                         const std::vector<BuildFrame>& frames, const LocateOptions& options) {
  options.Check();
  return Locator(base_map, surveys, frames, options).Run();
}

}  // namespace floorloc
