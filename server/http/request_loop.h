// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/body_budget.h"
#include "server/http/connection.h"
#include "server/http/http_handler.h"
#include "server/http/http_limits.h"

namespace floorloc {

/// Parses the requests of one connection with cpp-httplib and hands them to the handler, until one of the two sides
/// closes, the connection is idle for too long, or the server stops.
void ServeRequests(Connection& connection, const HttpLimits& limits, BodyBudget& budget, HttpHandler& handler);

}  // namespace floorloc
