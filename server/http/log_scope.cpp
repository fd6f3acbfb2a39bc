// SPDX-License-Identifier: Apache-2.0
#include "server/http/log_scope.h"

#include <utility>

namespace floorloc {
namespace {

thread_local const RequestTrace* current = nullptr;

}  // namespace

LogScope::LogScope(const RequestTrace& trace) : before_(std::exchange(current, &trace)) {}

LogScope::~LogScope() { current = before_; }

const RequestTrace* LogScope::Current() { return current; }

}  // namespace floorloc
