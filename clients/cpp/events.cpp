// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/events.h"

#include <httplib.h>

#include <algorithm>
#include <stdexcept>
#include <thread>

#include "clients/cpp/targets.h"

namespace floorloc::client {
namespace {

using nlohmann::json;
using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxEventBytes = std::size_t{4} << 20;  // the server's largest are some kB
constexpr milliseconds kStopCheck{50};

CallError Malformed(const std::string& detail) { return CallError({200, kMalformedAnswer, detail, std::nullopt, ""}); }

CallError Unreachable(const std::string& detail) { return CallError({0, kUnreachable, detail, std::nullopt, ""}); }

CallError Refusal(int status, const std::string& body) {
  const json problem = json::parse(body, nullptr, false);
  if (!problem.is_object()) {
    return CallError({status, kMalformedAnswer, "The answer is not that of a floorloc-server.", std::nullopt, ""});
  }
  return CallError({status, problem.value("code", kMalformedAnswer), problem.value("detail", ""), std::nullopt, ""});
}

bool MayPass(const Failure& failure) {
  return failure.status == 429 || failure.status == 503 || failure.reason == kUnreachable;
}

}  // namespace

std::vector<Event> EventParser::Push(std::string_view bytes) {
  std::vector<Event> events;
  for (const char c : bytes) {
    const bool second_of_two = c == '\n' && after_return_;
    after_return_ = c == '\r';
    if (second_of_two) {
      continue;
    }
    if (c == '\n' || c == '\r') {
      TakeLine(line_, &events);
      line_.clear();
      continue;
    }
    line_ += c;
    if (line_.size() + data_.size() > kMaxEventBytes) {
      throw Malformed("An event has no end.");
    }
  }
  return events;
}

void EventParser::TakeLine(std::string_view line, std::vector<Event>* events) {
  if (line.empty()) {
    if (!data_.empty()) {
      json data = json::parse(data_, nullptr, false);
      if (data.is_discarded()) {
        throw Malformed("The data of an event are no JSON.");
      }
      events->push_back({type_.empty() ? "message" : type_, id_, std::move(data)});
    }
    type_.clear();
    data_.clear();
    return;
  }
  const std::size_t colon = std::min(line.find(':'), line.size());
  const std::string_view field = line.substr(0, colon);
  std::string_view value = line.substr(std::min(colon + 1, line.size()));
  value.remove_prefix(value.starts_with(' ') ? 1 : 0);
  if (field == "event") {
    type_ = value;
  } else if (field == "id") {
    id_ = value;
  } else if (field == "data") {
    data_ += data_.empty() ? "" : "\n";
    data_ += value;
  }
}

void EventOptions::Check() const {
  if (first_wait.count() <= 0 || max_wait < first_wait) {
    throw std::invalid_argument("first_wait must be positive, and max_wait not smaller");
  }
  if (patience.count() < 0) {
    throw std::invalid_argument("patience must not be negative");
  }
  if (silence.count() <= 0) {
    throw std::invalid_argument("silence must be positive");
  }
}

class EventStream::Connection {
 public:
  explicit Connection(const ClientOptions& options) : http(options.url) {
    if (!http.is_valid()) {
      throw std::invalid_argument("url must be the address of a server, such as http://localhost:8080");
    }
    http.set_url_encode(false);
    http.set_connection_timeout(options.timeout);
    http.set_write_timeout(options.timeout);
    if (!options.token.empty()) {
      http.set_default_headers({{"Authorization", "Bearer " + options.token}});
    }
  }

  httplib::Client http;
};

EventStream::EventStream(ClientOptions client, EventOptions options)
    : client_((client.Check(), std::move(client))),
      options_((options.Check(), std::move(options))),
      connection_(std::make_unique<Connection>(client_)),
      last_contact_(Clock::now()) {
  connection_->http.set_read_timeout(options_.silence);
}

EventStream::~EventStream() = default;

void EventStream::Run(const Handler& handler) {
  milliseconds wait = options_.first_wait;
  last_contact_ = Clock::now();
  while (!stopping_) {
    const auto before = last_contact_;
    try {
      Listen(handler);
    } catch (const CallError& error) {
      const bool patient = options_.patience.count() == 0 || Clock::now() - last_contact_ < options_.patience;
      if (!MayPass(error.failure()) || !patient) {
        throw;
      }
    }
    wait = last_contact_ > before ? options_.first_wait : wait;
    WaitBeforeRetry(wait);
    wait = std::min(2 * wait, options_.max_wait);
  }
}

// What comes on one connection. An exception must not pass through the library, so it waits for Finish().
class EventStream::Reception {
 public:
  Reception(EventStream& stream, const Handler& handler) : stream_(stream), handler_(handler) {}

  bool TakeHead(int status) {
    status_ = status;
    if (status == 200) {
      stream_.last_contact_ = Clock::now();
      Tell(true);
    }
    return !stream_.stopping_;
  }

  bool TakeBytes(std::string_view bytes) {
    try {
      if (status_ == 200) {
        TakeEvents(bytes);
      } else {
        refusal_.append(bytes.substr(0, kMaxEventBytes - std::min(refusal_.size(), kMaxEventBytes)));
      }
    } catch (...) {
      failure_ = std::current_exception();
    }
    return !stream_.stopping_ && !failure_;
  }

  // Throws what went wrong; nothing did when the server has closed the stream in good order, or it was stopped.
  void Finish(const httplib::Result& result) {
    if (status_ == 200) {
      Tell(false);
    }
    if (failure_) {
      std::rethrow_exception(failure_);
    }
    if (stream_.stopping_ || (status_ == 200 && result)) {
      return;
    }
    if (status_ != 0 && status_ != 200) {
      throw Refusal(status_, refusal_);
    }
    throw Unreachable("The server does not answer: " + httplib::to_string(result.error()) + ".");
  }

 private:
  void Tell(bool connected) {
    if (handler_.on_connection) {
      handler_.on_connection(connected);
    }
  }
  void TakeEvents(std::string_view bytes) {
    stream_.last_contact_ = Clock::now();
    for (const Event& event : parser_.Push(bytes)) {
      if (stream_.stopping_) {
        return;
      }
      if (!event.id.empty()) {
        stream_.options_.last_event_id = event.id;
      }
      handler_.on_event(event);
    }
  }

  EventStream& stream_;
  const Handler& handler_;
  EventParser parser_;
  int status_ = 0;
  std::string refusal_;
  std::exception_ptr failure_;
};

void EventStream::Listen(const Handler& handler) {
  httplib::Headers headers = {{"Accept", "text/event-stream"}};
  if (!options_.last_event_id.empty()) {
    headers.emplace("Last-Event-ID", options_.last_event_id);
  }
  Reception reception(*this, handler);
  reception.Finish(connection_->http.Get(
      EventTarget(options_), headers,
      [&](const httplib::Response& response) { return reception.TakeHead(response.status); },
      [&](const char* data, std::size_t size) {
        return reception.TakeBytes({data, size});
      }));
}

void EventStream::WaitBeforeRetry(milliseconds wait) const {
  const auto end = Clock::now() + wait;
  while (!stopping_ && Clock::now() < end) {
    std::this_thread::sleep_for(std::min<Clock::duration>(kStopCheck, end - Clock::now()));
  }
}

void EventStream::Stop() {
  stopping_ = true;
  connection_->http.stop();
}

}  // namespace floorloc::client
