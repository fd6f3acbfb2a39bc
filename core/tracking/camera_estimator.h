// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "core/geometry/pose2.h"
#include "core/localization/readout_fit.h"
#include "core/photometry/camera_errors.h"

namespace floorloc {

/// How a vehicle's camera is learnt from its fixes. `./run bench calibration --learn` measures its effect.
struct CameraEstimatorOptions {
  /// Prior of the errors: a mounting that was measured by hand, a calibration that is worth a pixel at the corners.
  double rotation_sigma_rad = 5e-3;
  double height_share_sigma = 0.01;
  double calibration_sigma_px = 1.0;
  /// Evidence fades by this number of fixes: a camera that is bumped is learnt anew.
  double memory_fixes = 500.0;
  /// Between used fixes the view moves by this share of its radius, or turns by so much: a vehicle that stands still
  /// sees the errors of one place again and again.
  double min_travel_share = 0.5;
  double min_turn_rad = 0.5;
  /// So many fixes tell as much as any number of them: all share the errors of the map's own camera and of the lens
  /// beyond the modes. Believed in full, 19 fixes of an exact camera were taken for a tilt of 0.23 +- 0.06 degrees that
  /// the lens hides but for 0.1 px, and moved the base by 1.2 mm.
  double independent_fixes = 8.0;
  double max_p_wrong = 1e-6;  ///< fixes that are less certain are not used
  int min_fixes = 12;         ///< before, nothing is said
  /// Squared Mahalanobis distance of the errors from zero from which on they are compensated (of 12 unknowns: 33 is
  /// exceeded once in 1000 times). Smaller ones are left to the covariance: a tilt that is known to 0.07 degrees moves
  /// the base by half a millimetre.
  double min_significance = 40.0;
  /// A tilt is compensated only where the fixes are better explained with one by such a squared Mahalanobis distance
  /// (of 2 unknowns: 18 is exceeded once in 10,000 times): the lens alone explains most of what a tilt shows, but a
  /// tilt moves the base.
  double min_tilt_significance = 18.0;
  /// The estimate starts anew where the newest fixes, by this memory, contradict it by such a squared Mahalanobis
  /// distance: the camera was bumped. Twice min_significance, since neighbouring fixes share errors of the mosaic.
  double recent_fixes = 12.0;
  double bump_significance = 80.0;
  /// Larger errors are not compensated: the camera has to be calibrated, or mounted, anew.
  double max_rotation_rad = 0.035;
  double max_height_share = 0.05;
  double max_calibration_px = 4.0;

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

enum class CameraStatus {
  kLearning,      ///< too few fixes
  kAsCalibrated,  ///< no significant error
  kCorrected,     ///< the errors are compensated
  kImplausible,   ///< larger than what may be compensated
};
/// "learning", "as_calibrated", "corrected", "implausible"
const char* ToString(CameraStatus status);

/// A camera's constant errors, by all fixes.
struct CameraEstimate {
  CameraStatus status = CameraStatus::kLearning;
  int fixes = 0;  ///< used ones
  CameraPrior errors;
  std::optional<ReadoutMeasurement> readout;  ///< of a camera that does not tell its own; empty: not learnt (yet)
};

/// What a vehicle's fixes told of its camera.
struct LearntCamera {
  /// Sums of evidence.
  struct Sums {
    CameraErrorMatrix information = CameraErrorMatrix::Zero();
    CameraErrors pull = CameraErrors::Zero();
  };
  Sums all;
  Sums recent;             ///< of the newest ones
  std::size_t camera = 0;  ///< as in CameraEvidence
  int fixes = 0;
  std::optional<Pose2> last_used = {};  ///< where the newest one was
};

/// Estimates the constant errors of one vehicle's camera: the product of the likelihoods of its fixes, and of a prior.
class CameraEstimator {
 public:
  explicit CameraEstimator(const CameraEstimatorOptions& options = {});

  /// Uses the evidence of an accepted fix unless the vehicle has hardly moved. Evidence relative to another calibration
  /// than before starts anew.
  void Add(const CameraEvidence& evidence, const Pose2& map_from_base, double p_wrong);
  CameraEstimate Estimate() const;
  /// For the next frame's alignment; empty while there is none that may be used.
  std::optional<CameraPrior> PriorOfNextFrame() const;
  const LearntCamera& Learnt() const { return learnt_; }
  /// Goes on with what another estimator of this camera learnt.
  void Resume(const LearntCamera& learnt) { learnt_ = learnt; }

 private:
  bool WasBumped() const;
  bool HasMoved(const Pose2& map_from_base, double view_radius_m) const;

  CameraEstimatorOptions options_;
  LearntCamera learnt_;
};

}  // namespace floorloc
