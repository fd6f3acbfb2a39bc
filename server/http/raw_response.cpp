// SPDX-License-Identifier: Apache-2.0
#include "server/http/raw_response.h"

#include <string>

#include "server/wire/problem_json.h"

namespace floorloc {

namespace {

// Without the empty line.
std::string HeadOf(const HttpResponse& response) {
  std::string head = "HTTP/1.1 " + std::to_string(response.status) + " " + StatusTitle(response.status) +
                     "\r\nConnection: close\r\n" + "Content-Type: " + response.content_type + "\r\n";
  for (const auto& [name, value] : response.headers) {
    head.append(name).append(": ").append(value).append("\r\n");
  }
  return head;
}

}  // namespace

void WriteLastResponse(const HttpResponse& response, Connection& connection) {
  std::string text = HeadOf(response) + "Content-Length: " + std::to_string(response.body.size()) + "\r\n\r\n";
  text += response.body;
  connection.Write(text.data(), text.size());
  connection.Flush();
}

bool WriteStreamHead(const HttpResponse& response, Connection& connection) {
  const std::string head = HeadOf(response) + "\r\n";
  return connection.Write(head.data(), head.size()) >= 0 && connection.Flush();
}

}  // namespace floorloc
