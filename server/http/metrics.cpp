// SPDX-License-Identifier: Apache-2.0
#include "server/http/metrics.h"

#include <charconv>
#include <cmath>
#include <sstream>

#include "server/http/process_metrics.h"

namespace floorloc {
namespace {

// The shortest text that says the same number: a sum of a million seconds keeps its milliseconds.
std::string NumberText(double value) {
  if (!std::isfinite(value)) {
    return std::isnan(value) ? "NaN" : value > 0.0 ? "+Inf" : "-Inf";
  }
  char text[32];
  const bool is_plain = value == 0.0 || (std::abs(value) >= 1e-4 && std::abs(value) < 1e15);
  const auto result = std::to_chars(std::begin(text), std::end(text), value,
                                    is_plain ? std::chars_format::fixed : std::chars_format::scientific);
  return {text, result.ptr};
}

struct Family {
  const char* name;
  const char* type;
  const char* help;
};

constexpr Family kRequests = {"floorloc_http_requests_total", "counter", "HTTP requests, refused ones included."};
constexpr Family kRefusals = {"floorloc_http_refusals_total", "counter",
                              "Requests that were refused or failed, by the code of the problem."};
constexpr Family kRequestSeconds = {"floorloc_http_request_seconds", "histogram",
                                    "Time from the complete request to its response, of those that were answered."};
constexpr Family kLocalizations = {"floorloc_localize_total", "counter", "Localized frames."};
constexpr Family kLocalizeSeconds = {"floorloc_localize_seconds", "histogram",
                                     "Compute time of a localization, without waiting."};
constexpr Family kStageSeconds = {"floorloc_stage_seconds", "histogram", "Compute time of a stage of a localization."};
constexpr Family kQueueSeconds = {"floorloc_queue_seconds", "histogram",
                                  "Time that a localization had waited for a thread, by the class of its queue."};
constexpr Family kInliers = {"floorloc_fix_inliers", "histogram", "Inliers of localized frames."};
constexpr Family kPWrong = {"floorloc_fix_p_wrong", "histogram",
                            "Probability that a localized frame's pose is wrong, as answered."};
constexpr Family kMessages = {"floorloc_vehicle_messages_total", "counter", "Messages of vehicles, by outcome."};
constexpr Family kFixes = {"floorloc_vehicle_fixes_total", "counter",
                           "Fixes of vehicles, by outcome: accepted, reanchored, or the reason of rejection."};

std::string Text(const std::string& text) { return text; }
std::string Text(const LocalizationLabels& labels) {
  return LabelText("map", labels.map) + ',' + LabelText("status", labels.status);
}
std::string Text(const OutcomeLabels& labels) {
  return LabelText("map", labels.map) + ',' + LabelText("outcome", labels.outcome);
}
std::string Text(const RefusalLabels& labels) {
  return LabelText("route", labels.route) + ',' + LabelText("reason", labels.reason);
}
std::string Text(const RequestLabels& labels) {
  return LabelText("route", labels.route) + ',' + LabelText("method", labels.method) + ',' +
         LabelText("code", std::to_string(labels.status));
}

class Page {
 public:
  void Head(const Family& family) {
    out_ << "# HELP " << family.name << ' ' << family.help << "\n# TYPE " << family.name << ' ' << family.type << '\n';
  }
  void Line(const std::string& name, const std::string& labels, const std::string& value) {
    out_ << name << (labels.empty() ? "" : '{' + labels + '}') << ' ' << value << '\n';
  }
  template <typename Labels>
  void Counters(const Family& family, const std::map<Labels, std::uint64_t>& counts) {
    Head(family);
    for (const auto& [labels, count] : counts) {
      Line(family.name, Text(labels), std::to_string(count));
    }
  }
  /// label: its name, for labels that are a value only.
  template <typename Labels>
  void Histograms(const Family& family, const std::map<Labels, Histogram>& histograms, const char* label = nullptr) {
    Head(family);
    for (const auto& [labels, histogram] : histograms) {
      Write(family.name, label == nullptr ? Text(labels) : LabelText(label, Text(labels)), histogram);
    }
  }
  void Gauges(const std::vector<Gauge>& gauges) {
    std::string last_name;
    for (const Gauge& gauge : gauges) {
      if (gauge.name != last_name) {
        Head({gauge.name.c_str(), gauge.type, gauge.help.c_str()});
      }
      last_name = gauge.name;
      Line(gauge.name, gauge.label, NumberText(gauge.value));
    }
  }
  std::string text() const { return out_.str(); }

