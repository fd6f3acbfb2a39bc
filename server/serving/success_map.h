// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "server/serving/localize_service.h"
#include "server/store/success_table.h"

namespace floorloc {

struct SuccessOptions {
  double square_m = 0.5;  ///< about a camera's view
  /// When a square has so many images its counts are halved: what it says is about the last ones.
  std::int64_t memory_images = 1000;
  /// To survey again where less than this share is found: the share that VerdictOptions wants of a survey's own frames.
  double min_found_share = 0.8;
  std::int64_t min_images = 20;  ///< of a square, before it is said: some passes of a vehicle
  double sigmas = 1.64;          ///< by which the share must be below: chance does so in 5 % of squares (Wilson 1927)

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// What an image says of the floor that it shows.
struct SuccessSample {
  std::optional<Eigen::Vector2d> place;  ///< middle of its view, map frame; empty: unknown
  bool found = false;
  int inliers = 0;
};

/// What a localization says: its view is where it was found, or else where the prior had it. Found is what was
/// localized and not rejected. Empty for an image that shows no floor: it says nothing of the map.
std::optional<SuccessSample> SampleOf(const LocalizeJob& job, const LocalizationResult& result, bool rejected);

/// True when the square is to be surveyed again.
bool MustSurveyAgain(const SuccessSquare& square, const SuccessOptions& options);

/// Counts found and missed images of every map by square of its floor. Thread-safe.
class SuccessMap {
 public:
  explicit SuccessMap(const SuccessOptions& options);

  /// Goes on from what an earlier server counted; in squares of another side, it does not.
  void Recall(const std::map<std::string, MapSuccess>& remembered);

  const SuccessOptions& options() const { return options_; }
  /// info: of the map as it is served. Of another version than before: counting starts anew.
  void Add(const std::string& map, const MapInfo& info, const SuccessSample& sample, double now_s);
  /// Squares sorted by y, then x. Without squares when no image was counted in this version.
  MapSuccess Of(const std::string& map, const std::string& version) const;

  /// What changed since the last call, by name of the map: with those squares only that changed.
  std::map<std::string, MapSuccess> TakeChanges();

 private:
  using Square = std::pair<int, int>;  // y, x

  struct Counts {
    MapSuccess all;  // without squares
    std::map<Square, SuccessSquare> squares;
    std::set<Square> changed;
    bool head_changed = false;
  };

  const SuccessOptions options_;
  mutable std::mutex mutex_;
  std::map<std::string, Counts> maps_;
};

}  // namespace floorloc
