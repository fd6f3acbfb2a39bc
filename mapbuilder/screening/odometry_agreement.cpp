// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "core/io/input_error.h"
#include "core/io/stamp_range.h"
#include "mapbuilder/screening/odometry_reading.h"

namespace floorloc {
namespace {

constexpr int kMinMotions = 5;

constexpr double kWarnScale = 0.03;
constexpr double kRefuseScale = 0.15;
constexpr double kWarnDirectionRad = 3.0 * std::numbers::pi / 180.0;
constexpr double kRefuseDirectionRad = 15.0 * std::numbers::pi / 180.0;
constexpr double kWarnScatter = 0.2;

// Motions that scatter more have no scale and direction to be refused for.
constexpr double kMaxScatter = 0.3;

// Number of sampled motions in the driving direction, each of about this share of the view, and of sideways ones.
constexpr std::size_t kSampledForward = 200;
constexpr std::size_t kSampledSideways = 60;
constexpr double kSampledShare = 0.2;

// Where odometry's lengths choose no pairs that match: neighbours in time, and those some frames apart.
constexpr int kStrides[] = {1, 4};
constexpr std::size_t kSampledPerStride = 60;

// Lengths that differ by more are of another unit.
constexpr double kOtherUnit = 3.0;

// Minimum lateral share of a sideways motion.
constexpr double kSidewaysShare = 0.5;
constexpr double kMinSidewaysM = 0.02;

bool IsSideways(const Pose2& motion) {
  return std::abs(motion.y()) > std::max(kMinSidewaysM, kSidewaysShare * motion.translation().norm());
}

std::string Text(const char* format, double a) {
  char text[64];
  std::snprintf(text, sizeof(text), format, a);
  return text;
}

double Degrees(double rad) { return rad * 180.0 / std::numbers::pi; }

template <typename T>
std::vector<T> SpreadEvenly(const std::vector<T>& all, std::size_t count) {
  std::vector<T> sample;
  const std::size_t stride = all.size() / count + 1;
  for (std::size_t i = 0; i < all.size(); i += stride) {
    sample.push_back(all[i]);
  }
  return sample;
}

// Pairs of frames in sequence between which odometry moved by a share of the view.
std::vector<FramePair> ForwardPairs(const std::vector<BuildFrame>& frames, int survey, const RectM& floor) {
  const double step_m = kSampledShare * std::min(floor.width_m(), floor.height_m());
  std::vector<FramePair> pairs;
  int first = -1;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].survey != survey || !frames[i].odom_from_base) {
      continue;
    }
    if (first < 0) {
      first = static_cast<int>(i);
      continue;
    }
    const Pose2 motion = frames[static_cast<std::size_t>(first)].odom_from_base->Between(*frames[i].odom_from_base);
    if (motion.translation().norm() >= step_m) {
      pairs.push_back({first, static_cast<int>(i), std::nullopt, 0.0, 0.0});
      first = static_cast<int>(i);
    }
  }
  return SpreadEvenly(pairs, kSampledForward);
}

Pose2 OfView(const Pose2& motion, const RectM& floor) {
  const Pose2 base_from_view(floor.Center().x(), floor.Center().y(), 0.0);
  return base_from_view.Inverse() * motion * base_from_view;
}

// Pairs that are side by side according to odometry, as on neighbouring lanes; nearest in time first, since they
// drifted least.
std::vector<FramePair> SidewaysPairs(const std::vector<BuildFrame>& frames, int survey, const RectM& floor) {
  std::vector<std::optional<Pose2>> odom_from_base(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].survey == survey) {
      odom_from_base[i] = frames[i].odom_from_base;
    }
  }
  std::vector<FramePair> pairs =
      SelectNearbyPairs(odom_from_base, std::vector<RectM>(frames.size(), floor), NearbyOptions{});
  std::erase_if(pairs, [&](const FramePair& pair) { return !IsSideways(OfView(*pair.first_from_second, floor)); });
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const FramePair& a, const FramePair& b) { return a.second - a.first < b.second - b.first; });
  pairs.resize(std::min(pairs.size(), kSampledSideways));
  for (FramePair& pair : pairs) {
    pair.first_from_second.reset();
  }
  return pairs;
}

Pose2 OdometryBetween(const std::vector<BuildFrame>& frames, int first, int second) {
  return frames[static_cast<std::size_t>(first)].odom_from_base->Between(
      *frames[static_cast<std::size_t>(second)].odom_from_base);
}

