// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/wire/request_trace.h"

namespace floorloc {

/// Names the request that this thread answers to the log, for as long as the scope lives. Scopes may be nested.
class LogScope {
 public:
  /// trace must outlive the scope.
  explicit LogScope(const RequestTrace& trace);
  ~LogScope();
  LogScope(const LogScope&) = delete;
  LogScope& operator=(const LogScope&) = delete;

  /// Null outside of a request.
  static const RequestTrace* Current();

 private:
  const RequestTrace* before_;
};

}  // namespace floorloc
