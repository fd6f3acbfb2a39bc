// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace floorloc {

/// log10 of the expected number of poses that explain at least `inliers` of `matches` by chance alone (a contrario
/// model, Moisan & Stival 2004): log10(trials) + log10 of the binomial tail P(X >= inliers), X ~ B(matches, chance).
double LogNumberOfFalseAlarms(int matches, int inliers, double chance, double trials);

}  // namespace floorloc
