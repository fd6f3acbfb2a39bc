// SPDX-License-Identifier: Apache-2.0
#include "server/http/request_loop.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "server/http/listener.h"
#include "server/http/raw_response.h"
#include "server/wire/chunked_framing.h"
#include "server/wire/header_text.h"
#include "server/wire/multipart.h"
#include "server/wire/request_head.h"

// Included after Eigen: httplib.h includes <resolv.h>, whose macro _res is the name of a parameter in Eigen.
#include <httplib.h>

namespace floorloc {
namespace {

constexpr std::size_t kBodyOverheadBytes = std::size_t{64} << 10;  // chunk sizes, part headers
constexpr std::size_t kProlongBytes = std::size_t{1} << 20;        // of a long body, for request_timeout_s each

class ConnectionStream : public httplib::Stream {
 public:
  explicit ConnectionStream(Connection& connection) : connection_(connection) {}
  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* data, size_t size) override {
    const ssize_t count = connection_.Read(data, size);
    const bool well_framed =
        !chunks_ || count <= 0 || chunks_->Accept(std::string_view(data, static_cast<std::size_t>(count)));
    return well_framed ? count : -1;
  }
  ssize_t write(const char* data, size_t size) override { return connection_.Write(data, size); }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = RemoteAddress(connection_.socket());
    port = 0;
  }
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return connection_.socket(); }

  /// The library takes sizes of chunks that others read differently, "0x10" or " 5" for instance.
  void CheckChunks(bool chunked) { chunks_ = chunked ? std::optional<ChunkedFraming>(std::in_place) : std::nullopt; }
  bool AtEndOfChunks() const { return !chunks_ || chunks_->complete(); }

 private:
  Connection& connection_;
  std::optional<ChunkedFraming> chunks_;
};

HttpRequest ToRequest(const httplib::Request& raw, const std::string& content_type) {
  HttpRequest request;
  request.method = raw.method;
  request.path = raw.path;
  request.query = raw.params;
  request.remote_address = raw.remote_addr;
  for (const auto& [name, value] : raw.headers) {
    request.headers.emplace(LowerCase(name), value);
  }
  if (!content_type.empty()) {
    request.headers["content-type"] = content_type;
  }
  request.trace = StartTrace(request.headers);
  return request;
}

void Fill(const HttpResponse& response, httplib::Response& raw) {
  raw.status = response.status;
  raw.set_content(response.body, response.content_type);
  for (const auto& [name, value] : response.headers) {
    raw.set_header(name, value);
  }
}

/// Parses the requests of one connection with cpp-httplib and hands them to the handler.
class RequestLoop : private httplib::Server {
 public:
  RequestLoop(Connection& connection, ConnectionPlace& place, const ServingContext& context)
      : connection_(connection),
        place_(place),
        stream_(connection),
        limits_(context.limits),
        budget_(context.budget),
        handler_(context.handler) {
    // Any path, including line breaks.
    static const std::string kAnything = R"([\s\S]*)";
    const HandlerWithContentReader with_body = [this](const httplib::Request& raw, httplib::Response& answer,
                                                      const httplib::ContentReader& reader) {
      HandleWithBody(raw, answer, reader);
    };
    Post(kAnything, with_body).Put(kAnything, with_body).Patch(kAnything, with_body).Delete(kAnything, with_body);
    set_pre_routing_handler(
        [this](const httplib::Request& raw, httplib::Response& answer) { return HandleWithoutBody(raw, answer); });
    set_error_handler([this](const httplib::Request& raw, httplib::Response& answer) {
      if (answer.body.empty()) {
        Fill(handler_.Refuse(ToRequest(raw, content_type_), ProblemOfStatus(answer.status)), answer);
      }
    });
    set_post_routing_handler([this](const httplib::Request&, httplib::Response& answer) {
      if (close_) {
        answer.headers.erase("Connection");
        answer.headers.erase("Keep-Alive");
        answer.set_header("Connection", "close");
      }
    });
    set_payload_max_length(std::numeric_limits<std::size_t>::max());  // ReadBody() has the limits
    set_keep_alive_timeout(static_cast<time_t>(limits_.idle_timeout_s));
    set_keep_alive_max_count(std::numeric_limits<std::int32_t>::max());
  }

