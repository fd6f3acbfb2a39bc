// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/diagnosis/part_findings.h"
#include "core/io/trajectory.h"

namespace floorloc {
namespace {

// What the images said of the odometry over the drive.
struct TrustOverDrive {
  OdometryTrust last;
  OdometryFault most_frequent = OdometryFault::kNone;  // but for other clocks
  int faulty_images = 0;                               // with that fault
};

TrustOverDrive FollowTrust(const DriveRecord& record) {
  TrustOverDrive trust;
  std::array<int, static_cast<std::size_t>(OdometryFault::kCount)> faults{};
  for (const RecordedFrame& frame : record.frames()) {
    if (frame.odometry) {
      trust.last = *frame.odometry;
      ++faults.at(static_cast<std::size_t>(trust.last.fault));
    }
  }
  for (std::size_t i = 0; i < faults.size(); ++i) {
    const auto fault = static_cast<OdometryFault>(i);
    const bool counts = fault != OdometryFault::kNone && fault != OdometryFault::kTimeOffset;
    if (counts && faults.at(i) > trust.faulty_images) {
      trust.most_frequent = fault;
      trust.faulty_images = faults.at(i);
    }
  }
  return trust;
}

Finding FindingOfDirection(const TrustOverDrive& trust, std::size_t images, const DiagnosisOptions& options) {
  const std::string scales =
      FormatSentence("distances to be multiplied by %.3f, turns by %.3f", trust.last.scale, trust.last.yaw_scale);
  const std::string contradiction = FormatSentence("odometry contradicted %d of %zu images (%s)", trust.faulty_images,
                                                   images, ToString(trust.most_frequent));
  const double share = trust.faulty_images / std::max(1.0, static_cast<double>(images));
  const bool rejected = trust.last.health == OdometryHealth::kRejected;
  const bool named = rejected && trust.last.fault != OdometryFault::kInconsistent;
  if (named || share > options.max_faulty_share) {
    return {"odometry", FindingStatus::kWrong, contradiction + ": " + scales,
            CureOf(named ? trust.last.fault : trust.most_frequent)};
  }
  if (trust.last.health == OdometryHealth::kLearning) {
    return {"odometry", FindingStatus::kUnknown, "not enough was driven yet to compare odometry with the images",
            "drive a loop of some metres, with turns both ways"};
  }
  if (trust.faulty_images > 0) {
    return {"odometry", FindingStatus::kNote,
            contradiction + (rejected ? " and is not used" : " and was not used there"),
            "see whether the wheels slip, or the vehicle was carried"};
  }
  const double error = std::max(std::abs(trust.last.scale - 1.0), std::abs(trust.last.yaw_scale - 1.0));
  if (error > options.max_scale_error) {
    return {"odometry", FindingStatus::kNote, "odometry is a little off, which is corrected for: " + scales,
            "calibrate the wheels' radius and track"};
  }
  return {"odometry", FindingStatus::kOk, "odometry agrees with the images: " + scales, ""};
}

Finding FindingOfOffset(const OdometryTrust& trust, const DiagnosisOptions& options) {
  const double offset_s = trust.time_offset_s;
  if (offset_s == 0.0 && trust.health == OdometryHealth::kLearning) {
    return {"clock", FindingStatus::kUnknown, "not enough was driven yet to compare the clocks of images and odometry",
            "drive a loop of some metres, with turns both ways"};
  }
  if (std::abs(offset_s) <= options.max_offset_s) {
    return {"clock", FindingStatus::kOk, "no difference between the clocks of images and odometry was seen", ""};
  }
  return {"clock", FindingStatus::kNote,
          FormatSentence("odometry is stamped %.0f ms %s than the images, which is compensated",
                         1e3 * std::abs(offset_s), offset_s > 0.0 ? "later" : "earlier"),
          "synchronize the clocks, or stamp images when they are exposed"};
}

// what: "odometry messages", "images".
std::optional<Finding> FindingOfBackward(const StampSeries& stamps, const char* what, const DiagnosisOptions& options) {
  const std::size_t backward = stamps.CountBackward();
  const double back_s = stamps.LargestStepBackS();
  if (back_s <= options.max_stamp_lag_s &&
      static_cast<double>(backward) <= options.max_backward_share * static_cast<double>(stamps.size())) {
    return std::nullopt;
  }
  const StampRange range = stamps.Range();
  return Finding{
      "clock", FindingStatus::kWrong,
      FormatSentence("%zu of %zu %s are not later than the one before, by up to %.1f s (stamps are from %.1f "
                     "to %.1f s)",
                     backward, stamps.size(), what, back_s, ToSeconds(range.first_ns), ToSeconds(range.last_ns)),
      "stamp each once, by a clock that is not set while driving; see whether two senders use one name"};
}

// Stamps that can't be right, whatever the images show.
std::optional<Finding> FindingOfStamps(const DriveRecord& record, const DiagnosisOptions& options) {
  const StampSeries& odometry = record.odometry_stamps();
  if (!record.frames().empty()) {
    const bool silent = record.frames_since_odometry() > options.max_silent_images;
    const auto apart =
        CompareClocks(record.frame_stamps().Range(), odometry.Range(), "odometry", options.max_stamp_lag_s);
    if (apart && (!silent || apart->of_other_scale)) {
      return Finding{"clock", FindingStatus::kWrong, apart->sentence, apart->cure};
    }
  }
  const auto backward = FindingOfBackward(odometry, "odometry messages", options);
  return backward ? backward : FindingOfBackward(record.frame_stamps(), "images", options);
}

std::optional<Finding> FindingOfRate(const DriveRecord& record, const DiagnosisOptions& options) {
  std::vector<double> steps_s = record.odometry_stamps().StepsS();
  if (record.frames_since_odometry() > options.max_silent_images) {
    return Finding{"odometry", FindingStatus::kNote,
                   FormatSentence("no odometry came with the last %zu images", record.frames_since_odometry()),
                   "see whether its driver still runs"};
  }
  if (steps_s.empty()) {
    return std::nullopt;
  }
  std::sort(steps_s.begin(), steps_s.end());
  const double median_s = steps_s[steps_s.size() / 2];
  if (median_s > options.max_interval_s) {
    return Finding{"clock", FindingStatus::kWrong, FormatSentence("odometry is stamped every %.1f s", median_s),
                   "stamps are in seconds: see whether they count milliseconds"};
  }
  if (steps_s.back() > options.max_gap_s) {
    const std::string sentence =
        median_s > options.max_gap_s
            ? FormatSentence("odometry comes every %.1f s only", median_s)
            : FormatSentence("odometry comes every %.2f s, with a gap of %.1f s", median_s, steps_s.back());
    return Finding{"odometry", FindingStatus::kNote, sentence + ": the pose is not propagated for so long",
                   "send it ten times per second or more, also at standstill"};
  }
  return std::nullopt;
}

}  // namespace

std::vector<Finding> FindingsOfOdometry(const DriveRecord& record, const DiagnosisOptions& options) {
  std::vector<Finding> findings;
  if (record.odometry_stamps().empty()) {
    findings.push_back({"odometry", FindingStatus::kNote,
                        "there is no odometry: between images, and where they fail, the pose is unknown",
                        "send it if there is any"});
    if (const std::optional<Finding> backward = FindingOfBackward(record.frame_stamps(), "images", options)) {
      findings.push_back(*backward);
    }
    return findings;
  }
  const std::optional<Finding> rate = FindingOfRate(record, options);
  if (const std::optional<Finding> stamps = FindingOfStamps(record, options)) {
    findings.push_back({"odometry", FindingStatus::kUnknown,
                        "odometry can't be compared with the images before its stamps are right", ""});
    findings.push_back(*stamps);
    return findings;
  }
  const TrustOverDrive trust = FollowTrust(record);
  findings.push_back(FindingOfDirection(trust, record.frames().size(), options));
  if (rate) {
    findings.push_back(*rate);
  }
  if (!rate || rate->about != "clock") {
    findings.push_back(FindingOfOffset(trust.last, options));
  }
  return findings;
}

}  // namespace floorloc
