// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/server/load_plan.h"

#include <arpa/inet.h>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace floorloc {
namespace {

using nlohmann::json;

std::string ReadFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error(path + ": cannot be read");
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

in_addr ParseAddress(const std::string& text) {
  in_addr address{};
  if (inet_pton(AF_INET, text.c_str(), &address) != 1) {
    throw std::runtime_error("'" + text + "' is no IPv4 address");
  }
  return address;
}

// json: {"head": first line and headers, each with its line end; "body": index or "text": content}
PlannedRequest ReadRequest(const json& object, const LoadPlan& plan) {
  PlannedRequest request;
  std::string text;
  std::size_t size = 0;
  if (object.contains("body")) {
    request.body = &plan.bodies.at(object["body"].get<std::size_t>());
    size = request.body->size();
  } else if (object.contains("text")) {
    text = object["text"].get<std::string>();
    size = text.size();
  }
  request.head = object.at("head").get<std::string>() + "Host: localhost\r\nContent-Length: " + std::to_string(size) +
                 "\r\n\r\n" + text;
  return request;
}

ClientGroup ReadGroup(const json& object, const LoadPlan& plan) {
  ClientGroup group;
  group.name = object.at("name").get<std::string>();
  group.interval_s = object.value("interval_s", 0.0);
  group.repeat = object.value("repeat", false);
  for (const json& each : object.at("connections")) {
    PlannedConnection connection{ParseAddress(each.value("source", "127.0.0.1")), {}};
    for (const json& request : each.at("requests")) {
      connection.requests.push_back(ReadRequest(request, plan));
    }
    group.connections.push_back(std::move(connection));
  }
  return group;
}

}  // namespace

void ReadLoadPlan(const std::string& text, LoadPlan* plan) {
  const json object = json::parse(text);
  plan->server.sin_family = AF_INET;
  plan->server.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  plan->server.sin_port = htons(object.at("port").get<std::uint16_t>());
  plan->seconds = object.value("seconds", plan->seconds);
  for (const json& file : object.value("bodies", json::array())) {
    plan->bodies.push_back(ReadFile(file.get<std::string>()));
  }
  for (const json& group : object.at("groups")) {
    plan->groups.push_back(ReadGroup(group, *plan));
  }
}

}  // namespace floorloc