  void Run() {
    while (connection_.WaitForRequest() && ServeOne()) {
      place_.SetWaiting(true);
    }
    place_.SetWaiting(true);
    connection_.Drain();
  }

 private:
  static bool TakesBody(const std::string& method) {
    return method == "POST" || method == "PUT" || method == "PATCH" || method == "DELETE";
  }

  // Is there a next request on this connection?
  bool ServeOne() {
    const bool stopping = connection_.IsStopping();
    stream_.CheckChunks(false);
    try {
      const std::optional<std::string_view> head = connection_.ReadHead();
      if (!head) {
        return false;
      }
      place_.SetWaiting(false);
      head_ = ParseRequestHead(*head);
    } catch (const Problem& problem) {
      HttpRequest nothing;
      nothing.remote_address = RemoteAddress(connection_.socket());
      nothing.trace = StartTrace({});
      connection_.DrainInputOnClose();
      WriteLastResponse(handler_.Refuse(nothing, problem), connection_);
      return false;
    }
    close_ = true;  // until the library has parsed it too: without that the start of the next one is unknown
    bool close_requested = false;
    const bool answered = process_request(stream_, stopping, close_requested, [this, stopping](httplib::Request& raw) {
      close_ = stopping || !head_.keep_alive || place_.reserved();
      raw.ranges.clear();
      raw.headers.erase("Expect");  // answered when the request is admitted
      content_type_ = raw.get_header_value("Content-Type");
      raw.headers.erase("Content-Type");  // the library would take bodies with parts apart in its own way
      // A body that no handler reads would otherwise be parsed as the next request.
      if (HasBody() && !TakesBody(raw.method)) {
        CloseWithUnreadBody();
      }
      stream_.CheckChunks(head_.framing == BodyFraming::kChunked);
      connection_.AllowBody(limits_.max_body_bytes + kBodyOverheadBytes);
    });
    if (stream_response_) {
      StartStream();
      return false;
    }
    return connection_.Flush() && answered && !close_requested && !close_;
  }

  // The library has answered with an empty body instead.
  void StartStream() {
    connection_.DiscardOutput();
    if (WriteStreamHead(*stream_response_, connection_)) {
      stream_response_->take_over(connection_.socket());
    }
  }

  bool HasBody() const { return head_.framing == BodyFraming::kChunked || head_.content_length > 0; }

  void CloseWithUnreadBody() {
    close_ = true;
    connection_.DrainInputOnClose();
  }

  std::optional<HttpResponse> Admit(const HttpRequest& request) {
    return place_.reserved() && !handler_.IsHealthCheck(request)
               ? std::optional(handler_.Refuse(request, TooManyConnections()))
               : handler_.Admit(request);
  }

  HandlerResponse HandleWithoutBody(const httplib::Request& raw, httplib::Response& answer) {
    if (TakesBody(raw.method)) {
      return HandlerResponse::Unhandled;
    }
    HttpRequest request = ToRequest(raw, content_type_);
    const std::optional<HttpResponse> refusal = Admit(request);
    const HttpResponse response = refusal ? *refusal : handler_.Handle(std::move(request));
    Fill(response, answer);
    if (response.take_over && raw.method == "GET") {
      stream_response_ = response;
    }
    return HandlerResponse::Handled;
  }

  void HandleWithBody(const httplib::Request& raw, httplib::Response& answer, const httplib::ContentReader& reader) {
    HttpRequest request = ToRequest(raw, content_type_);
    if (const std::optional<HttpResponse> refusal = Admit(request)) {
      Fill(*refusal, answer);
      if (HasBody() || refusal->status == 411) {
        CloseWithUnreadBody();
      }
      return;
    }
    try {
      const std::optional<BodyStream> stream = handler_.OpenBody(request);
      const BodyReservation reservation(budget_, stream ? 0 : BytesToReserve(raw));
      ReadBody(answer, reader, {stream, reservation.ok()}, request);
      Fill(handler_.Handle(std::move(request)), answer);
    } catch (const Problem& problem) {
      CloseWithUnreadBody();
      request.sink.reset();
      Fill(handler_.Refuse(request, problem), answer);
    }
  }

