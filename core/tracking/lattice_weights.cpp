// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/lattice_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace floorloc {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();

double LogAdd(double a, double b) {
  const double high = std::max(a, b);
  return high == kNever ? kNever : high + std::log1p(std::exp(std::min(a, b) - high));
}

// Of a standard normal variable below x.
double LogNormalCdf(double x) {
  constexpr double kTail = -30.0;  // below it erfc underflows
  return x < kTail ? -0.5 * x * x - std::log(-x * std::sqrt(2.0 * std::numbers::pi))
                   : std::log(0.5 * std::erfc(-x / std::numbers::sqrt2));
}

}  // namespace

void LatticeWeights::Start(const std::vector<Eigen::Vector2i>& listed, double on_map, double p_elsewhere) {
  log_weight_of_other_ = std::log((1.0 - p_elsewhere) / on_map);
  log_weight_of_none_ = std::log(p_elsewhere);
  log_entering_ = std::log(p_elsewhere);
  others_ = std::max(0.0, on_map - static_cast<double>(listed.size()));
  places_.clear();
  for (const Eigen::Vector2i& at : listed) {
    places_.push_back({at, log_weight_of_other_});
  }
}

// log of the mean of exp(c sum(e s) - c^2 sum(e^2) / 2) over c.
double LatticeWeights::LogLikelihood(const Place& place) const {
  const double variance = gain_sigma_ * gain_sigma_;
  const double narrowing = 1.0 + variance * place.information;
  return std::numbers::ln2 - 0.5 * std::log(narrowing) + 0.5 * variance * place.product * place.product / narrowing +
         LogNormalCdf(place.product * gain_sigma_ / std::sqrt(narrowing));
}

double LatticeWeights::LogSum() const {
  double sum = log_weight_of_none_;
  for (const Place& place : places_) {
    sum = LogAdd(sum, LogWeight(place));
  }
  return others_ > 0.0 ? LogAdd(sum, std::log(others_) + log_weight_of_other_) : sum;
}

const LatticeWeights::Place* LatticeWeights::Find(const Eigen::Vector2i& at) const {
  const auto found =
      std::lower_bound(places_.begin(), places_.end(), at,
                       [](const Place& place, const Eigen::Vector2i& wanted) { return IsBefore(place.at, wanted); });
  return found != places_.end() && found->at == at ? &*found : nullptr;
}

LatticeWeights::Place* LatticeWeights::FindOrList(const Eigen::Vector2i& at) {
  const auto found =
      std::lower_bound(places_.begin(), places_.end(), at,
                       [](const Place& place, const Eigen::Vector2i& wanted) { return IsBefore(place.at, wanted); });
  if (found != places_.end() && found->at == at) {
    return &*found;
  }
  const double log_weight = log_weight_of_other_ + (others_ > 0.0 ? 0.0 : log_entering_);
  others_ = std::max(0.0, others_ - 1.0);
  return &*places_.insert(found, {at, log_weight});
}

void LatticeWeights::Spread(double log_stays, const std::vector<std::pair<Eigen::Vector2i, double>>& steps) {
  std::vector<double> weights;
  for (const Place& place : places_) {
    double weight = LogWeight(place) + log_stays;
    for (const auto& [step, log_density] : steps) {
      const Place* from = Find(place.at - step);
      const double before = from != nullptr ? LogWeight(*from) : others_ > 0.0 ? log_weight_of_other_ : kNever;
      weight = LogAdd(weight, before + log_density);
    }
    weights.push_back(weight);
  }
  for (std::size_t i = 0; i < places_.size(); ++i) {
    SetLogWeight(weights[i], &places_[i]);
  }
  log_weight_of_other_ += log_stays;
}

void LatticeWeights::Slip(double probability) {
  const double count = static_cast<double>(places_.size()) + others_;
  const double slipped = std::log(probability / std::max(1.0, count)) + LogSum();
  const double stays = std::log1p(-probability);
  for (Place& place : places_) {
    SetLogWeight(LogAdd(LogWeight(place) + stays, slipped), &place);
  }
  log_weight_of_other_ = LogAdd(log_weight_of_other_ + stays, slipped);
}

void LatticeWeights::WeighElsewhere(double log_density, double p_moved) {
  log_weight_of_none_ = LogAdd(log_weight_of_none_, std::log(p_moved)) + log_density;
  const double sum = LogSum();
  for (Place& place : places_) {
    place.log_prior -= sum;
  }
  log_weight_of_other_ -= sum;
  log_weight_of_none_ -= sum;
}

void LatticeWeights::AddScore(const Eigen::Vector2i& at, double score, double expected, double information) {
  Place* place = FindOrList(at);
  place->product += information * expected * score;
  place->information += information * expected * expected;
}

void LatticeWeights::Multiply(const Eigen::Vector2i& at, double log_factor) { FindOrList(at)->log_prior += log_factor; }

void LatticeWeights::MultiplyOthers(const Eigen::Vector2i& but, double log_factor) {
  const Place* kept = FindOrList(but);
  for (Place& place : places_) {
    place.log_prior += &place == kept ? 0.0 : log_factor;
  }
  log_weight_of_other_ += log_factor;
  log_weight_of_none_ += log_factor;
}

void LatticeWeights::Shorten(double sure_p_elsewhere, double least_p_elsewhere) {
  double p_elsewhere = 1.0;
  const Eigen::Vector2i best = Best(&p_elsewhere);
  if (p_elsewhere > sure_p_elsewhere) {
    return;
  }
  const double sum = LogSum();
  others_ += static_cast<double>(places_.size()) - 1.0;
  log_weight_of_other_ = std::log(std::max(p_elsewhere, least_p_elsewhere) / std::max(1.0, others_));
  log_weight_of_none_ = std::max(log_weight_of_none_ - sum, std::log(least_p_elsewhere));
  places_.assign(1, {best, std::log1p(-p_elsewhere) - LogLikelihood({})});
}

std::vector<LatticeWeights::Weight> LatticeWeights::Listed() const {
  const double sum = LogSum();
  std::vector<Weight> weights;
  for (const Place& place : places_) {
    weights.push_back({place.at, std::exp(LogWeight(place) - sum)});
  }
  return weights;
}

Eigen::Vector2i LatticeWeights::Best(double* p_elsewhere) const {
  const auto best = std::max_element(places_.begin(), places_.end(),
                                     [this](const Place& a, const Place& b) { return LogWeight(a) < LogWeight(b); });
  double others =
      others_ > 0.0 ? LogAdd(log_weight_of_none_, std::log(others_) + log_weight_of_other_) : log_weight_of_none_;
  for (auto place = places_.begin(); place != places_.end(); ++place) {
    others = place == best ? others : LogAdd(others, LogWeight(*place));
  }
  *p_elsewhere = std::exp(others - LogAdd(others, LogWeight(*best)));
  return best->at;
}

double LatticeWeights::ProbabilityOfNone() const { return std::exp(log_weight_of_none_ - LogSum()); }

}  // namespace floorloc
