// SPDX-License-Identifier: Apache-2.0
#include "server/http/router.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "core/geometry/option_check.h"
#include "server/http/address_group.h"
#include "server/http/log_scope.h"
#include "server/wire/number_text.h"
#include "server/wire/strict_json.h"

namespace floorloc {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::vector<std::string_view> SplitPath(std::string_view path) {
  std::vector<std::string_view> segments;
  std::size_t start = 1;
  while (start <= path.size()) {
    const std::size_t end = std::min(path.find('/', start), path.size());
    segments.push_back(path.substr(start, end - start));
    start = end + 1;
  }
  return segments;
}

std::string RouteMethod(const HttpRequest& request) { return request.method == "HEAD" ? "GET" : request.method; }

bool IsChange(RouteAccess access) {
  return access == RouteAccess::kWrite || access == RouteAccess::kChange || access == RouteAccess::kAdmin;
}

bool IsAudited(RouteAccess access) { return access == RouteAccess::kChange || access == RouteAccess::kAdmin; }

// A page of another site makes browsers send such calls as well, where no token protects them.
void RefuseForeignPages(const HttpRequest& head) {
  const std::string origin = head.Header("origin");
  if (!origin.empty() && origin != "http://" + head.Header("host") && origin != "https://" + head.Header("host")) {
    throw Problem(403, "foreign_origin", "Pages of other sites may not change what this server serves.");
  }
}

// Without a length there is no body (RFC 9112, 6.3): a client that sent one all the same would see it lost.
void CheckLength(const Route& route, const HttpRequest& head) {
  if (!route.body_types.empty() && head.Header("content-length").empty() && head.Header("transfer-encoding").empty()) {
    throw Problem(411, "length_required", "This call takes a body, and needs Content-Length or chunked transfer.");
  }
}

void CheckContentType(const Route& route, const HttpRequest& head) {
  const std::string type = head.ContentType();
  if (type == "application/json" && ParseFinite(head.Header("content-length")) > kMaxJsonBytesWithMask) {
    throw Problem(413, "json_too_large", "The JSON text is larger than any call needs.");
  }
  if (route.body_types.empty() ||
      std::find(route.body_types.begin(), route.body_types.end(), type) != route.body_types.end()) {
    return;
  }
  std::string known;
  for (const std::string& body_type : route.body_types) {
    known += (known.empty() ? "" : ", ") + body_type;
  }
  throw Problem(415, "unsupported_media_type",
                "This call takes a body of type " + known + "; set the Content-Type header.");
}

}  // namespace

std::optional<std::map<std::string, std::string>> MatchPattern(std::string_view pattern, std::string_view path) {
  const auto expected = SplitPath(pattern);
  const auto actual = SplitPath(path);
  if (path.empty() || path.front() != '/' || expected.size() != actual.size()) {
    return std::nullopt;
  }
  std::map<std::string, std::string> parameters;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::size_t close = expected[i].find('}');
    if (close == std::string_view::npos) {
      if (expected[i] != actual[i]) {
        return std::nullopt;
      }
      continue;
    }
    const std::string_view suffix = expected[i].substr(close + 1);
    if (actual[i].size() <= suffix.size() || !actual[i].ends_with(suffix)) {
      return std::nullopt;
    }
    parameters.emplace(expected[i].substr(1, close - 1), actual[i].substr(0, actual[i].size() - suffix.size()));
  }
  return parameters;
}

void RouterOptions::Check() const {
  RequireOption(max_requests_per_s >= 0.0, "max_requests_per_s must be positive; 0: no limit");
  RequireOption(max_failed_logins >= 0, "max_failed_logins must be positive; 0: no limit");
}

Router::Router(RouterOptions options, Metrics& metrics)
    : options_(std::move(options)),
      metrics_(metrics),
      tokens_(std::make_shared<const AccessTokens>(options_.tokens)),
      rate_limiter_(options_.max_requests_per_s),
      login_limiter_(options_.max_failed_logins) {
  options_.Check();
}

void Router::Add(Route route) { routes_.push_back(std::move(route)); }