  // Without Content-Length, or with compression, the body may grow up to the limit.
  std::size_t BytesToReserve(const httplib::Request& raw) const {
    if (!HasBody()) {
      return 0;
    }
    const bool announced = head_.framing == BodyFraming::kLength && !raw.has_header("Content-Encoding");
    return announced ? std::min<std::size_t>(head_.content_length, limits_.max_body_bytes) : limits_.max_body_bytes;
  }

  struct BodyPlace {
    std::optional<BodyStream> stream;
    bool reserved = false;

    std::size_t MaxBytes(const HttpLimits& limits) const { return stream ? stream->max_bytes : limits.max_body_bytes; }
  };

  void ReadBody(const httplib::Response& answer, const httplib::ContentReader& reader, const BodyPlace& place,
                HttpRequest& request) {
    if (place.stream) {
      request.sink = place.stream->sink;
      connection_.AllowBody(place.stream->max_bytes + place.stream->max_bytes / 16 + kBodyOverheadBytes);
    }
    if (!HasBody()) {
      return;
    }
    const std::size_t max_bytes = place.MaxBytes(limits_);
    if (head_.content_length > max_bytes) {
      throw TooLarge(max_bytes);
    }
    if (!place.reserved) {
      throw Overload("overloaded", "Too many large requests at once; try again in a moment.");
    }
    if (head_.framing == BodyFraming::kLength && !place.stream) {
      request.body.reserve(head_.content_length);  // growing would need up to three times as much
    }
    if (head_.expects_continue && !connection_.SendContinue()) {
      throw connection_.TimeoutProblem();
    }
    bool exceeded = false;
    const bool complete = place.stream ? ReadStream(reader, *place.stream->sink) : ReadPlain(reader, request, exceeded);
    if (exceeded) {
      throw TooLarge(max_bytes);
    }
    if (!complete && answer.status == 415) {
      throw ProblemOfStatus(415);
    }
    if (!complete && connection_.timed_out()) {
      throw connection_.TimeoutProblem();
    }
    if (!complete || !stream_.AtEndOfChunks()) {
      throw Problem(400, "malformed_body", "The body ended before it was complete, or its chunks are malformed.");
    }
    if (request.ContentType() == "multipart/form-data") {
      request.parts = ParseMultipart(request.body, request.Header("content-type"));
      request.body = std::string();
    }
  }

  static Problem TooLarge(std::size_t max_bytes) {
    return {413, "body_too_large", "The body is larger than " + std::to_string(max_bytes) + " bytes."};
  }

  // A client that is slower than kProlongBytes in request_timeout_s is given up.
  bool ReadStream(const httplib::ContentReader& reader, BodySink& sink) {
    std::uint64_t bytes = 0;
    return reader([&](const char* data, std::size_t size) {
      if (bytes / kProlongBytes != (bytes + size) / kProlongBytes) {
        connection_.ProlongRequest();
      }
      bytes += size;
      sink.Write({data, size});
      return true;
    });
  }

  bool ReadPlain(const httplib::ContentReader& reader, HttpRequest& request, bool& exceeded) const {
    return reader([&](const char* data, std::size_t size) {
      exceeded = request.body.size() + size > limits_.max_body_bytes;
      if (!exceeded) {
        request.body.append(data, size);
      }
      return !exceeded;
    });
  }

  Connection& connection_;
  ConnectionPlace& place_;
  ConnectionStream stream_;
  const HttpLimits& limits_;
  BodyBudget& budget_;
  HttpHandler& handler_;
  RequestHead head_;
  std::string content_type_;
  bool close_ = false;
  std::optional<HttpResponse> stream_response_;  // whose body others write
};

}  // namespace

void ServeRequests(Connection& connection, ConnectionPlace& place, const ServingContext& context) {
  RequestLoop(connection, place, context).Run();
}

Overload TooManyConnections() {
  return {"too_many_connections", "The server has reached its limit of connections; try again later."};
}

}  // namespace floorloc
