// SPDX-License-Identifier: Apache-2.0
#include "server/http/raw_response.h"

#include <string>

#include "server/wire/problem_json.h"

namespace floorloc {

void WriteLastResponse(const HttpResponse& response, Connection& connection) {
  std::string head = "HTTP/1.1 " + std::to_string(response.status) + " " + StatusTitle(response.status) +
                     "\r\nConnection: close\r\n" + "Content-Type: " + response.content_type +
                     "\r\nContent-Length: " + std::to_string(response.body.size()) + "\r\n";
  for (const auto& [name, value] : response.headers) {
    head.append(name).append(": ").append(value).append("\r\n");
  }
  head.append("\r\n").append(response.body);
  connection.Write(head.data(), head.size());
  connection.Flush();
}

}  // namespace floorloc
