// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/screening/odometry_steps.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "core/geometry/option_check.h"
#include "mapbuilder/placement/join_parts.h"
#include "mapbuilder/screening/odometry_step_text.h"
#include "mapbuilder/screening/standing_odometry.h"

namespace floorloc {
namespace {

// Number of confirmed steps that are registered again without a prior, to find out whether the floor repeats itself.
constexpr std::size_t kSampledForRepetition = 40;

constexpr double kUsualQuantile = 0.9;

bool Agrees(const Link& link, const FramePair& by_odometry) {
  const Pose2 off = by_odometry.first_from_second->Between(link.first_from_second);
  return off.translation().norm() <= by_odometry.radius_m && std::abs(off.yaw()) <= by_odometry.yaw_radius_rad;
}

std::vector<FramePair> WithoutPrior(std::vector<FramePair> pairs) {
  for (FramePair& pair : pairs) {
    pair.first_from_second.reset();
  }
  return pairs;
}

class StepFinder {
 public:
  StepFinder(const FrameSet& set, const PairRegistrationOptions& registration, const OdometryStepOptions& options)
      : frames_(set.frames), floors_(set.FloorsInBase()), registration_(registration), options_(options) {
    registration_.run.progress = {};
  }

  std::vector<FalseOdometryStep> Run();

 private:
  void Register();
  bool IsRepetitive() const;
  double Seconds(const FramePair& pair) const;
  double Speed(const FramePair& pair) const { return pair.first_from_second->translation().norm() / Seconds(pair); }
  double UsualSpeed(int survey) const;
  bool LeavesView(const FramePair& pair) const;

  const BuildFrame& Frame(int i) const { return frames_[static_cast<std::size_t>(i)]; }

