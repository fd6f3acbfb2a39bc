// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/surface/confusion.h"

namespace floorloc {

double Confusion::Share(int marked, int classified) const {
  const double all = counts_.row(marked).sum();
  return all > 0.0 ? counts_(marked, classified) / all : 0.0;
}

double Confusion::MeanShare() const {
  double sum = 0.0;
  for (int c = 0; c < classes(); ++c) {
    sum += Share(c, c);
  }
  return sum / classes();
}

double Confusion::RightShare() const { return Total() > 0.0 ? counts_.trace() / Total() : 0.0; }

}  // namespace floorloc
