// SPDX-License-Identifier: Apache-2.0
#include "server/http/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <string>

#include "server/http/process_metrics.h"

namespace floorloc {
namespace {

using testing::HasSubstr;
using testing::Not;

LocalizationFigures Figures(double seconds) {
  return {{"hall", "localized"}, "tracking", seconds, 0.001, {{"features", 0.002}, {"fusion", 0.0}},
          FixFigures{171, 3e-9}};
}

double ValueOf(const std::string& page, const std::string& name) {
  const std::size_t at = page.find("\n" + name + " ");
  EXPECT_NE(at, std::string::npos) << name;
  return at == std::string::npos ? -1.0 : std::stod(page.substr(at + name.size() + 2));
}

TEST(MetricsTest, HistogramsAreCumulated) {
  Metrics metrics;
  for (const double seconds : {0.003, 0.02, 100.0}) {
    metrics.CountLocalization(Figures(seconds));
  }
  metrics.CountMessage({"hall", "used_late"});
  metrics.CountFix({"hall", "mahalanobis"});
  const std::string text =
      metrics.Render({{"floorloc_x", "Help.", 7.0}, {"floorloc_y", "Help.", 1.0, LabelText("status", "lost")}});
  for (const char* line : {"floorloc_x 7\n", "floorloc_y{status=\"lost\"} 1\n",
                           "floorloc_vehicle_messages_total{map=\"hall\",outcome=\"used_late\"} 1\n",
                           "floorloc_vehicle_fixes_total{map=\"hall\",outcome=\"mahalanobis\"} 1\n",
                           "floorloc_localize_total{map=\"hall\",status=\"localized\"} 3\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",status=\"localized\",le=\"0.002\"} 0\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",status=\"localized\",le=\"0.004\"} 1\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",status=\"localized\",le=\"10\"} 2\n",
                           "floorloc_localize_seconds_bucket{map=\"hall\",status=\"localized\",le=\"+Inf\"} 3\n",
                           "floorloc_localize_seconds_sum{map=\"hall\",status=\"localized\"} 100.023\n",
                           "floorloc_queue_seconds_bucket{work=\"tracking\",le=\"0.001\"} 3\n",
                           "floorloc_stage_seconds_count{stage=\"features\"} 3\n",
                           "floorloc_fix_inliers_bucket{map=\"hall\",le=\"160\"} 0\n",
                           "floorloc_fix_inliers_bucket{map=\"hall\",le=\"240\"} 3\n",
                           "floorloc_fix_p_wrong_bucket{map=\"hall\",le=\"1e-09\"} 0\n",
                           "floorloc_fix_p_wrong_bucket{map=\"hall\",le=\"1e-08\"} 3\n"}) {
    EXPECT_THAT(text, HasSubstr(line));
  }
  EXPECT_THAT(text, Not(HasSubstr("stage=\"fusion\""))) << "it was not done";
}

TEST(MetricsTest, RefusalsAreCountedByReasonAndTakeNoTime) {
  Metrics metrics;
  metrics.CountRequest({"/v1/maps", "GET", 200}, 0.05);
  metrics.CountRefusal({"/v1/maps", "GET", 503}, "deadline");
  metrics.CountRefusal({"/v1/maps", "GET", 503}, "queue_full");
  metrics.CountRefusal({"/v1/maps", "GET", 503}, "deadline");
  const std::string text = metrics.Render({});
  EXPECT_THAT(text, HasSubstr("floorloc_http_requests_total{route=\"/v1/maps\",method=\"GET\",code=\"503\"} 3\n"));
  EXPECT_THAT(text, HasSubstr("floorloc_http_refusals_total{route=\"/v1/maps\",reason=\"deadline\"} 2\n"));
  EXPECT_THAT(text, HasSubstr("floorloc_http_refusals_total{route=\"/v1/maps\",reason=\"queue_full\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("floorloc_http_request_seconds_bucket{route=\"/v1/maps\",le=\"0.035\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("floorloc_http_request_seconds_bucket{route=\"/v1/maps\",le=\"0.05\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("floorloc_http_request_seconds_count{route=\"/v1/maps\"} 1\n"));
}

TEST(MetricsTest, LongSumsKeepTheirDigits) {
  Metrics metrics;
  metrics.CountRequest({"/", "GET", 200}, 12345678.0);
  metrics.CountRequest({"/", "GET", 200}, 0.125);
  EXPECT_THAT(metrics.Render({}), HasSubstr("floorloc_http_request_seconds_sum{route=\"/\"} 12345678.125\n"));
}

TEST(MetricsTest, TheProcessIsMeasured) {
  const std::string page = Metrics().Render({});
  const double now_s = static_cast<double>(::time(nullptr));
  EXPECT_NEAR(ValueOf(page, "process_start_time_seconds"), now_s, 600.0);
  EXPECT_GT(ValueOf(page, "process_resident_memory_bytes"), 1e6);
  EXPECT_GE(ValueOf(page, "process_virtual_memory_bytes"), ValueOf(page, "process_resident_memory_bytes"));
  EXPECT_GE(ValueOf(page, "process_threads"), 1.0);
  EXPECT_GT(ValueOf(page, "process_max_fds"), ValueOf(page, "process_open_fds"));
  const double before_s = ReadProcessMetrics()->cpu_s;
  while (ReadProcessMetrics()->cpu_s < before_s + 0.02) {
  }
  const double open = ValueOf(page, "process_open_fds");
  const int copy = ::dup(0);
  EXPECT_EQ(ValueOf(Metrics().Render({}), "process_open_fds"), open + 1.0);
  ::close(copy);
}

// Every family with values; promtool complains of bad names, types, help texts and labels.
TEST(MetricsTest, PrometheusUnderstandsThem) {
  if (std::system("command -v promtool > /dev/null") != 0) {
    GTEST_SKIP() << "promtool (Debian package prometheus) is not installed: the metrics are not checked by it";
  }
  Metrics metrics;
  metrics.CountRequest({"/v1/maps", "GET", 200}, 0.05);
  metrics.CountRefusal({"unmatched", "", 404}, "not_found");
  metrics.CountLocalization(Figures(0.01));
  metrics.CountMessage({"hall \"1\" \\", "used"});
  metrics.CountFix({"hall", "accepted"});
  std::FILE* promtool = ::popen("promtool check metrics", "w");
  const std::string page = metrics.Render({{"floorloc_ready", "Help.", 1.0}});
  std::fwrite(page.data(), 1, page.size(), promtool);
  EXPECT_EQ(::pclose(promtool), 0) << page;
}

}  // namespace
}  // namespace floorloc
