// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/client.h"

#include <httplib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "clients/cpp/deadline.h"
#include "clients/cpp/targets.h"

namespace floorloc::client {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;

constexpr milliseconds kLongestServerDeadline{60'000};

std::string ContentTypeOf(const std::string& image) {
  if (image.starts_with("\x89PNG")) {
    return "image/png";
  }
  if (image.starts_with("\xff\xd8")) {
    return "image/jpeg";
  }
  throw std::invalid_argument("the image is neither a JPEG nor a PNG file: encode it first");
}

Failure FailureOf(const httplib::Response& response) {
  Failure failure;
  failure.status = response.status;
  failure.retry_after = ParseRetryAfter(response.get_header_value("Retry-After"));
  failure.request_id = response.get_header_value("X-Request-Id");
  const json problem = json::parse(response.body, nullptr, false);
  if (problem.is_object() && problem.contains("code") && problem.contains("detail")) {
    failure.reason = problem.value("code", "");
    failure.detail = problem.value("detail", "");
  } else {
    failure.reason = kMalformedAnswer;
    failure.detail = "The answer is not that of a floorloc-server: " + response.body.substr(0, 200);
  }
  return failure;
}

// Makes a file the body of a request; httplib asks for it piece by piece, from the start when it is sent again.
void SendFile(const std::filesystem::path& path, httplib::Request& http) {
  auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!*file || error) {
    throw std::invalid_argument("the file " + path.string() + " cannot be read");
  }
  http.content_length_ = static_cast<std::size_t>(size);
  http.content_provider_ = [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
    std::array<char, 65536> piece{};
    file->clear();
    file->seekg(static_cast<std::streamoff>(offset));
    file->read(piece.data(), static_cast<std::streamsize>(std::min(length, piece.size())));
    return file->gcount() > 0 && sink.write(piece.data(), static_cast<std::size_t>(file->gcount()));
  };
}

// Parses an answer by a function that throws json::exception for what it does not know.
template <typename Answer, typename Parse>
auto Parsed(const Answer& answer, Parse parse) {
  try {
    return parse(answer);
  } catch (const json::exception& error) {
    throw CallError({200, kMalformedAnswer,
                     std::string("The server answers otherwise than documented: ") + error.what(), std::nullopt, ""});
  }
}

}  // namespace

void ClientOptions::Check() const {
  if (!url.starts_with("http://") && !url.starts_with("https://")) {
    throw std::invalid_argument("url must be the address of a server, such as http://localhost:8080");
  }
  if (timeout.count() <= 0) {
    throw std::invalid_argument("timeout must be positive");
  }
  retry.Check();
}

std::string StampText(double stamp_s) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(9) << stamp_s;
  return text.str();
}

std::string StampText(std::chrono::nanoseconds since_1970) {
  constexpr std::int64_t kNsPerS = 1'000'000'000;
  const std::int64_t count = std::abs(since_1970.count());
  std::ostringstream text;
  text << (since_1970.count() < 0 ? "-" : "") << count / kNsPerS << '.' << std::setw(9) << std::setfill('0')
       << count % kNsPerS;
  return text.str();
}

struct Client::Request {
  std::string method;
  std::string target;
  std::string body = {};
  std::string content_type = {};
  bool tell_server = false;         ///< the deadline
  std::filesystem::path file = {};  ///< is sent in the place of the body
};

// Everything that threads share, and its lock.
class Client::Connection {
 public:
  explicit Connection(const ClientOptions& options) : http_(options.url), random_(options.retry.seed) {
    if (!http_.is_valid()) {
      throw std::invalid_argument("url must be the address of a server, such as http://localhost:8080");
    }
    http_.set_keep_alive(true);
    http_.set_tcp_nodelay(true);
    http_.set_url_encode(false);
    if (!options.token.empty()) {
      http_.set_default_headers({{"Authorization", "Bearer " + options.token}});
    }
  }

  httplib::Response Exchange(const Request& request, const Deadline& deadline) {
    const std::unique_lock lock(mutex_, deadline.Left());
    if (!lock.owns_lock()) {
      throw deadline.Exceeded();
    }
    httplib::Request http;
    http.method = request.method;
    http.path = request.target;
    http.body = request.body;
    if (!request.content_type.empty()) {
      http.set_header("Content-Type", request.content_type);
    }
    if (request.tell_server) {
      const auto left = std::chrono::duration_cast<milliseconds>(deadline.Left());
      http.set_header("X-Deadline-Ms",
                      std::to_string(std::clamp(left, milliseconds(1), kLongestServerDeadline).count()));
    }
    if (!request.file.empty()) {
      SendFile(request.file, http);
    }
    std::string body;
    http.content_receiver = [&](const char* data, std::size_t size, std::uint64_t, std::uint64_t) {
      body.append(data, size);
      return deadline.Allows(milliseconds(0));  // an answer that trickles would never time out
    };
    const auto left = deadline.Left();
    http_.set_connection_timeout(left);
    http_.set_read_timeout(left);
    http_.set_write_timeout(left);
    const httplib::Result result = http_.send(http);
    if (!result) {
      if (!deadline.Allows(milliseconds(1))) {
        throw deadline.Exceeded();
      }
      throw CallError({0, kUnreachable, "The server does not answer: " + httplib::to_string(result.error()) + ".",
                       std::nullopt, ""});
    }
    httplib::Response response = result.value();
    response.body = std::move(body);
    return response;
  }

