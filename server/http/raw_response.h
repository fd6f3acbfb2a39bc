// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/http/connection.h"
#include "server/wire/http_message.h"

namespace floorloc {

/// Answers what never became a request of the HTTP library, and says that the connection closes.
void WriteLastResponse(const HttpResponse& response, Connection& connection);

/// Sends the head of a response whose body is written by others (HttpResponse::take_over). False when it can't be sent.
bool WriteStreamHead(const HttpResponse& response, Connection& connection);

}  // namespace floorloc
