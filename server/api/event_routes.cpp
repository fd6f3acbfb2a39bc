// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <charconv>
#include <set>
#include <sstream>
#include <string>

#include "server/api/routes.h"

namespace floorloc {
namespace {

const std::set<std::string> kTypes = {"pose", "fix", "rejection", "status", "odometry", "vehicle", "map"};

EventFilter ParseFilter(const HttpRequest& request) {
  EventFilter filter;
  filter.map = request.QueryValue("map").value_or("");
  filter.vehicle = request.QueryValue("vehicle").value_or("");
  std::istringstream types(request.QueryValue("types").value_or(""));
  for (std::string type; std::getline(types, type, ',');) {
    if (!kTypes.contains(type)) {
      throw Problem(400, "invalid_parameter",
                    "types is a list of pose, fix, rejection, status, odometry, vehicle and map, with commas between.");
    }
    filter.types.insert(type);
  }
  return filter;
}

std::optional<std::uint64_t> ParseLastId(const HttpRequest& request) {
  const std::string text = request.Header("last-event-id");
  if (text.empty()) {
    return std::nullopt;
  }
  std::uint64_t id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size()) {
    throw Problem(400, "invalid_parameter", "Last-Event-ID is the id of the last event that you received, a number.");
  }
  return id;
}

HttpResponse HandleEvents(AppState& state, const HttpRequest& request) {
  EventFilter filter = ParseFilter(request);
  const std::optional<std::uint64_t> last_id = ParseLastId(request);
  if (state.draining) {
    throw Overload("draining", "The server is stopping.");
  }
  if (!state.events.HasRoom()) {
    throw Overload("too_many_streams", "There are too many viewers of events; close some, or try again later.");
  }
  HttpResponse response;
  response.content_type = "text/event-stream";
  response.headers = {{"Cache-Control", "no-store"}, {"X-Accel-Buffering", "no"}};
  response.take_over = [&state, filter = std::move(filter), last_id](int socket) {
    state.events.Add(FileDescriptor(::dup(socket)), filter, last_id);
  };
  return response;
}

}  // namespace

void AddEventRoutes(AppState& state, Router& router) {
  router.Add({"GET", "/v1/events", RouteAccess::kRead, {}, [&state](const HttpRequest& request) {
                return HandleEvents(state, request);
              }});
}

}  // namespace floorloc