void Router::SetTokens(AccessTokens tokens) {
  const std::lock_guard lock(tokens_mutex_);
  tokens_ = std::make_shared<const AccessTokens>(std::move(tokens));
}

std::shared_ptr<const AccessTokens> Router::Tokens() const {
  const std::lock_guard lock(tokens_mutex_);
  return tokens_;
}

Router::Found Router::Find(const HttpRequest& request) const {
  std::set<std::string> methods;
  for (const Route& route : routes_) {
    auto parameters = MatchPattern(route.pattern, request.path);
    if (!parameters) {
      continue;
    }
    if (route.method == RouteMethod(request)) {
      return {&route, std::move(*parameters), ""};
    }
    methods.insert(route.method);
  }
  Found found;
  for (const std::string& method : methods) {
    found.allow += (found.allow.empty() ? "" : ", ") + (method == "GET" ? std::string("GET, HEAD") : method);
  }
  return found;
}

// The rate is limited first: refused logins and unknown paths count as well.
void Router::CheckAdmission(const Found& found, const HttpRequest& head) {
  const RouteAccess access = found.route == nullptr ? RouteAccess::kRead : found.route->access;
  const std::string client = AddressGroup(head.remote_address);
  const bool limited = access == RouteAccess::kRead || IsChange(access);
  if (limited && !rate_limiter_.Allow(client, Clock::now())) {
    throw Problem(429, "rate_limited", "Too many requests from this address; slow down.", Problem::Retry::kSoon);
  }
  if (found.route == nullptr) {
    throw found.allow.empty() ? ProblemOfStatus(404)
                              : Problem(405, "method_not_allowed", "This path supports " + found.allow + " only.");
  }
  if (access == RouteAccess::kAdmin) {
    RefuseForeignPages(head);
  }
  if (IsChange(access) || (access == RouteAccess::kRead && options_.protect_reads)) {
    CheckLogin(found, client, head);
  }
  CheckLength(*found.route, head);
  CheckContentType(*found.route, head);
  if (found.route->admit) {
    HttpRequest request = head;
    request.path_parameters = found.parameters;
    found.route->admit(request);
  }
}

void Router::CheckLogin(const Found& found, const std::string& client, const HttpRequest& head) {
  const std::shared_ptr<const AccessTokens> tokens = Tokens();
  if (tokens->empty()) {
    return;
  }
  const std::string authorization = head.Header("authorization");
  if (authorization.empty()) {
    throw Problem(401, "unauthorized", "This call needs the header 'Authorization: Bearer TOKEN'.");
  }
  const Principal* who = tokens->Find(authorization);
  switch (login_limiter_.Judge(client, who != nullptr, Clock::now())) {
    case LoginLimiter::Verdict::kAllowed:
      break;
    case LoginLimiter::Verdict::kRefused:
      throw Problem(401, "unauthorized", "The header Authorization is not 'Bearer TOKEN' with a token of this server.");
    case LoginLimiter::Verdict::kLocked:
      throw Problem(429, "too_many_failed_logins",
                    "Too many wrong tokens came from this address; try again in a minute.", Problem::Retry::kSoon);
  }
  if (found.route->access == RouteAccess::kAdmin && who->role != Role::kAdmin) {
    throw Problem(403, "forbidden", "This call needs a token with the role admin.");
  }
  const auto id = found.parameters.find("id");
  if (found.route->access != RouteAccess::kAdmin && IsChange(found.route->access) &&
      !who->MayChangeVehicle(id == found.parameters.end() ? "" : id->second)) {
    throw Problem(403, "forbidden", "This token is not for this vehicle.");
  }
}

// Who did what; the log says when. A path may contain anything, and a line of the log is one line.
void Router::Audit(const HttpRequest& request, int status) const {
  const std::shared_ptr<const AccessTokens> tokens = Tokens();
  const Principal* who = tokens->Find(request.Header("authorization"));
  spdlog::info("audit: {} by {} ({}) from {} -> {}", request.method + " " + Printable(request.path),
               who == nullptr ? "anybody" : who->name, who == nullptr ? "no token" : ToString(who->role),
               request.remote_address, status);
}

