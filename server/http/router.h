// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/access.h"
#include "server/http/access_log.h"
#include "server/http/http_handler.h"
#include "server/http/login_limiter.h"
#include "server/http/metrics.h"
#include "server/http/rate_limiter.h"

namespace floorloc {

/// Access to a route when the server has a token.
enum class RouteAccess {
  kHealth,  ///< health checks: answered whatever others do
  kPublic,  ///< the web page
  kRead,    ///< changes nothing: needs the token only with protect_reads
  kWrite,   ///< messages of a vehicle: needs a token that may change it
  kChange,  ///< the same, and the log says who did it
  kAdmin,   ///< changes what everybody uses: needs an administrator's token, and the log says who did it
};

struct Route {
  std::string method;   ///< GET also answers HEAD
  std::string pattern;  ///< "/v1/maps/{map}/tiles/{z}/{x}/{y}.jpg": a name in braces matches one segment
  RouteAccess access = RouteAccess::kRead;
  std::vector<std::string> body_types;  ///< accepted media types; empty: the call takes no body
  std::function<HttpResponse(const HttpRequest&)> handle;
  /// Before the body is read; throws a Problem to refuse the request. Optional.
  std::function<void(const HttpRequest& head)> admit = nullptr;
  /// For bodies too large for memory: where an admitted one goes. Throws a Problem to refuse it. Optional.
  std::function<BodyStream(const HttpRequest& head)> receive = nullptr;
};

struct RouterOptions {
  AccessTokens tokens;
  bool protect_reads = false;
  double max_requests_per_s = 0.0;  ///< per client address; 0: no limit
  int max_failed_logins = 10;       ///< per client address and minute; 0: no limit

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// The route table; the only place that turns exceptions into problem+json.
class Router : public HttpHandler {
 public:
  Router(RouterOptions options, Metrics& metrics);

  /// Only before serving: not thread-safe.
  void Add(Route route);
  /// Likewise. Gets every request but those of health checks; empty: none.
  void SetAccessLog(AccessLog log) { access_log_ = std::move(log); }
  /// From now on one of these tokens is required.
  void SetTokens(AccessTokens tokens);
  const std::vector<Route>& routes() const { return routes_; }

  std::optional<HttpResponse> Admit(const HttpRequest& head) override;
  bool IsHealthCheck(const HttpRequest& head) const override;
  std::optional<BodyStream> OpenBody(const HttpRequest& head) override;
  HttpResponse Handle(HttpRequest request) override;
  HttpResponse Refuse(const HttpRequest& request, const Problem& problem) override;

 private:
  struct Found {
    const Route* route = nullptr;
    std::map<std::string, std::string> parameters;
    std::string allow;  ///< methods of this path when the requested one is not among them
  };

  Found Find(const HttpRequest& request) const;
  void CheckAdmission(const Found& found, const HttpRequest& head);
  std::shared_ptr<const AccessTokens> Tokens() const;
  void CheckLogin(const Found& found, const std::string& client, const HttpRequest& head);
  void Audit(const HttpRequest& request, int status) const;
  HttpResponse Run(const HttpRequest& request, const std::function<HttpResponse()>& answer) const;
  void Finish(const HttpRequest& request, double seconds, HttpResponse& response) const;
  void LogAccess(const HttpRequest& request, AccessRecord record) const;

  RouterOptions options_;
  Metrics& metrics_;
  mutable std::mutex tokens_mutex_;
  std::shared_ptr<const AccessTokens> tokens_;  // guarded by tokens_mutex_
  RateLimiter rate_limiter_;
  LoginLimiter login_limiter_;
  std::vector<Route> routes_;
  AccessLog access_log_;
};

/// Matches a path against a pattern. Returns the values of the names in braces; empty without a match.
std::optional<std::map<std::string, std::string>> MatchPattern(std::string_view pattern, std::string_view path);

}  // namespace floorloc
