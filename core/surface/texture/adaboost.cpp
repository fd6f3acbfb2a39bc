// SPDX-License-Identifier: Apache-2.0
#include "core/surface/texture/adaboost.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

constexpr int kFeatures = static_cast<int>(TextureFeatures::SizeAtCompileTime);

// Weighted samples, in units in which the features are of a like size.
struct WeightedSamples {
  std::vector<TextureFeatures> x;
  std::vector<int> y;
  std::vector<double> weight;  // adds up to 1
};

struct Candidate {
  TextureFeatures weights;
  int sign = 1;
  double error = 1.0;
};

// Of the classifier and its opposite the better one.
Candidate WithBetterSign(const TextureFeatures& weights, double error) {
  return error <= 0.5 ? Candidate{weights, 1, error} : Candidate{weights, -1, 1.0 - error};
}

Candidate Evaluate(const WeightedSamples& samples, const TextureFeatures& weights) {
  double error = 0.0;
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    const int decided = weights.dot(samples.x[i]) > 0.0 ? 1 : -1;
    error += decided != samples.y[i] ? samples.weight[i] : 0.0;
  }
  return WithBetterSign(weights, error);
}

// The best classifier along one weight: as it grows, each sample changes sides where its sum passes zero.
class LineSearch {
 public:
  explicit LineSearch(const WeightedSamples& samples) : samples_(samples) {}

  Candidate Best(const TextureFeatures& weights, int feature) {
    turns_.clear();
    TextureFeatures rest = weights;
    rest(feature) = 0.0;
    double error = 0.0;  // with the weight at minus infinity
    for (std::size_t i = 0; i < samples_.x.size(); ++i) {
      const double slope = samples_.x[i](feature);
      const double sum = rest.dot(samples_.x[i]);
      const bool positive = slope == 0.0 && sum > 0.0;
      error += positive != (samples_.y[i] > 0) ? samples_.weight[i] : 0.0;
      if (slope > 0.0) {
        turns_.emplace_back(-sum / slope, samples_.y[i] > 0 ? -samples_.weight[i] : samples_.weight[i]);
      }
    }
    std::sort(turns_.begin(), turns_.end());
    Candidate best = Evaluate(samples_, weights);
    for (std::size_t i = 0; i < turns_.size(); ++i) {
      error += turns_[i].second;
      const double next = i + 1 < turns_.size() ? turns_[i + 1].first : turns_[i].first + 1.0;
      const double at = 0.5 * (turns_[i].first + next);
      if (std::min(error, 1.0 - error) < best.error - kEpsilon && turns_[i].first < at && at < next) {
        TextureFeatures changed = weights;
        changed(feature) = at;
        best = WithBetterSign(changed, error);
      }
    }
    return best;
  }

 private:
  static constexpr double kEpsilon = 1e-12;  // rounding is no improvement

  const WeightedSamples& samples_;
  std::vector<std::pair<double, double>> turns_;  // where a sample changes sides, and the change of the error
};

TextureFeatures LeastSquares(const WeightedSamples& samples) {
  constexpr double kRidge = 1e-9;
  Eigen::Matrix4d normal = kRidge * Eigen::Matrix4d::Identity();
  TextureFeatures right = TextureFeatures::Zero();
  for (std::size_t i = 0; i < samples.x.size(); ++i) {
    normal += samples.weight[i] * samples.x[i] * samples.x[i].transpose();
    right += samples.weight[i] * samples.y[i] * samples.x[i];
  }
  return normal.ldlt().solve(right);
}

Candidate Descend(LineSearch* search, Candidate from) {
  constexpr int kMaxPasses = 10;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const double before = from.error;
    for (int feature = 0; feature < kFeatures; ++feature) {
      from = search->Best(from.weights, feature);
    }
    if (from.error >= before) {
      break;
    }
  }
  return from;
}

Candidate TrainWeak(const WeightedSamples& samples, int starts, std::mt19937* random) {
  LineSearch search(samples);
  Candidate best = Descend(&search, Evaluate(samples, LeastSquares(samples)));
  for (int start = 0; start < starts; ++start) {
    TextureFeatures direction;
    for (double& weight : direction) {
      // Not std::normal_distribution: the same on every system.
      weight = static_cast<double>((*random)()) / static_cast<double>(std::mt19937::max()) - 0.5;
    }
    const Candidate found = Descend(&search, Evaluate(samples, direction));
    best = found.error < best.error ? found : best;
  }
  return best;
}