bool Router::IsHealthCheck(const HttpRequest& head) const {
  const Found found = Find(head);
  return found.route != nullptr && found.route->access == RouteAccess::kHealth;
}

std::optional<HttpResponse> Router::Admit(const HttpRequest& head) {
  const LogScope scope(head.trace);
  std::string allow;
  HttpResponse refusal = Run(head, [&] {
    const Found found = Find(head);
    allow = found.allow;
    CheckAdmission(found, head);
    return HttpResponse{};
  });
  if (refusal.status < 400) {
    return std::nullopt;
  }
  if (refusal.status == 405) {
    refusal.headers["Allow"] = allow;
  }
  Finish(head, 0.0, refusal);
  return refusal;
}

std::optional<BodyStream> Router::OpenBody(const HttpRequest& head) {
  const Found found = Find(head);
  if (found.route == nullptr || !found.route->receive) {
    return std::nullopt;
  }
  HttpRequest request = head;
  request.path_parameters = found.parameters;
  return found.route->receive(request);
}

HttpResponse Router::Handle(HttpRequest request) {
  const auto start = Clock::now();
  const LogScope scope(request.trace);
  HttpResponse response = Run(request, [&] {
    const Found found = Find(request);
    if (found.route == nullptr) {
      throw ProblemOfStatus(404);
    }
    request.path_parameters = found.parameters;
    return found.route->handle(request);
  });
  Finish(request, SecondsSince(start), response);
  return response;
}

HttpResponse Router::Refuse(const HttpRequest& request, const Problem& problem) {
  const LogScope scope(request.trace);
  HttpResponse response = ToResponse(problem);
  Finish(request, 0.0, response);
  return response;
}

HttpResponse Router::Run(const HttpRequest& request, const std::function<HttpResponse()>& answer) const {
  try {
    return answer();
  } catch (const Problem& problem) {
    return ToResponse(problem);
  } catch (const OversizedJson& error) {
    return ToResponse(Problem(413, "json_too_large", error.what()));
  } catch (const MalformedJson& error) {
    return ToResponse(Problem(400, "malformed_json", error.what()));
  } catch (const JsonError& error) {
    return ToResponse(Problem(422, "invalid_field", error.what()));
  } catch (const std::exception& error) {
    spdlog::error("{} {} failed: {}", request.method, Printable(request.path), error.what());
  } catch (...) {
    spdlog::error("{} {} failed with an unknown exception", request.method, Printable(request.path));
  }
  return ToResponse(Problem(500, "internal_error", "The server failed to answer; its log says why."));
}

void Router::LogAccess(const HttpRequest& request, AccessRecord record) const {
  const std::shared_ptr<const AccessTokens> tokens = Tokens();
  const Principal* who = tokens->Find(request.Header("authorization"));
  record.method = request.method;
  record.path = request.path;
  record.remote = request.remote_address;
  record.who = who == nullptr ? "" : who->name;
  record.trace = request.trace;
  access_log_(record);
}

// Every response passes here once.
void Router::Finish(const HttpRequest& request, double seconds, HttpResponse& response) const {
  const Found found = Find(request);
  const RequestLabels labels = {found.route == nullptr ? "unmatched" : found.route->pattern,
                                found.route == nullptr ? "" : found.route->method, response.status};
  if (response.problem.empty()) {
    metrics_.CountRequest(labels, seconds);
  } else {
    metrics_.CountRefusal(labels, response.problem);
  }
  const bool is_login_refused = response.status == 401 || response.status == 429;  // as many as somebody likes
  if (found.route != nullptr && IsAudited(found.route->access) && !is_login_refused) {
    Audit(request, response.status);
  }
  if (access_log_ && (found.route == nullptr || found.route->access != RouteAccess::kHealth)) {
    AccessRecord record;
    record.route = labels.route;
    record.status = response.status;
    record.problem = response.problem;
    record.bytes = response.body.size();
    record.seconds = seconds;
    LogAccess(request, std::move(record));
  }
  if (!request.trace.request_id.empty()) {
    response.headers["X-Request-Id"] = request.trace.request_id;
  }
  if (request.trace.continued) {
    response.headers["traceparent"] = request.trace.Traceparent();
  }
}

}  // namespace floorloc
