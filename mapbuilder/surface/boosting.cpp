// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/boosting.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "core/geometry/option_check.h"
#include "mapbuilder/batch/parallel.h"

namespace floorloc {
namespace {

// What does not change from round to round.
struct TrainingSet {
  std::vector<int> labels;
  std::vector<SampleMatrix> rows;      // of each input
  std::vector<std::vector<char>> has;  // of each input and segment
};

std::vector<SegmentFeatures> FeaturesOf(std::span<const LabelledSegment> segments) {
  std::vector<SegmentFeatures> features;
  for (const LabelledSegment& segment : segments) {
    features.push_back(segment.features);
  }
  return features;
}

TrainingSet MakeTrainingSet(std::span<const LabelledSegment> segments, const std::vector<SvmInput>& inputs) {
  TrainingSet set;
  const std::vector<SegmentFeatures> features = FeaturesOf(segments);
  for (const LabelledSegment& segment : segments) {
    set.labels.push_back(segment.label);
  }
  for (const SvmInput& input : inputs) {
    set.rows.push_back(input.Rows(features));
    std::vector<char> has;
    for (const SegmentFeatures& segment : features) {
      has.push_back(input.Has(segment) ? 1 : 0);
    }
    set.has.push_back(std::move(has));
  }
  return set;
}

// Weights of all (segment, class): every class of segments weighs the same.
Eigen::MatrixXd InitialWeights(const std::vector<int>& labels, int class_count) {
  std::vector<double> members(static_cast<std::size_t>(class_count), 0.0);
  for (const int label : labels) {
    members[static_cast<std::size_t>(label)] += 1.0;
  }
  Eigen::MatrixXd weights(static_cast<Eigen::Index>(labels.size()), class_count);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    weights.row(static_cast<Eigen::Index>(i)).setConstant(1.0 / members[static_cast<std::size_t>(labels[i])]);
  }
  return weights / weights.sum();
}

// Draws segments that have the input, with replacement, by their weight over all classes: at most half as many as there
// are, so that others are left to judge by.
std::vector<std::size_t> Draw(const Eigen::MatrixXd& weights, const std::vector<char>& has, int count,
                              std::mt19937_64* random) {
  std::vector<double> ends;
  double sum = 0.0;
  for (std::size_t i = 0; i < has.size(); ++i) {
    sum += has[i] != 0 ? weights.row(static_cast<Eigen::Index>(i)).sum() : 0.0;
    ends.push_back(sum);
  }
  const auto most = std::max<std::ptrdiff_t>(std::count(has.begin(), has.end(), 1) / 2, 1);
  std::vector<std::size_t> drawn;
  for (int i = 0; i < std::min<std::ptrdiff_t>(count, most) && sum > 0.0; ++i) {
    const double at = sum * (static_cast<double>((*random)() >> 11U) * 0x1.0p-53);
    const auto found = std::upper_bound(ends.begin(), ends.end(), at);
    drawn.push_back(std::min(static_cast<std::size_t>(found - ends.begin()), has.size() - 1));
  }
  std::sort(drawn.begin(), drawn.end());
  drawn.erase(std::unique(drawn.begin(), drawn.end()), drawn.end());
  return drawn;
}

KernelSvm TrainOn(const TrainingSet& set, std::size_t input, const std::vector<std::size_t>& drawn, int class_count,
                  const SvmParameters& parameters) {
  SampleMatrix samples(static_cast<Eigen::Index>(drawn.size()), set.rows[input].cols());
  std::vector<int> labels;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    samples.row(static_cast<Eigen::Index>(i)) = set.rows[input].row(static_cast<Eigen::Index>(drawn[i]));
    labels.push_back(set.labels[drawn[i]]);
  }
  return TrainKernelSvm(samples, labels, class_count, parameters);
}

// A hypothesis with what it says of the training set.
struct Candidate {
  WeakSvm weak;
  Eigen::MatrixXd says;  // segments x classes
  double z = std::numeric_limits<double>::infinity();
};

// Confidences of the blocks: 0.5 ln((W+ + e) / (W- + e)), equations (12) and (13) of Schapire and Singer, measured on
// the segments that the machine was not trained with: those it knows by heart.
void Rate(const TrainingSet& set, const Eigen::MatrixXd& weights, const std::vector<std::size_t>& drawn,
          const Eigen::MatrixXf& decisions, Candidate* candidate) {
  const auto classes = static_cast<int>(weights.cols());
  const std::vector<char>& has = set.has[static_cast<std::size_t>(candidate->weak.input)];
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(kDecisionBlocks, classes);
  Eigen::MatrixXd wrong = right;
  double silent = 0.0;  // nothing is said of them: their weight stays
  double judged = 0.0;
  for (std::size_t i = 0; i < has.size(); ++i) {
    if (std::binary_search(drawn.begin(), drawn.end(), i)) {
      continue;
    }
    const auto row = static_cast<Eigen::Index>(i);
    judged += weights.row(row).sum();
    for (int c = 0; c < classes; ++c) {
      if (has[i] == 0) {
        silent += weights(row, c);
      } else {
        (set.labels[i] == c ? right : wrong)(DecisionBlock(decisions(row, c)), c) += weights(row, c);
      }
    }
  }
  const double smoothing = 1.0 / static_cast<double>(weights.size());
  candidate->z = (silent + 2.0 * (right.array() * wrong.array()).sqrt().sum()) / judged;
  candidate->weak.confidences =
      (0.5 * ((right.array() + smoothing) / (wrong.array() + smoothing)).log()).cast<float>().matrix();
  candidate->says = Eigen::MatrixXd::Zero(weights.rows(), classes);
  for (std::size_t i = 0; i < has.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (int c = 0; c < classes && has[i] != 0; ++c) {
      candidate->says(row, c) = candidate->weak.confidences(DecisionBlock(decisions(row, c)), c);
    }
  }
}

