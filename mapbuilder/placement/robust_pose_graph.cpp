// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/robust_pose_graph.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace floorloc {
namespace {

// Links with a larger residual, in standard deviations, are false.
constexpr double kMaxSigma = 8.0;

// A smaller share of outliers does not bias the Cauchy optimum, and the many solves of graduated non-convexity are
// skipped.
constexpr double kFewShare = 0.01;

constexpr double kMuFactor = 1.4;
constexpr int kMaxRounds = 60;

std::vector<double> SquaredResiduals(const PoseGraph& graph) {
  std::vector<double> squares;
  squares.reserve(graph.links.size());
  for (const Link& link : graph.links) {
    const double r = LinkResidual(link, graph.map_from_base[static_cast<std::size_t>(link.first)],
                                  graph.map_from_base[static_cast<std::size_t>(link.second)]);
    squares.push_back(r * r);
  }
  return squares;
}

int CountAgreeing(const std::vector<double>& squares) {
  return static_cast<int>(
      std::count_if(squares.begin(), squares.end(), [](double s) { return s <= kMaxSigma * kMaxSigma; }));
}

// Yang et al., equation 14.
double GncWeight(double square, double mu) {
  constexpr double kBound = kMaxSigma * kMaxSigma;
  if (square <= mu / (mu + 1.0) * kBound) {
    return 1.0;
  }
  if (square >= (mu + 1.0) / mu * kBound) {
    return 0.0;
  }
  return std::sqrt(kBound * mu * (mu + 1.0) / square) - mu;
}

PoseGraph SolveByGraduatedNonConvexity(PoseGraph graph) {
  std::vector<double> weights(graph.links.size(), 1.0);
  OptimizePosesWeighted(&graph, weights);
  std::vector<double> squares = SquaredResiduals(graph);
  const double largest = *std::max_element(squares.begin(), squares.end());
  double mu = kMaxSigma * kMaxSigma / std::max(1.0, 2.0 * largest - kMaxSigma * kMaxSigma);
  for (int round = 0; round < kMaxRounds; ++round) {
    bool binary = true;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      weights[i] = GncWeight(squares[i], mu);
      binary = binary && (weights[i] == 0.0 || weights[i] == 1.0);
    }
    OptimizePosesWeighted(&graph, weights);
    squares = SquaredResiduals(graph);
    if (binary) {
      break;
    }
    mu *= kMuFactor;
  }
  return graph;
}

}  // namespace

RobustPoseGraphSummary OptimizePosesRobustly(PoseGraph* graph) {
  OptimizePoses(graph);
  const int agreeing = CountAgreeing(SquaredResiduals(*graph));
  const int count = static_cast<int>(graph->links.size());
  if (agreeing < count) {
    if (count - agreeing > kFewShare * count) {
      PoseGraph other = SolveByGraduatedNonConvexity(*graph);
      if (CountAgreeing(SquaredResiduals(other)) > agreeing) {
        *graph = std::move(other);
      }
    }
    const std::vector<double> squares = SquaredResiduals(*graph);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      if (squares[i] <= kMaxSigma * kMaxSigma) {
        graph->links[kept++] = graph->links[i];
      }
    }
    graph->links.resize(kept);
  }
  const PoseGraphSummary summary = OptimizePoses(graph);
  return {summary.converged, count - static_cast<int>(graph->links.size())};
}

}  // namespace floorloc
