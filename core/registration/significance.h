// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace floorloc {

/// log10 of the number of false alarms (NFA): the expected number of poses that explain at least `inliers` of `matches`
/// by chance alone. A contrario detection (Desolneux, Moisan & Morel, Meaningful Alignments, IJCV 40(1), 2000; for
/// RANSAC Moisan & Stival 2004): log10(trials) + log10 of the binomial tail P(X >= inliers), X ~ B(matches, chance).
double Log10Nfa(int matches, int inliers, double chance, double trials);

}  // namespace floorloc
