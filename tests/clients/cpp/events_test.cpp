// SPDX-License-Identifier: Apache-2.0
#include "clients/cpp/events.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "clients/cpp/targets.h"
#include "tests/clients/cpp/scripted_server.h"

namespace floorloc::client {
namespace {

using std::chrono::milliseconds;

ScriptedServer::Answer Stream(const std::string& text) {
  return [text](httplib::Response& response) { response.set_content(text, "text/event-stream"); };
}

EventOptions QuickOptions() {
  EventOptions options;
  options.first_wait = milliseconds(1);
  options.max_wait = milliseconds(5);
  options.patience = milliseconds(100);
  return options;
}

ClientOptions Options(const ScriptedServer& server) {
  ClientOptions options;
  options.url = server.url();
  return options;
}

std::vector<std::string> Summary(const std::vector<Event>& events) {
  std::vector<std::string> summary;
  for (const Event& event : events) {
    summary.push_back(event.id + ' ' + event.type + ' ' + event.data.dump());
  }
  return summary;
}

TEST(EventParserTest, EventsMayBeCutAnywhere) {
  const std::string text =
      ": hello\n\nid: 7\nevent: pose\ndata: {\"x\":1}\n\nid:8\r\nevent: gap\r\ndata: {}\r\n\r\nevent: half\n";
  const auto expected = testing::ElementsAre("7 pose {\"x\":1}", "8 gap {}");
  EventParser whole;
  EXPECT_THAT(Summary(whole.Push(text)), expected);
  EventParser bytewise;
  std::vector<Event> events;
  for (const char c : text) {
    for (Event& event : bytewise.Push({&c, 1})) {
      events.push_back(std::move(event));
    }
  }
  EXPECT_THAT(Summary(events), expected);
}

TEST(EventParserTest, RefusesWhatIsNoEvent) {
  EXPECT_THROW(EventParser().Push("data: {\n\n"), CallError);
  EventParser parser;
  const std::string piece(1 << 20, 'x');
  EXPECT_THROW(
      {
        for (int i = 0; i < 5; ++i) {
          parser.Push(piece);
        }
      },
      CallError);
}

TEST(EventStreamTest, GoesOnAfterTheLastEventOnAnotherConnection) {
  ScriptedServer server({Stream("id: 4\nevent: pose\ndata: {}\n\n"), Problem(503, "too_many_streams"),
                         Stream("id: 5\nevent: status\ndata: {}\n\n")});
  EventOptions options = QuickOptions();
  options.patience = milliseconds(0);
  options.vehicle = "agv7";
  options.types = {"pose", "status"};
  EventStream stream(Options(server), options);
  std::vector<std::string> heard;
  std::vector<bool> connections;
  stream.Run({[&](const Event& event) {
                heard.push_back(event.id);
                if (event.id == "5") {
                  stream.Stop();
                }
              },
              [&](bool connected) { connections.push_back(connected); }});
  EXPECT_THAT(heard, testing::ElementsAre("4", "5"));
  EXPECT_THAT(connections, testing::ElementsAre(true, false, true, false));
  ASSERT_EQ(server.asked().size(), 3U);
  EXPECT_EQ(server.asked()[0].target, "/v1/events?vehicle=agv7&types=pose,status");
  EXPECT_EQ(server.asked()[0].last_event_id, "");
  EXPECT_EQ(server.asked()[1].last_event_id, "4");
}

TEST(EventStreamTest, ARefusalAndLostPatienceAreErrors) {
  ScriptedServer server({Problem(401, "unauthorized")});
  EventStream refused(Options(server), QuickOptions());
  try {
    refused.Run({[](const Event&) {}});
    ADD_FAILURE() << "the server refused";
  } catch (const CallError& error) {
    EXPECT_EQ(error.status(), 401);
    EXPECT_EQ(error.reason(), "unauthorized");
  }
  EventStream nobody(Options(server), QuickOptions());
  server.Stop();
  try {
    nobody.Run({[](const Event&) {}});
    ADD_FAILURE() << "nobody answers";
  } catch (const CallError& error) {
    EXPECT_EQ(error.reason(), kUnreachable);
  }
}

TEST(EventStreamTest, NamesAWrongOption) {
  EventOptions options;
  options.max_wait = milliseconds(1);
  EXPECT_THROW(options.Check(), std::invalid_argument);
  options = {};
  options.silence = milliseconds(0);
  EXPECT_THROW(EventStream({}, options), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc::client
