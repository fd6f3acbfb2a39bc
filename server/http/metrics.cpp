// SPDX-License-Identifier: Apache-2.0
#include "server/http/metrics.h"

#include <algorithm>
#include <iterator>
#include <sstream>

namespace floorloc {
namespace {

std::string Escape(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\' || c == '"') {
      escaped += '\\';
    }
    escaped += c == '\n' ? ' ' : c;
  }
  return escaped;
}

std::string Label(const char* name, const std::string& value) {
  return std::string(name) + "=\"" + Escape(value) + "\"";
}

void Head(std::ostream& out, const std::string& name, const char* type, const std::string& help) {
  out << "# HELP " << name << ' ' << help << "\n# TYPE " << name << ' ' << type << '\n';
}

void Render(std::ostream& out, const std::string& name, const std::string& label, const Histogram& histogram) {
  std::uint64_t cumulated = 0;
  for (std::size_t i = 0; i < Histogram::kBounds.size(); ++i) {
    cumulated += histogram.counts()[i];
    out << name << "_bucket{" << label << ",le=\"" << Histogram::kBounds[i] << "\"} " << cumulated << '\n';
  }
  out << name << "_bucket{" << label << ",le=\"+Inf\"} " << histogram.total() << '\n';
  out << name << "_sum{" << label << "} " << histogram.sum() << '\n';
  out << name << "_count{" << label << "} " << histogram.total() << '\n';
}

void Render(std::ostream& out, const std::vector<Gauge>& gauges) {
  std::string last_name;
  for (const Gauge& gauge : gauges) {
    if (gauge.name != last_name) {
      Head(out, gauge.name, "gauge", gauge.help);
    }
    last_name = gauge.name;
    out << gauge.name << (gauge.label.empty() ? "" : '{' + gauge.label + '}') << ' ' << gauge.value << '\n';
  }
}

void Render(std::ostream& out, const std::string& name, const std::map<OutcomeLabels, std::uint64_t>& counts) {
  for (const auto& [labels, count] : counts) {
    out << name << '{' << Label("map", labels.map) << ',' << Label("outcome", labels.outcome) << "} " << count << '\n';
  }
}

}  // namespace

void Histogram::Observe(double seconds) {
  const auto bound = std::lower_bound(kBounds.begin(), kBounds.end(), seconds);
  if (bound != kBounds.end()) {
    ++counts_[static_cast<std::size_t>(std::distance(kBounds.begin(), bound))];
  }
  ++total_;
  sum_ += seconds;
}

void Metrics::CountRequest(const RequestLabels& labels, double seconds) {
  const std::lock_guard lock(mutex_);
  ++requests_[labels];
  request_seconds_[labels.route].Observe(seconds);
}

void Metrics::CountLocalization(const LocalizationLabels& labels, double seconds) {
  const std::lock_guard lock(mutex_);
  ++localizations_[labels];
  localize_seconds_[labels.map].Observe(seconds);
}

void Metrics::CountMessage(const OutcomeLabels& labels) {
  const std::lock_guard lock(mutex_);
  ++messages_[labels];
}

void Metrics::CountFix(const OutcomeLabels& labels) {
  const std::lock_guard lock(mutex_);
  ++fixes_[labels];
}

std::string Metrics::Render(const std::vector<Gauge>& gauges) const {
  std::ostringstream out;
  Head(out, "floorloc_build_info", "gauge", "Version of the server.");
  out << "floorloc_build_info{" << Label("version", FLOORLOC_VERSION) << "} 1\n";
  floorloc::Render(out, gauges);
  const std::lock_guard lock(mutex_);
  Head(out, "floorloc_http_requests_total", "counter", "Answered HTTP requests.");
  for (const auto& [labels, count] : requests_) {
    out << "floorloc_http_requests_total{" << Label("route", labels.route) << ',' << Label("method", labels.method)
        << ',' << Label("code", std::to_string(labels.status)) << "} " << count << '\n';
  }
  Head(out, "floorloc_http_request_seconds", "histogram", "Time from the complete request to its response.");
  for (const auto& [route, histogram] : request_seconds_) {
    floorloc::Render(out, "floorloc_http_request_seconds", Label("route", route), histogram);
  }
  Head(out, "floorloc_localize_total", "counter", "Localized frames.");
  for (const auto& [labels, count] : localizations_) {
    out << "floorloc_localize_total{" << Label("map", labels.map) << ',' << Label("status", labels.status) << "} "
        << count << '\n';
  }
  Head(out, "floorloc_localize_seconds", "histogram", "Compute time of a localization, without waiting.");
  for (const auto& [map, histogram] : localize_seconds_) {
    floorloc::Render(out, "floorloc_localize_seconds", Label("map", map), histogram);
  }
  Head(out, "floorloc_vehicle_messages_total", "counter", "Messages of vehicles, by outcome.");
  floorloc::Render(out, "floorloc_vehicle_messages_total", messages_);
  Head(out, "floorloc_vehicle_fixes_total", "counter",
       "Fixes of vehicles, by outcome: accepted, reanchored, or the reason of rejection.");
  floorloc::Render(out, "floorloc_vehicle_fixes_total", fixes_);
  return out.str();
}

}  // namespace floorloc