 private:
  void Write(const std::string& name, const std::string& labels, const Histogram& histogram) {
    std::uint64_t cumulated = 0;
    for (std::size_t i = 0; i < histogram.bounds().size(); ++i) {
      cumulated += histogram.counts()[i];
      Line(name + "_bucket", labels + ',' + LabelText("le", NumberText(histogram.bounds()[i])),
           std::to_string(cumulated));
    }
    Line(name + "_bucket", labels + ",le=\"+Inf\"", std::to_string(histogram.total()));
    Line(name + "_sum", labels, NumberText(histogram.sum()));
    Line(name + "_count", labels, std::to_string(histogram.total()));
  }

  std::ostringstream out_;
};

std::vector<Gauge> ProcessGauges() {
  const std::optional<ProcessMetrics> process = ReadProcessMetrics();
  if (!process) {
    return {};
  }
  return {{"process_cpu_seconds_total", "Processor time, user and system.", process->cpu_s, "", "counter"},
          {"process_start_time_seconds", "When the process was started, Unix time.", process->start_s},
          {"process_resident_memory_bytes", "Memory in use.", process->resident_bytes},
          {"process_virtual_memory_bytes", "Addresses in use.", process->virtual_bytes},
          {"process_threads", "Threads.", process->threads},
          {"process_open_fds", "Open files and connections.", process->open_files},
          {"process_max_fds", "How many may be open.", process->max_open_files}};
}

template <typename Labels>
void Observe(std::map<Labels, Histogram>& histograms, const Labels& labels, std::span<const double> bounds,
             double value) {
  histograms.try_emplace(labels, bounds).first->second.Observe(value);
}

}  // namespace

std::string LabelText(const char* name, const std::string& value) {
  std::string text = std::string(name) + "=\"";
  for (const char c : value) {
    if (c == '\\' || c == '"') {
      text += '\\';
    }
    text += c == '\n' ? ' ' : c;
  }
  return text + '"';
}

void Metrics::CountRequest(const RequestLabels& labels, double seconds) {
  const std::lock_guard lock(mutex_);
  ++requests_[labels];
  Observe(request_seconds_, labels.route, SecondsBounds(), seconds);
}

void Metrics::CountRefusal(const RequestLabels& labels, const std::string& reason) {
  const std::lock_guard lock(mutex_);
  ++requests_[labels];
  ++refusals_[{labels.route, reason}];
}

void Metrics::CountLocalization(const LocalizationFigures& figures) {
  const std::string& map = figures.labels.map;
  const std::lock_guard lock(mutex_);
  Observe(localize_seconds_, figures.labels, SecondsBounds(), figures.seconds);
  Observe(queue_seconds_, figures.work, SecondsBounds(), figures.queue_seconds);
  for (const StageTime& time : figures.stages) {
    if (time.seconds > 0.0) {
      Observe(stage_seconds_, time.stage, SecondsBounds(), time.seconds);
    }
  }
  if (figures.fix) {
    Observe(inliers_, map, InlierBounds(), figures.fix->inliers);
    Observe(p_wrong_, map, RiskBounds(), figures.fix->p_wrong);
  }
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
  Page page;
  page.Gauges({{"floorloc_build_info", "Version of the server.", 1.0, LabelText("version", FLOORLOC_VERSION)}});
  page.Gauges(ProcessGauges());
  page.Gauges(gauges);
  const std::lock_guard lock(mutex_);
  page.Counters(kRequests, requests_);
  page.Counters(kRefusals, refusals_);
  page.Histograms(kRequestSeconds, request_seconds_, "route");
  page.Head(kLocalizations);
  for (const auto& [labels, histogram] : localize_seconds_) {
    page.Line(kLocalizations.name, Text(labels), std::to_string(histogram.total()));
  }
  page.Histograms(kLocalizeSeconds, localize_seconds_);
  page.Histograms(kStageSeconds, stage_seconds_, "stage");
  page.Histograms(kQueueSeconds, queue_seconds_, "work");
  page.Histograms(kInliers, inliers_, "map");
  page.Histograms(kPWrong, p_wrong_, "map");
  page.Counters(kMessages, messages_);
  page.Counters(kFixes, fixes_);
  return page.text();
}

}  // namespace floorloc
