// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "mapbuilder/replay/fuse_frames.h"

namespace floorloc {

enum class CheckStatus {
  kOk,
  kNote,   ///< works, and would work better otherwise
  kWrong,  ///< has to be mended
};
/// "ok", "note", "wrong"
const char* ToString(CheckStatus status);

/// What a recorded drive says of a part of a robot.
struct CheckFinding {
  std::string about;  ///< "floor", "images", "camera", "odometry", "clock", "gyro"
  CheckStatus status = CheckStatus::kOk;
  std::string sentence;  ///< with numbers, and what to do
};

/// Limits between ok, note and wrong. A robot that is wired right passes them (tests/mapbuilder/replay, maps/sample).
struct DriveCheckOptions {
  double min_localized_share = 0.9;   ///< of the images: fewer are a note,
  double lost_localized_share = 0.2;  ///< and fewer than this say that floor and map do not belong together
  double max_step_share = 0.5;        ///< of a view between images, which else do not show the same floor
  double max_gap_s = 0.5;             ///< in odometry: a controller drives blind for so long
  double max_offset_s = 0.02;         ///< between clocks: at 1 m/s a picture is 2 cm from where it seems to be
  double max_faulty_share = 0.2;      ///< of the images that odometry may contradict, as it does after a slip
  double max_scale_error = 0.03;  ///< of odometry: wheels that nobody calibrated err by 2 % (Borenstein & Feng 1996)
  double max_gyro_scale_error = 0.05;
  double max_gyro_bias_rad_s = 0.02;
  double min_turn_rad = 0.3;  ///< of the whole drive, to judge the gyro
  double max_pair_s = 2.0;    ///< between two fixes of which the gyro is judged

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// Judges a drive that was replayed in a map: one finding or more for each part that the recording has.
std::vector<CheckFinding> CheckDrive(const Survey& drive, const FusedDrive& fused,
                                     const DriveCheckOptions& options = {});

/// The worst of the findings.
CheckStatus WorstOf(const std::vector<CheckFinding>& findings);

}  // namespace floorloc