std::vector<FramePair> TimedPairs(const std::vector<BuildFrame>& frames, int survey) {
  std::vector<int> known;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].survey == survey && frames[i].odom_from_base) {
      known.push_back(static_cast<int>(i));
    }
  }
  std::vector<FramePair> pairs;
  for (const int stride : kStrides) {
    std::vector<FramePair> apart;
    for (std::size_t i = 0; i + static_cast<std::size_t>(stride) < known.size(); ++i) {
      apart.push_back({known[i], known[i + static_cast<std::size_t>(stride)], std::nullopt, 0.0, 0.0});
    }
    const std::vector<FramePair> sample = SpreadEvenly(apart, kSampledPerStride);
    pairs.insert(pairs.end(), sample.begin(), sample.end());
  }
  return pairs;
}

// Way that odometry travelled up to each frame of a survey.
std::vector<double> Mileage(const std::vector<BuildFrame>& frames, int survey) {
  std::vector<double> mileage_m(frames.size(), 0.0);
  const BuildFrame* last = nullptr;
  double sum_m = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].survey == survey && frames[i].odom_from_base) {
      sum_m += last == nullptr ? 0.0 : last->odom_from_base->Between(*frames[i].odom_from_base).translation().norm();
      last = &frames[i];
    }
    mileage_m[i] = sum_m;
  }
  return mileage_m;
}

// Motions of a sample of pairs, odometry's multiplied by a unit where its lengths are of another order than vision's.
struct MeasuredMotions {
  std::vector<MotionPair> motions;
  double unit = 1.0;
};

// Length by vision over length by odometry, of the median pair.
double LengthRatio(const std::vector<BuildFrame>& frames, const std::vector<Link>& links) {
  std::vector<double> ratios;
  for (const Link& link : links) {
    const double said_m = OdometryBetween(frames, link.first, link.second).translation().norm();
    if (said_m > 0.0) {
      ratios.push_back(link.first_from_second.translation().norm() / said_m);
    }
  }
  if (ratios.empty()) {
    return 1.0;
  }
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::nth_element(ratios.begin(), middle, ratios.end());
  return *middle;
}

MeasuredMotions CompareLinks(const std::vector<BuildFrame>& frames, const std::vector<Link>& links,
                             const RectM& floor) {
  MeasuredMotions measured;
  if (links.empty()) {
    return measured;
  }
  const double ratio = LengthRatio(frames, links);
  measured.unit = std::abs(std::log(ratio)) > std::log(kOtherUnit) ? ratio : 1.0;
  const std::vector<double> mileage_m = Mileage(frames, frames[static_cast<std::size_t>(links.front().first)].survey);
  for (const Link& link : links) {
    const Pose2 said = OdometryBetween(frames, link.first, link.second);
    const double way_m =
        mileage_m[static_cast<std::size_t>(link.second)] - mileage_m[static_cast<std::size_t>(link.first)];
    measured.motions.push_back({OfView(Pose2(measured.unit * said.x(), measured.unit * said.y(), said.yaw()), floor),
                                OfView(link.first_from_second, floor),
                                frames[static_cast<std::size_t>(link.first)].odom_from_base->yaw(),
                                measured.unit * std::abs(way_m)});
  }
  return measured;
}

MeasuredMotions MeasureMotions(const std::vector<BuildFrame>& frames, int survey, const RectM& floor,
                               PairRegistrationOptions registration) {
  registration.run.progress = {};
  const std::vector<RectM> floors(frames.size(), floor);
  std::vector<Link> links = RegisterPairs(frames, floors, ForwardPairs(frames, survey, floor), registration);
  if (static_cast<int>(links.size()) < kMinMotions) {
    return CompareLinks(frames, RegisterPairs(frames, floors, TimedPairs(frames, survey), registration), floor);
  }
  const std::vector<Link> sideways = RegisterPairs(frames, floors, SidewaysPairs(frames, survey, floor), registration);
  links.insert(links.end(), sideways.begin(), sideways.end());
  return CompareLinks(frames, links, floor);
}

// The agreement of odometry as it is written.
MotionAgreement CompareSurvey(const FrameSet& set, int survey, const PairRegistrationOptions& registration) {
  const RectM& floor = set.surveys[static_cast<std::size_t>(survey)].survey.camera.floor.roi;
  const MeasuredMotions measured = MeasureMotions(set.frames, survey, floor, registration);
  MotionAgreement agreement = CompareMotions(measured.motions);
  agreement.scale *= measured.unit;
  return agreement;
}

