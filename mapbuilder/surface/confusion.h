// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace floorloc {

/// What was marked as class r (row) and classified as class c (column), in pixels or pictures.
class Confusion {
 public:
  explicit Confusion(int classes) : counts_(Eigen::MatrixXd::Zero(classes, classes)) {}

  void Add(int marked, int classified, double count = 1.0) { counts_(marked, classified) += count; }
  void Add(const Confusion& other) { counts_ += other.counts_; }

  /// p of equation (3) in JAMRIS 2014: the share of what is marked as a class; 0 where there is none.
  double Share(int marked, int classified) const;
  /// Mean of the diagonal of the shares: the "average" of its table 2.
  double MeanShare() const;
  /// Right ones of all.
  double RightShare() const;
  double Total() const { return counts_.sum(); }
  double Count(int marked, int classified) const { return counts_(marked, classified); }
  int classes() const { return static_cast<int>(counts_.rows()); }

 private:
  Eigen::MatrixXd counts_;
};

}  // namespace floorloc
