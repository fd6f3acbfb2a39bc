// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace floorloc {

/// The sharpness with which the softmax of sharpness * sums makes the given labels the most probable (temperature
/// scaling, Guo et al., ICML 2017): a maximum of the likelihood over the logarithm of the sharpness, from 1/1000 to
/// 1000.
float FitSharpness(const std::vector<Eigen::RowVectorXf>& sums, std::span<const int> labels);

}  // namespace floorloc
