// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/http/access_log.h"

namespace floorloc {

enum class LogFormat {
  kText,
  kJson,  ///< an object per line: time, level, message, and of the request that it is about request_id and trace_id
};

/// From now on the log goes to stderr, in this format. level: "debug", "info", "warning", "error" or "off".
void StartLogging(const std::string& level, LogFormat format);

/// Writes access records to that log, whatever its level.
AccessLog MakeAccessLog(LogFormat format);

}  // namespace floorloc
