// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_agreement.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <numbers>

#include "core/io/input_error.h"
#include "core/io/stamp_range.h"

namespace floorloc {
namespace {

using Complex = std::complex<double>;

// Shorter motions do not determine scale and direction, smaller rotations not handedness.
constexpr double kMinMotionM = 0.02;
constexpr double kMinTurnRad = 0.005;

// In a tight turn, an offset of the base frame of a few centimetres changes length and direction of the motion.
constexpr double kMaxTurnRad = 0.15;

constexpr int kMinMotions = 5;
constexpr int kMinVotes = 5;

constexpr double kWarnScale = 0.03;
constexpr double kRefuseScale = 0.15;
constexpr double kWarnDirectionRad = 3.0 * std::numbers::pi / 180.0;
constexpr double kRefuseDirectionRad = 15.0 * std::numbers::pi / 180.0;
constexpr double kWarnScatter = 0.2;

// Number of sampled motions in the driving direction, each of about this share of the view, and of sideways ones.
constexpr std::size_t kSampledForward = 200;
constexpr std::size_t kSampledSideways = 60;
constexpr double kSampledShare = 0.2;

// Minimum lateral share of a sideways motion, and maximum relative error for it to vote on handedness.
constexpr double kSidewaysShare = 0.5;
constexpr double kMaxVoteError = 0.3;

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Complex Translation(const Pose2& motion) { return {motion.x(), motion.y()}; }

struct Fit {
  Complex factor;        // by_vision = factor * by_odometry
  double scatter = 0.0;  // median relative residual
};

Fit FitFactor(const std::vector<Complex>& from, const std::vector<Complex>& to) {
  std::vector<double> re;
  std::vector<double> im;
  for (std::size_t i = 0; i < from.size(); ++i) {
    re.push_back((to[i] / from[i]).real());
    im.push_back((to[i] / from[i]).imag());
  }
  Fit fit{{Median(re), Median(im)}};
  std::vector<double> left;
  for (std::size_t i = 0; i < from.size(); ++i) {
    left.push_back(std::abs(to[i] - fit.factor * from[i]) / std::abs(from[i]));
  }
  fit.scatter = Median(left);
  return fit;
}

bool IsSideways(const Pose2& motion) {
  return std::abs(motion.y()) > std::max(kMinMotionM, kSidewaysShare * motion.translation().norm());
}

// 1: right handedness, -1: mirrored, 0: inconclusive. Mirroring changes the sign of rotations and of the lateral
// motion.
int HandednessVote(const MotionPair& m, const Complex& factor) {
  const double turn = m.by_odometry.yaw();
  if (std::abs(turn) > kMinTurnRad && std::abs(turn) < 0.5 * std::numbers::pi) {
    const double vision_yaw = m.by_vision.yaw();
    return std::abs(vision_yaw) < kMinTurnRad ? 0 : (vision_yaw * turn > 0.0 ? 1 : -1);
  }
  if (!IsSideways(m.by_odometry)) {
    return 0;
  }
  const Complex way = Translation(m.by_odometry);
  const double true_error = std::abs(Translation(m.by_vision) - factor * way);
  const double mirrored_error = std::abs(Translation(m.by_vision) - factor * std::conj(way));
  if (std::min(true_error, mirrored_error) > kMaxVoteError * std::abs(factor * way)) {
    return 0;
  }
  return true_error < mirrored_error ? 1 : -1;
}

bool IsMirrored(const std::vector<MotionPair>& motions, const Complex& factor) {
  int balance = 0;
  int votes = 0;
  for (const MotionPair& m : motions) {
    const int vote = HandednessVote(m, factor);
    balance += vote;
    votes += std::abs(vote);
  }
  return votes >= kMinVotes && 2 * balance < -votes;
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

std::vector<MotionPair> MeasureMotions(const std::vector<BuildFrame>& frames, int survey, const RectM& floor,
                                       PairRegistrationOptions registration) {
  registration.run.progress = {};
  std::vector<FramePair> pairs = ForwardPairs(frames, survey, floor);
  const std::vector<FramePair> sideways = SidewaysPairs(frames, survey, floor);
  pairs.insert(pairs.end(), sideways.begin(), sideways.end());
  std::vector<MotionPair> motions;
  for (const Link& link : RegisterPairs(frames, std::vector<RectM>(frames.size(), floor), pairs, registration)) {
    const auto& first = frames[static_cast<std::size_t>(link.first)].odom_from_base;
    const auto& second = frames[static_cast<std::size_t>(link.second)].odom_from_base;
    motions.push_back({OfView(first->Between(*second), floor), OfView(link.first_from_second, floor)});
  }
  return motions;
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

void AssessAgreement(const MotionAgreement& agreement, const Survey& survey, std::vector<std::string>* warnings) {
  const std::filesystem::path file = survey.folder / "floor.yaml";
  if (agreement.motions == 0) {
    return;
  }
  if (agreement.mirrored) {
    throw InputError(file,
                     "the images turn right where odometry.tum turns left; the images or the homography are "
                     "mirrored: switch off the camera's flip, or calibrate again, or correct odometry's axes");
  }
  const std::string direction =
      "the images move in a direction turned by " + Text("%.0f", Degrees(agreement.direction_rad)) +
      " degrees against odometry.tum; the homography's axes (x forward, y left) do not fit the robot's";
  if (std::abs(agreement.direction_rad) > kRefuseDirectionRad) {
    throw InputError(file, direction + ": correct the homography, or remove odometry.tum");
  }
  const std::string scale = "the images show motions " + Text("%.3g", agreement.scale) +
                            " times as long as odometry.tum says; the homography or the odometry has the wrong scale";
  if (std::abs(std::log(agreement.scale)) > std::log1p(kRefuseScale)) {
    throw InputError(file, scale + ": measure a known length on the floor, or remove odometry.tum");
  }
  if (std::abs(agreement.direction_rad) > kWarnDirectionRad) {
    warnings->push_back(file.string() + ": " + direction);
  }
  if (std::abs(agreement.scale - 1.0) > kWarnScale) {
    warnings->push_back(file.string() + ": " + scale);
  }
  if (agreement.scatter > kWarnScatter) {
    warnings->push_back((survey.folder / "odometry.tum").string() + ": differs from the motion in the images by " +
                        Text("%.0f", 100.0 * agreement.scatter) + " % half of the time; check that both clocks agree");
  }
}

}  // namespace

MotionAgreement CompareMotions(const std::vector<MotionPair>& motions) {
  std::vector<Complex> by_odometry;
  std::vector<Complex> by_vision;
  for (const MotionPair& m : motions) {
    const double length_m = m.by_odometry.translation().norm();
    if (length_m > kMinMotionM && !IsSideways(m.by_odometry) && std::abs(m.by_odometry.yaw()) < kMaxTurnRad) {
      by_odometry.push_back(Translation(m.by_odometry));
      by_vision.push_back(Translation(m.by_vision));
    }
  }
  MotionAgreement agreement;
  if (static_cast<int>(by_odometry.size()) < kMinMotions) {
    return agreement;
  }
  const Fit fit = FitFactor(by_odometry, by_vision);
  agreement.motions = static_cast<int>(by_odometry.size());
  agreement.scale = std::abs(fit.factor);
  agreement.direction_rad = std::arg(fit.factor);
  agreement.scatter = fit.scatter;
  agreement.mirrored = IsMirrored(motions, fit.factor);
  return agreement;
}

std::vector<std::string> CheckOdometry(const FrameSet& set, const PairRegistrationOptions& registration) {
  std::vector<std::string> warnings;
  for (std::size_t s = 0; s < set.surveys.size(); ++s) {
    const Survey& survey = set.surveys[s].survey;
    if (survey.odometry.empty()) {
      continue;
    }
    const int index = static_cast<int>(s);
    CountFramesWithOdometry(set.frames, index, survey, &warnings);
    const RectM& floor = survey.camera.floor.roi;
    AssessAgreement(CompareMotions(MeasureMotions(set.frames, index, floor, registration)), survey, &warnings);
  }
  return warnings;
}

}  // namespace floorloc
