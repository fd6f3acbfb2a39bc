// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace floorloc {

/// Shares pictures out among folds of about equal size so that pictures of the same class that look alike are in the
/// same fold: those of one room mostly are, so that a fold's pictures are of rooms that the other folds do not have.
/// Each class is parted into pictures / pictures_per_group groups, at least two per
/// fold (bisecting 2-means, Steinbach et al. 2000), which are
/// dealt to the folds whole. looks: a vector per picture.
struct FoldOptions {
  int folds = 5;
  int pictures_per_group = 8;

  /// Throws std::invalid_argument with the name of the first field that makes no sense.
  void Check() const;
};
std::vector<int> LookAlikeFolds(const std::vector<std::vector<float>>& looks, std::span<const int> labels,
                                const FoldOptions& options);

}  // namespace floorloc