// Root mean squares of the features; 1 where all are 0.
TextureFeatures ScaleOf(std::span<const TextureSample> samples) {
  TextureFeatures squares = TextureFeatures::Zero();
  for (const TextureSample& sample : samples) {
    squares += sample.features.cwiseAbs2();
  }
  const TextureFeatures scale = (squares / static_cast<double>(samples.size())).cwiseSqrt();
  return (scale.array() > 0.0).select(scale, 1.0);
}

WeightedSamples Prepare(std::span<const TextureSample> samples, const TextureFeatures& scale) {
  WeightedSamples prepared;
  for (const TextureSample& sample : samples) {
    prepared.x.emplace_back(sample.features.cwiseQuotient(scale));
    prepared.y.push_back(sample.label);
    prepared.weight.push_back(1.0 / static_cast<double>(samples.size()));
  }
  return prepared;
}

// D(i) exp(-alpha y h(x)), normalised.
void Reweight(const Candidate& chosen, double alpha, WeightedSamples* samples) {
  for (std::size_t i = 0; i < samples->x.size(); ++i) {
    const int decided = chosen.sign * chosen.weights.dot(samples->x[i]) > 0.0 ? 1 : -1;
    samples->weight[i] *= std::exp(-alpha * samples->y[i] * decided);
  }
  const double sum = std::accumulate(samples->weight.begin(), samples->weight.end(), 0.0);
  for (double& weight : samples->weight) {
    weight /= sum;
  }
}

}  // namespace

double StrongClassifier::Score(const TextureFeatures& x) const {
  double vote = 0.0;
  double sum = 0.0;
  for (const WeakClassifier& classifier : weak) {
    vote += classifier.alpha * classifier.Decide(x);
    sum += classifier.alpha;
  }
  return sum > 0.0 ? vote / sum : 0.0;
}

void AdaBoostOptions::Check() const {
  RequireOption(classifiers >= 1 && classifiers <= 1000, "classifiers must be 1 to 1000");
  RequireOption(starts >= 0 && starts <= 100, "starts must be 0 to 100");
}

StrongClassifier TrainAdaBoost(std::span<const TextureSample> samples, const AdaBoostOptions& options) {
  options.Check();
  const auto positive =
      std::count_if(samples.begin(), samples.end(), [](const TextureSample& sample) { return sample.label > 0; });
  RequireOption(positive > 0 && positive < static_cast<std::ptrdiff_t>(samples.size()),
                "the samples must be of two classes");
  constexpr double kPerfect = 1e-10;  // its reliability would be infinite
  constexpr double kChance = 0.5 - 1e-6;
  const TextureFeatures scale = ScaleOf(samples);
  WeightedSamples weighted = Prepare(samples, scale);
  std::mt19937 random(options.seed);
  StrongClassifier strong;
  for (int t = 0; t < options.classifiers; ++t) {
    const Candidate chosen = TrainWeak(weighted, options.starts, &random);
    if (chosen.error >= kChance) {
      break;
    }
    const double error = std::max(chosen.error, kPerfect);
    const double alpha = 0.5 * std::log((1.0 - error) / error);
    strong.weak.push_back({chosen.weights.cwiseQuotient(scale), chosen.sign, alpha});
    if (chosen.error < kPerfect) {
      break;
    }
    Reweight(chosen, alpha, &weighted);
  }
  const std::vector<double> curve = LearningCurve(strong, samples);
  strong.error = curve.empty() ? 0.5 : curve.back();
  return strong;
}

std::vector<double> LearningCurve(const StrongClassifier& classifier, std::span<const TextureSample> samples) {
  std::vector<double> votes(samples.size(), 0.0);
  std::vector<double> curve;
  for (const WeakClassifier& weak : classifier.weak) {
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      votes[i] += weak.alpha * weak.Decide(samples[i].features);
      wrong += (votes[i] > 0.0) != (samples[i].label > 0) ? 1U : 0U;
    }
    curve.push_back(static_cast<double>(wrong) / static_cast<double>(samples.size()));
  }
  return curve;
}

}  // namespace floorloc
