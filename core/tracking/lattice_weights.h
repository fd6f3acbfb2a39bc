// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace floorloc {

/// Probabilities of the places of a lattice, and of being at none. Places that are not listed are all as likely; places
/// are multiples of the lattice's basis. A frame scores places: at a wrong one the score s is standard normal, at the
/// right one its mean is c times the expected score e. With c half-normal and the same for all frames, the likelihood
/// ratio of a place after many frames depends on sum(e s) and sum(e^2) only. Its expectation at a wrong place stays 1,
/// so that a wrong place hardly ever becomes probable, however long one looks (Ville 1939).
class LatticeWeights {
 public:
  /// gain_sigma: standard deviation of c.
  explicit LatticeWeights(double gain_sigma) : gain_sigma_(gain_sigma) {}

  /// listed: sorted by IsBefore. on_map: number of all places; they are equally likely. p_elsewhere: probability of
  /// being at none; a place that is asked for when all are listed was no place at the start, and is less likely by it.
  void Start(const std::vector<Eigen::Vector2i>& listed, double on_map, double p_elsewhere);
  void Clear() { places_.clear(); }

  /// The vehicle moved to the same multiples with the first log density, by a step of the lattice with those of
  /// `steps`.
  void Spread(double log_stays, const std::vector<std::pair<Eigen::Vector2i, double>>& steps);
  /// A vehicle may be anywhere on the lattice, with this probability.
  void Slip(double probability);
  /// Weights being at no place: the log density of what was seen there, relative to that of Spread(); p_moved: that it
  /// was moved away since the last time. All weights then sum to 1.
  void WeighElsewhere(double log_density, double p_moved);
  /// information: of how much of the view is new, 0 to 1.
  void AddScore(const Eigen::Vector2i& at, double score, double expected, double information);
  /// Multiplies the weight of one place, or of all but one.
  void Multiply(const Eigen::Vector2i& at, double log_factor);
  void MultiplyOthers(const Eigen::Vector2i& but, double log_factor);
  /// Lists the best place only where all others together are less likely than this.
  void Shorten(double sure_p_elsewhere, double least_p_elsewhere);

  struct Weight {
    Eigen::Vector2i at = Eigen::Vector2i::Zero();
    double probability = 0.0;
  };
  /// Of the listed places, in the order of the list.
  std::vector<Weight> Listed() const;
  /// The likeliest one; there must be one. p_elsewhere: that it is not there.
  Eigen::Vector2i Best(double* p_elsewhere) const;
  bool empty() const { return places_.empty(); }
  double ProbabilityOfNone() const;

  static bool IsBefore(const Eigen::Vector2i& a, const Eigen::Vector2i& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  }

 private:
  struct Place {
    Eigen::Vector2i at = Eigen::Vector2i::Zero();
    double log_prior = 0.0;
    double product = 0.0;      // sum of e s
    double information = 0.0;  // sum of e^2
  };

  double LogLikelihood(const Place& place) const;
  double LogWeight(const Place& place) const { return place.log_prior + LogLikelihood(place); }
  void SetLogWeight(double log_weight, Place* place) const { place->log_prior = log_weight - LogLikelihood(*place); }
  double LogSum() const;
  const Place* Find(const Eigen::Vector2i& at) const;
  Place* FindOrList(const Eigen::Vector2i& at);

  double gain_sigma_;
  std::vector<Place> places_;  // sorted
  double others_ = 0.0;        // number of places that are not listed
  double log_weight_of_other_ = 0.0;
  double log_weight_of_none_ = 0.0;
  double log_entering_ = 0.0;
};

}  // namespace floorloc
