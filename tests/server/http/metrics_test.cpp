// SPDX-License-Identifier: Apache-2.0
#include "server/http/metrics.h"

#include <gtest/gtest.h>

namespace floorloc {
namespace {

TEST(MetricsTest, HistogramsAreCumulated) {
  Metrics metrics;
  metrics.CountLocalization({"hall", "localized"}, 0.003);
  metrics.CountLocalization({"hall", "localized"}, 0.02);
  metrics.CountLocalization({"hall", "localized"}, 100.0);
  metrics.CountMessage({"hall", "used_late"});
  metrics.CountFix({"hall", "mahalanobis"});
  const std::string text =
      metrics.Render({{"floorloc_x", "Help.", 7.0}, {"floorloc_y", "Help.", 1.0, "status=\"lost\""}});
  for (const char* line : {"floorloc_x 7\n", "floorloc_y{status=\"lost\"} 1\n",
                           "floorloc_vehicle_messages_total{map=\"hall\",outcome=\"used_late\"} 1\n",
                           "floorloc_vehicle_fixes_total{map=\"hall\",outcome=\"mahalanobis\"} 1\n",
                           "floorloc_localize_total{map=\"hall\",status=\"localized\"} 3\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",le=\"0.002\"} 0\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",le=\"0.004\"} 1\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",le=\"10\"} 2\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",le=\"+Inf\"} 3\n"}) {
    EXPECT_NE(text.find(line), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace floorloc