  std::optional<milliseconds> Wait(const RetryOptions& options, const Failure& failure, int attempt) {
    const std::lock_guard lock(random_mutex_);
    return WaitBeforeRetry(options, failure, attempt, random_);
  }

 private:
  std::timed_mutex mutex_;  ///< of http_; held during a call, so nothing else is behind it
  httplib::Client http_;
  std::mutex random_mutex_;
  std::mt19937_64 random_;
};

Client::Client(ClientOptions options)
    : options_((options.Check(), std::move(options))), connection_(std::make_unique<Connection>(options_)) {}

Client::~Client() = default;

std::string Client::Attempt(const Request& request, const Deadline& deadline) {
  httplib::Response response = connection_->Exchange(request, deadline);
  if (response.status >= 300) {
    throw CallError(FailureOf(response));
  }
  return std::move(response.body);
}

json Client::Call(const Request& request, CallTime time) {
  const std::string body = CallForBytes(request, time);
  return body.empty() ? json() : Parsed(body, [](const std::string& text) { return json::parse(text); });
}

std::string Client::CallForBytes(const Request& request, CallTime time) {
  const Deadline deadline(time.value_or(options_.timeout));
  for (int attempt = 1;; ++attempt) {
    try {
      return Attempt(request, deadline);
    } catch (const CallError& error) {
      const auto wait = connection_->Wait(options_.retry, error.failure(), attempt);
      if (!wait || !deadline.Allows(*wait)) {
        throw;
      }
      std::this_thread::sleep_for(*wait);
    }
  }
}

void Client::PutVehicle(const std::string& id, const json& registration) {
  Call({"PUT", VehicleTarget(id), registration.dump(), "application/json"});
}

json Client::GetVehicle(const std::string& id) { return Call({"GET", VehicleTarget(id)}); }

bool Client::DeleteVehicle(const std::string& id) {
  try {
    Call({"DELETE", VehicleTarget(id)});
  } catch (const CallError& error) {
    if (error.reason() != "unknown_vehicle") {
      throw;
    }
    return false;
  }
  return true;
}

LocalizeAnswer Client::Localize(const LocalizeRequest& request, CallTime deadline) {
  const json answer = Call(
      {"POST", LocalizeTarget(request), request.image, ContentTypeOf(request.image), deadline.has_value()}, deadline);
  return Parsed(answer, ParseLocalizeAnswer);
}

FrameAnswer Client::PostFrame(const std::string& vehicle, const FrameRequest& request, CallTime deadline) {
  const json answer =
      Call({"POST", FrameTarget(vehicle, request), request.image, ContentTypeOf(request.image), deadline.has_value()},
           deadline);
  return Parsed(answer, ParseFrameAnswer);
}

OdometryAnswer Client::PostOdometry(const std::string& vehicle, const std::vector<Increment>& increments,
                                    CallTime deadline) {
  json list = json::array();
  for (const Increment& one : increments) {
    list.push_back({{"stamp", one.stamp}, {"dx", one.motion.dx}, {"dy", one.motion.dy}, {"dyaw", one.motion.dyaw}});
  }
  const json body = {{"increments", std::move(list)}};
  return Parsed(Call({"POST", VehicleTarget(vehicle) + "/odometry", body.dump(), "application/json"}, deadline),
                ParseOdometryAnswer);
}

TrackingAnswer Client::PostInitialPose(const std::string& vehicle, const InitialPose& pose, CallTime deadline) {
  json body = {{"x", pose.map_from_base.x}, {"y", pose.map_from_base.y}, {"yaw", pose.map_from_base.yaw}};
  if (pose.covariance) {
    body["covariance"] = *pose.covariance;
  }
  if (!pose.stamp.empty()) {
    body["stamp"] = pose.stamp;
  }
  return Parsed(Call({"POST", VehicleTarget(vehicle) + "/initialpose", body.dump(), "application/json"}, deadline),
                ParseTrackingAnswer);
}

json Client::ListMaps() { return Call({"GET", "/v1/maps"}); }

json Client::ListVersions(const std::string& map) { return Call({"GET", VersionTarget(map)}); }

json Client::UploadVersion(const std::string& map, const std::filesystem::path& file, CallTime deadline) {
  return Call({"POST", VersionTarget(map), "", "application/vnd.sqlite3", false, file}, deadline);
}

json Client::ActivateVersion(const std::string& map, const std::string& version, CallTime deadline) {
  return Call({"POST", VersionTarget(map, version) + "/activate"}, deadline);
}

void Client::DeleteVersion(const std::string& map, const std::string& version) {
  Call({"DELETE", VersionTarget(map, version)});
}

void Client::DeleteMap(const std::string& map) { Call({"DELETE", MapTarget(map)}); }

json Client::GetMap(const std::string& map) { return Call({"GET", MapTarget(map)}); }

std::optional<std::string> Client::GetTile(const std::string& map, const Tile& tile) {
  try {
    return CallForBytes({"GET", TileTarget(map, tile)});
  } catch (const CallError& error) {
    if (error.reason() != "tile_not_found") {
      throw;
    }
  }
  return std::nullopt;
}

json Client::ListVehicles() { return Call({"GET", "/v1/vehicles"}); }

bool Client::IsReady() {
  try {
    Attempt({"GET", "/readyz"}, Deadline(options_.timeout));
  } catch (const CallError&) {
    return false;
  }
  return true;
}

}  // namespace floorloc::client
