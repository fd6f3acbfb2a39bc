// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/logging.h"

#include <spdlog/fmt/chrono.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "server/http/log_scope.h"

namespace floorloc {
namespace {

const char* const kLogger = "floorloc";
const char* const kAccessLogger = "access";

std::string Quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string TimeText(std::chrono::system_clock::time_point time) {
  const auto seconds = std::chrono::floor<std::chrono::seconds>(time);
  const auto milliseconds = std::chrono::floor<std::chrono::milliseconds>(time - seconds).count();
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(seconds)),
                     milliseconds);
}

class JsonFormatter : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& out) override {
    const std::string payload(line.payload.data(), line.payload.size());
    const spdlog::string_view_t level = spdlog::level::to_string_view(line.level);
    std::string text =
        R"({"time":")" + TimeText(line.time) + R"(","level":")" + std::string(level.data(), level.size()) + "\",";
    if (line.logger_name == kAccessLogger) {
      text += payload;  // members already
    } else {
      text += "\"message\":" + Quoted(payload);
      const RequestTrace* trace = LogScope::Current();
      if (trace != nullptr && !trace->request_id.empty()) {
        text += ",\"request_id\":" + Quoted(trace->request_id) + ",\"trace_id\":" + Quoted(trace->trace_id);
      }
    }
    text += "}\n";
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonFormatter>(); }
};

}  // namespace

void StartLogging(const std::string& level, LogFormat format) {
  if (spdlog::get(kLogger) == nullptr) {
    const auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(kLogger, sink));
    spdlog::register_logger(std::make_shared<spdlog::logger>(kAccessLogger, sink));
  }
  if (format == LogFormat::kJson) {
    spdlog::set_formatter(std::make_unique<JsonFormatter>());
  } else {
    spdlog::set_formatter(std::make_unique<spdlog::pattern_formatter>());
  }
  spdlog::set_level(spdlog::level::from_str(level));
}

AccessLog MakeAccessLog(LogFormat format) {
  const std::shared_ptr<spdlog::logger> logger = spdlog::get(kAccessLogger);
  logger->set_level(spdlog::level::info);
  return [logger, format](const AccessRecord& record) {
    logger->info(format == LogFormat::kJson ? FormatAccessJson(record) : FormatAccessText(record));
  };
}

}  // namespace floorloc
