// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/body_budget.h"
#include "server/http/connection.h"
#include "server/http/connection_table.h"
#include "server/http/http_handler.h"
#include "server/http/http_limits.h"
#include "server/wire/problem.h"

namespace floorloc {

/// What all connections share.
struct ServingContext {
  HttpLimits limits;
  BodyBudget& budget;
  HttpHandler& handler;
};

/// Parses the requests of one connection with cpp-httplib and hands them to the handler, until one of the two sides
/// closes, the connection is idle for too long, or the server stops. One in a reserved place has one request, of a
/// health check.
void ServeRequests(Connection& connection, ConnectionPlace& place, const ServingContext& context);

/// The problem of a connection for which there is no place.
Overload TooManyConnections();

}  // namespace floorloc
