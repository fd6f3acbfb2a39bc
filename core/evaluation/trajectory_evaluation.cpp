// SPDX-License-Identifier: Apache-2.0
#include "core/evaluation/trajectory_evaluation.h"

#include <cmath>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

Trajectory Shifted(Trajectory trajectory, double offset_s) {
  for (StampedPose3& pose : trajectory) {
    pose.stamp_ns += std::llround(1e9 * offset_s);
  }
  return trajectory;
}

Trajectory Flattened(Trajectory trajectory) {
  for (StampedPose3& pose : trajectory) {
    pose = StampedPose3::FromPose2(pose.stamp_ns, pose.ToPose2());
  }
  return trajectory;
}

void CheckPairCount(const TrajectoryEvaluation& evaluation, const EvaluationOptions& options) {
  const bool one_is_enough = options.metric == ErrorMetric::kAbsolute &&
                             (options.align == AlignmentMode::kNone || options.align == AlignmentMode::kOrigin);
  const std::size_t needed = one_is_enough ? 1 : 2;
  if (evaluation.pairs.size() < needed) {
    std::ostringstream text;
    text << "only " << evaluation.pairs.size() << " of its " << evaluation.estimated_poses
         << " poses have one of the reference within " << options.max_diff_s << " s, but at least " << needed
         << " must; check that both have the same clock, or allow more";
    throw std::invalid_argument(text.str());
  }
}

Trajectory SelectSide(const std::vector<PosePair>& pairs, StampedPose3 PosePair::*side) {
  Trajectory trajectory;
  for (const PosePair& pair : pairs) {
    trajectory.push_back(pair.*side);
  }
  return trajectory;
}

void CompareMotions(const EvaluationOptions& options, TrajectoryEvaluation* evaluation) {
  const auto side = options.motions_of_reference ? &PosePair::reference : &PosePair::estimate;
  const std::vector<Motion> motions = SelectMotions(SelectSide(evaluation->pairs, side), options.motions);
  if (motions.empty()) {
    throw std::invalid_argument("has no motion as long as delta; take a smaller one, or a larger tolerance");
  }
  for (const Motion& motion : motions) {
    evaluation->error_at.push_back(motion.to);
  }
  evaluation->errors = RelativePoseErrors(evaluation->pairs, motions);
}

void ComparePoses(TrajectoryEvaluation* evaluation) {
  evaluation->errors = AbsolutePoseErrors(evaluation->pairs);
  evaluation->error_at.resize(evaluation->errors.size());
  std::iota(evaluation->error_at.begin(), evaluation->error_at.end(), 0);
}

ErrorStatistics SummarizeMember(const std::vector<PoseError>& errors, double PoseError::*member) {
  std::vector<double> values;
  for (const PoseError& error : errors) {
    values.push_back(error.*member);
  }
  return Summarize(std::move(values));
}

}  // namespace

void EvaluationOptions::Check() const {
  motions.Check();
  RequireOption(max_diff_s >= 0.0, "max_diff_s must not be negative");
  RequireOption(std::isfinite(time_offset_s), "time_offset_s must be finite");
}

TrajectoryEvaluation EvaluateTrajectory(const Trajectory& reference, const Trajectory& estimate,
                                        const EvaluationOptions& options) {
  options.Check();
  const Trajectory shifted = Shifted(estimate, options.time_offset_s);
  TrajectoryEvaluation evaluation;
  evaluation.reference_poses = reference.size();
  evaluation.estimated_poses = estimate.size();
  evaluation.pairs = options.planar ? AssociateByTime(Flattened(reference), Flattened(shifted), options.max_diff_s)
                                    : AssociateByTime(reference, shifted, options.max_diff_s);
  CheckPairCount(evaluation, options);
  evaluation.alignment = ComputeAlignment(evaluation.pairs, options.align);
  evaluation.pairs = Align(std::move(evaluation.pairs), evaluation.alignment);
  if (options.metric == ErrorMetric::kRelative) {
    CompareMotions(options, &evaluation);
  } else {
    ComparePoses(&evaluation);
  }
  evaluation.full = SummarizeMember(evaluation.errors, &PoseError::full);
  evaluation.translation = SummarizeMember(evaluation.errors, &PoseError::translation_m);
  evaluation.rotation = SummarizeMember(evaluation.errors, &PoseError::rotation_rad);
  return evaluation;
}

}  // namespace floorloc