// Schapire and Singer, figure 3: D(i, l) exp(-Y_i[l] h(x_i, l)) / Z.
void Reweight(const std::vector<int>& labels, const Eigen::MatrixXd& says, Eigen::MatrixXd* weights) {
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    for (int c = 0; c < static_cast<int>(weights->cols()); ++c) {
      (*weights)(row, c) *= std::exp(labels[i] == c ? -says(row, c) : says(row, c));
    }
  }
  *weights /= weights->sum();
}

}  // namespace

void BoostingOptions::Check() const {
  RequireOption(rounds >= 1 && rounds <= 10'000, "rounds must be 1 to 10000");
  RequireOption(threads >= 0, "threads must be 0 (one per core) or more");
  RequireOption(weak_samples >= 10 && weak_samples <= 100'000, "weak_samples must be 10 to 100000");
}

SvmInput Standardise(std::vector<FeatureGroup> groups, std::span<const LabelledSegment> segments) {
  SvmInput input{std::move(groups), {}, {}};
  const auto size = static_cast<std::size_t>(input.size());
  input.mean.assign(size, 0.0F);
  input.scale.assign(size, 1.0F);
  std::vector<SegmentFeatures> having;
  for (const LabelledSegment& segment : segments) {
    if (input.Has(segment.features)) {
      having.push_back(segment.features);
    }
  }
  if (having.empty()) {
    return input;
  }
  const Eigen::MatrixXd rows = input.Rows(having).cast<double>();
  const Eigen::RowVectorXd mean = rows.colwise().mean();
  const Eigen::RowVectorXd variance = (rows.rowwise() - mean).array().square().colwise().mean();
  for (std::size_t i = 0; i < size; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    constexpr double kLeast = 1e-9;  // what does not vary in training says nothing
    input.mean[i] = static_cast<float>(mean(column));
    input.scale[i] = variance(column) < kLeast ? 0.0F : static_cast<float>(1.0 / std::sqrt(variance(column)));
  }
  return input;
}

BoostedSvm Boost(std::span<const LabelledSegment> segments, int class_count, std::vector<SvmInput> inputs,
                 std::span<const SvmParameters> parameters, const BoostingOptions& options) {
  options.Check();
  const TrainingSet set = MakeTrainingSet(segments, inputs);
  BoostedSvm boosted{class_count, std::move(inputs), {}};
  Eigen::MatrixXd weights = InitialWeights(set.labels, class_count);
  std::mt19937_64 random(options.seed);
  const std::size_t inputs_count = boosted.inputs.size();
  for (int round = 0; round < options.rounds; ++round) {
    std::vector<std::vector<std::size_t>> drawn;
    for (std::size_t input = 0; input < inputs_count; ++input) {
      drawn.push_back(Draw(weights, set.has[input], options.weak_samples, &random));
    }
    std::vector<Candidate> candidates(inputs_count);
    ParallelFor(static_cast<int>(inputs_count), options.threads, [&](int i) {
      const auto input = static_cast<std::size_t>(i);
      if (!drawn[input].empty()) {
        Candidate& candidate = candidates[input];
        candidate.weak.input = i;
        candidate.weak.svm = TrainOn(set, input, drawn[input], class_count, parameters[input]);
        Rate(set, weights, drawn[input], candidate.weak.svm.Decide(set.rows[input]), &candidate);
      }
    });
    const auto best = std::min_element(candidates.begin(), candidates.end(),
                                       [](const Candidate& a, const Candidate& b) { return a.z < b.z; });
    RequireOption(best->says.size() > 0, "the segments must have a group of features that is asked for");
    Reweight(set.labels, best->says, &weights);
    boosted.weak.push_back(std::move(best->weak));
  }
  return boosted;
}

BoostedSvm TrainSingle(std::span<const LabelledSegment> segments, int class_count, SvmInput input,
                       const SvmParameters& parameters, int max_samples) {
  std::vector<SvmInput> inputs = {std::move(input)};
  const TrainingSet set = MakeTrainingSet(segments, inputs);
  std::vector<std::size_t> having;
  for (std::size_t i = 0; i < set.labels.size(); ++i) {
    if (set.has[0][i] != 0) {
      having.push_back(i);
    }
  }
  std::vector<std::size_t> chosen;
  const std::size_t count = std::min(having.size(), static_cast<std::size_t>(max_samples));
  for (std::size_t i = 0; i < count; ++i) {
    chosen.push_back(having[i * having.size() / count]);
  }
  BoostedSvm single{class_count, std::move(inputs), {}};
  single.weak.push_back({0, TrainOn(set, 0, chosen, class_count, parameters), {}});
  return single;
}

}  // namespace floorloc