void CountFramesWithOdometry(const std::vector<BuildFrame>& frames, int index, const Survey& survey,
                             std::vector<std::string>* warnings) {
  int all = 0;
  int with = 0;
  for (const BuildFrame& frame : frames) {
    all += frame.survey == index ? 1 : 0;
    with += frame.survey == index && frame.odom_from_base ? 1 : 0;
  }
  const std::string file = (survey.folder / "odometry.tum").string();
  if (all > 0 && with == 0) {
    const auto apart = CompareClocks(StampRange::Of(survey.frames), StampRange::Of(survey.odometry), "odometry");
    throw InputError(
        file, "has no pose at the time of any frame; " +
                  (apart ? apart->sentence + ": " + apart->cure : std::string("check that both use the same clock")) +
                  ", or remove it");
  }
  if (with < all) {
    warnings->push_back(file + ": has no pose at the time of " + std::to_string(all - with) + " of " +
                        std::to_string(all) + " frames");
  }
}

std::string OtherDirection(const MotionAgreement& agreement) {
  return "the images move in a direction turned by " + Text("%.0f", Degrees(agreement.direction_rad)) +
         " degrees against odometry.tum; the homography's axes (x forward, y left) do not fit the robot's";
}

std::string OtherScale(const MotionAgreement& agreement) {
  return "the images show motions " + Text("%.3g", agreement.scale) +
         " times as long as odometry.tum says; the homography or the odometry has the wrong scale";
}

// What is wrong, and its cure.
std::string Contradiction(const MotionAgreement& agreement) {
  switch (agreement.reading) {
    case OdometryReading::kMirrored:
      return "the images turn right where odometry.tum turns left; the images or the homography are mirrored: switch "
             "off the camera's flip, or calibrate again, or correct odometry's axes";
    case OdometryReading::kAsSaid:
      break;
    default:
      return "the images contradict odometry.tum: correct its axes or units, or remove it";
  }
  return std::abs(agreement.direction_rad) > kRefuseDirectionRad
             ? OtherDirection(agreement) + ": correct the homography, or odometry's axes, or remove odometry.tum"
             : OtherScale(agreement) + ": measure a known length on the floor, or remove odometry.tum";
}

bool IsRefused(const MotionAgreement& agreement) {
  return agreement.reading != OdometryReading::kAsSaid ||
         (agreement.scatter < kMaxScatter && (std::abs(agreement.direction_rad) > kRefuseDirectionRad ||
                                              std::abs(std::log(agreement.scale)) > std::log1p(kRefuseScale)));
}

// The homography may be what is wrong, unless positions and headings of odometry contradict each other.
std::filesystem::path FileToBlame(const MotionAgreement& agreement, const Survey& survey) {
  const bool either = agreement.reading == OdometryReading::kAsSaid || agreement.reading == OdometryReading::kMirrored;
  return survey.folder / (either ? "floor.yaml" : "odometry.tum");
}

void AssessAgreement(const MotionAgreement& agreement, const Survey& survey, std::vector<std::string>* warnings) {
  if (agreement.motions == 0) {
    return;
  }
  if (IsRefused(agreement)) {
    const std::string when = FitsWhen(agreement);
    throw InputError(FileToBlame(agreement, survey),
                     Contradiction(agreement) + (when.empty() ? "" : "; odometry.tum fits when " + when));
  }
  const std::string file = (survey.folder / "floor.yaml").string();
  const bool known = agreement.scatter < kMaxScatter;
  if (known && std::abs(agreement.direction_rad) > kWarnDirectionRad) {
    warnings->push_back(file + ": " + OtherDirection(agreement));
  }
  if (known && std::abs(agreement.scale - 1.0) > kWarnScale) {
    warnings->push_back(file + ": " + OtherScale(agreement));
  }
  if (agreement.scatter > kWarnScatter) {
    warnings->push_back((survey.folder / "odometry.tum").string() + ": differs from the motion in the images by " +
                        Text("%.0f", 100.0 * agreement.scatter) + " % half of the time; check that both clocks agree");
  }
}

}  // namespace

std::vector<std::string> CheckOdometry(const FrameSet& set, const PairRegistrationOptions& registration) {
  std::vector<std::string> warnings;
  for (std::size_t s = 0; s < set.surveys.size(); ++s) {
    const Survey& survey = set.surveys[s].survey;
    if (survey.odometry.empty()) {
      continue;
    }
    const int index = static_cast<int>(s);
    CountFramesWithOdometry(set.frames, index, survey, &warnings);
    AssessAgreement(CompareSurvey(set, index, registration), survey, &warnings);
  }
  return warnings;
}

}  // namespace floorloc
