// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/heights/height_graph.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>

#include "core/geometry/option_check.h"
#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

constexpr int kReweightings = 12;

// The loss tightens from round to round (graduated non-convexity), so that wrong links do not hold the first solution.
constexpr double kFirstLoosening = 64.0;

}  // namespace

void HeightGraphOptions::Check() const {
  RequireOption(prior_sigma > 0.0, "prior_sigma must be positive");
  RequireOption(loss_sigmas > 0.0, "loss_sigmas must be positive");
}

std::vector<int> LinkedGroups(int frames, const std::vector<ScaleLink>& links) {
  std::vector<Link> plain(links.size());
  std::transform(links.begin(), links.end(), plain.begin(), [](const ScaleLink& link) {
    Link joined;
    joined.first = link.first;
    joined.second = link.second;
    return joined;
  });
  return FindComponents(frames, plain);
}

std::vector<double> SolveHeights(int frames, const std::vector<ScaleLink>& links, const HeightGraphOptions& options) {
  options.Check();
  Eigen::VectorXd log_height = Eigen::VectorXd::Zero(frames);
  const double prior = 1.0 / (options.prior_sigma * options.prior_sigma);
  double loosening = kFirstLoosening;
  for (int round = 0; round < kReweightings; ++round) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(frames);
    for (int i = 0; i < frames; ++i) {
      entries.emplace_back(i, i, prior);
    }
    for (const ScaleLink& link : links) {
      const double measured = std::log(link.first_from_second.scale());
      const double sigma = link.first_from_second.log_sigma;
      const double off =
          (log_height[link.second] - log_height[link.first] - measured) / (loosening * options.loss_sigmas * sigma);
      const double weight = (round == 0 ? 1.0 : 1.0 / (1.0 + off * off)) / (sigma * sigma);
      entries.emplace_back(link.first, link.first, weight);
      entries.emplace_back(link.second, link.second, weight);
      entries.emplace_back(link.first, link.second, -weight);
      entries.emplace_back(link.second, link.first, -weight);
      right[link.first] -= weight * measured;
      right[link.second] += weight * measured;
    }
    Eigen::SparseMatrix<double> normal(frames, frames);
    normal.setFromTriplets(entries.begin(), entries.end());
    log_height = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(normal).solve(right);
    loosening = std::max(1.0, 0.5 * loosening);
  }
  return {log_height.begin(), log_height.end()};
}

}  // namespace floorloc