  const std::vector<BuildFrame>& frames_;
  std::vector<RectM> floors_;
  PairRegistrationOptions registration_;
  const OdometryStepOptions& options_;
  std::vector<FramePair> confirmed_, open_;  // with odometry's motion
  std::map<int, Link> contradicting_;        // by first frame
};

void StepFinder::Register() {
  std::vector<FramePair> pairs = SelectConsecutivePairs(frames_);
  std::erase_if(pairs, [](const FramePair& pair) { return !pair.first_from_second; });
  std::set<int> near;
  for (const Link& link : RegisterPairs(frames_, floors_, pairs, registration_)) {
    near.insert(link.first);
  }
  for (const FramePair& pair : pairs) {
    (near.contains(pair.first) ? confirmed_ : open_).push_back(pair);
  }
  for (const Link& link : RegisterPairs(frames_, floors_, WithoutPrior(open_), registration_)) {
    const auto pair = std::lower_bound(open_.begin(), open_.end(), link.first,
                                       [](const FramePair& p, int first) { return p.first < first; });
    if (Agrees(link, *pair)) {
      confirmed_.push_back(*pair);
      open_.erase(pair);
    } else {
      contradicting_.emplace(link.first, link);
    }
  }
}

bool StepFinder::IsRepetitive() const {
  std::vector<FramePair> sample;
  const std::size_t stride = confirmed_.size() / kSampledForRepetition + 1;
  for (std::size_t i = 0; i < confirmed_.size(); i += stride) {
    sample.push_back(confirmed_[i]);
  }
  std::vector<Link> links = RegisterPairs(frames_, floors_, WithoutPrior(std::move(sample)), registration_);
  for (const auto& [first, link] : contradicting_) {
    links.push_back(link);
  }
  return IsRepetitiveFloor(links);
}

double StepFinder::Seconds(const FramePair& pair) const {
  return std::max(1e-3, 1e-9 * static_cast<double>(Frame(pair.second).info.stamp_ns - Frame(pair.first).info.stamp_ns));
}

// Speed that most steps of a survey keep; infinite when too few are known.
double StepFinder::UsualSpeed(int survey) const {
  constexpr std::size_t kMinSteps = 5;
  std::vector<double> speeds;
  for (const std::vector<FramePair>* pairs : {&confirmed_, &open_}) {
    for (const FramePair& pair : *pairs) {
      if (Frame(pair.first).survey == survey) {
        speeds.push_back(Speed(pair));
      }
    }
  }
  if (speeds.size() < kMinSteps) {
    return std::numeric_limits<double>::infinity();
  }
  const auto usual = speeds.begin() + static_cast<std::ptrdiff_t>(kUsualQuantile * static_cast<double>(speeds.size()));
  std::nth_element(speeds.begin(), usual, speeds.end());
  return std::max(*usual, 1e-6);
}

bool StepFinder::LeavesView(const FramePair& pair) const {
  const RectM& floor = floors_[static_cast<std::size_t>(pair.first)];
  return pair.first_from_second->translation().norm() > std::max(floor.width_m(), floor.height_m());
}

std::vector<FalseOdometryStep> StepFinder::Run() {
  Register();
  if (open_.empty()) {
    return {};
  }
  std::map<int, double> usual;
  for (const FramePair& pair : open_) {
    const int survey = Frame(pair.first).survey;
    if (!usual.contains(survey)) {
      usual[survey] = UsualSpeed(survey);
    }
  }
  const bool trust_images = contradicting_.empty() || !IsRepetitive();
  std::vector<OpenStep> open;
  for (const FramePair& pair : open_) {
    const double usual_speed = usual[Frame(pair.first).survey];
    const double times_usual = std::isfinite(usual_speed) ? Speed(pair) / usual_speed : 1.0;
    const auto link = contradicting_.find(pair.first);
    const bool seen =
        link != contradicting_.end() && (trust_images || times_usual > options_.max_times_usual_if_repetitive);
    open.push_back({pair, seen ? std::optional(link->second.first_from_second) : std::nullopt, times_usual});
  }
  std::vector<FalseOdometryStep> steps = FindStandingSteps(open, {frames_, floors_, registration_}, options_);
  std::set<int> taken;
  for (const FalseOdometryStep& step : steps) {
    taken.insert(step.first);
  }
  for (const OpenStep& step : open) {
    const bool too_fast = step.times_usual > options_.max_times_usual && LeavesView(step.pair);
    if (!taken.contains(step.pair.first) && (step.by_images || too_fast)) {
      steps.push_back(
          {step.pair.first, step.pair.second, *step.pair.first_from_second, step.by_images, step.times_usual});
    }
  }
  return steps;
}

// Where a survey's odometry continues after a false step.
struct Resumption {
  std::int64_t after_ns = 0;
  Pose2 mended_from_odom;
};

// Time of the row before odometry's largest motion between two frames.
std::int64_t TimeOfJump(const Trajectory& odometry, std::int64_t begin_ns, std::int64_t end_ns) {
  const auto earlier = [](const StampedPose3& row, std::int64_t stamp_ns) { return row.stamp_ns < stamp_ns; };
  auto row = std::lower_bound(odometry.begin(), odometry.end(), begin_ns, earlier);
  row -= row != odometry.begin() && row != odometry.end() && row->stamp_ns > begin_ns ? 1 : 0;
  std::int64_t time_ns = begin_ns;
  double largest_m = -1.0;
  for (; row != odometry.end() && std::next(row) != odometry.end() && row->stamp_ns < end_ns; ++row) {
    const double step_m = row->ToPose2().Between(std::next(row)->ToPose2()).translation().norm();
    if (step_m > largest_m) {
      largest_m = step_m;
      time_ns = row->stamp_ns;
    }
  }
  return time_ns;
}

Trajectory Moved(Trajectory odometry, const std::vector<Resumption>& resumptions) {
  std::size_t next = 0;
  Pose2 mended_from_odom;
  for (StampedPose3& row : odometry) {
    for (; next < resumptions.size() && row.stamp_ns > resumptions[next].after_ns; ++next) {
      mended_from_odom = resumptions[next].mended_from_odom;
    }
    row = next == 0 ? row : StampedPose3::FromPose2(row.stamp_ns, mended_from_odom * row.ToPose2());
  }
  return odometry;
}

}  // namespace

void OdometryStepOptions::Check() const {
  RequireOption(max_times_usual > 1.0, "max_times_usual must be above 1");
  RequireOption(max_times_usual_if_repetitive > 1.0, "max_times_usual_if_repetitive must be above 1");
  RequireOption(max_times_standing >= 0.0 && max_times_standing < 1.0, "max_times_standing must be 0 to below 1");
  RequireOption(min_standing_steps >= 1, "min_standing_steps must be 1 or more");
  RequireOption(named >= 1, "named must be 1 or more");
}

std::vector<FalseOdometryStep> FindFalseOdometrySteps(const FrameSet& set, const PairRegistrationOptions& registration,
                                                      const OdometryStepOptions& options) {
  options.Check();
  std::vector<FalseOdometryStep> steps = StepFinder(set, registration, options).Run();
  std::sort(steps.begin(), steps.end(),
            [](const FalseOdometryStep& a, const FalseOdometryStep& b) { return a.first < b.first; });
  return steps;
}

FrameSet WithoutSteps(FrameSet set, const std::vector<FalseOdometryStep>& steps) {
  std::vector<std::vector<Resumption>> resumptions(set.surveys.size());
  std::map<int, Pose2> mended_from_odom;  // by survey
  auto step = steps.begin();
  Pose2 motion;  // by odometry, of the last true step
  for (std::size_t i = 0; i < set.frames.size(); ++i) {
    BuildFrame& frame = set.frames[i];
    if (!frame.odom_from_base) {
      continue;
    }
    const auto [entry, is_new] = mended_from_odom.try_emplace(frame.survey);
    Pose2& mended = entry->second;
    motion = is_new ? Pose2() : motion;
    if (step != steps.end() && step->second == static_cast<int>(i)) {
      const BuildFrame& before = set.frames[static_cast<std::size_t>(step->first)];
      const Pose2 here = *before.odom_from_base * step->by_images.value_or(motion);
      mended = here * frame.odom_from_base->Inverse();
      frame.odometry_breaks = !step->by_images;
      const auto survey = static_cast<std::size_t>(frame.survey);
      resumptions[survey].push_back(
          {TimeOfJump(set.surveys[survey].survey.odometry, before.info.stamp_ns, frame.info.stamp_ns), mended});
      frame.odom_from_base = here;
      ++step;
      continue;
    }
    frame.odom_from_base = mended * *frame.odom_from_base;
    if (i > 0 && set.frames[i - 1].survey == frame.survey && set.frames[i - 1].odom_from_base) {
      motion = set.frames[i - 1].odom_from_base->Between(*frame.odom_from_base);
    }
  }
  for (std::size_t s = 0; s < set.surveys.size(); ++s) {
    set.surveys[s].survey.odometry = Moved(std::move(set.surveys[s].survey.odometry), resumptions[s]);
  }
  return set;
}

std::vector<std::string> MendOdometry(const PairRegistrationOptions& registration, const OdometryStepOptions& options,
                                      FrameSet* set) {
  const std::vector<FalseOdometryStep> steps = FindFalseOdometrySteps(*set, registration, options);
  std::vector<std::string> sentences = NameSteps(steps, *set, options.named);
  *set = WithoutSteps(std::move(*set), steps);
  return sentences;
}

}  // namespace floorloc
