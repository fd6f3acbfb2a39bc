// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/cli/info_bag.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "core/io/trajectory.h"

namespace floorloc {
namespace {

double DurationS(const BagSummary& bag) {
  return 1e-9 * static_cast<double>(bag.recorded.last_ns - bag.recorded.first_ns);
}

nlohmann::ordered_json ToJson(const TopicSummary& topic) {
  nlohmann::ordered_json json{{"topic", topic.topic},
                              {"type", topic.type},
                              {"messages", topic.messages},
                              {"rate_hz", topic.RateHz()},
                              {"first_stamp", FormatSeconds(topic.stamps.first_ns)},
                              {"last_stamp", FormatSeconds(topic.stamps.last_ns)},
                              {"longest_gap_s", topic.longest_gap_s},
                              {"out_of_order", topic.out_of_order},
                              {"without_stamp", topic.unstamped},
                              {"frame_id", topic.frame_id}};
  if (topic.size_px) {
    json["width"] = (*topic.size_px)[0];
    json["height"] = (*topic.size_px)[1];
  }
  return json;
}

nlohmann::ordered_json ToJson(const BagSummary& bag, const SurveyPlan& plan) {
  nlohmann::ordered_json json{{"bag", bag.path.string()},
                              {"messages", bag.messages},
                              {"first_recorded", FormatSeconds(bag.recorded.first_ns)},
                              {"last_recorded", FormatSeconds(bag.recorded.last_ns)},
                              {"duration_s", DurationS(bag)}};
  json["topics"] = nlohmann::json::array();
  for (const TopicSummary& topic : bag.topics) {
    json["topics"].push_back(ToJson(topic));
  }
  json["transforms"] = nlohmann::json::array();
  for (const TransformSummary& transform : bag.transforms) {
    json["transforms"].push_back({{"parent", transform.first.parent},
                                  {"child", transform.first.child},
                                  {"messages", transform.messages},
                                  {"moves", transform.moves}});
  }
  json["warnings"] = bag.warnings;
  json["survey"] = {{"possible", plan.missing.empty()}, {"missing", plan.missing}, {"chosen", plan.notes}};
  return json;
}

void PrintTopics(const BagSummary& bag) {
  std::size_t topic_width = 5, type_width = 4;
  for (const TopicSummary& topic : bag.topics) {
    topic_width = std::max(topic_width, topic.topic.size());
    type_width = std::max(type_width, topic.plain_type().size());
  }
  const auto widths = [](std::size_t width) { return static_cast<int>(width); };
  std::printf("%-*s  %-*s %9s %9s %9s\n", widths(topic_width), "topic", widths(type_width), "type", "messages", "Hz",
              "gap s");
  for (const TopicSummary& topic : bag.topics) {
    std::printf("%-*s  %-*s %9lld %9.2f %9.3f", widths(topic_width), topic.topic.c_str(), widths(type_width),
                topic.plain_type().c_str(), static_cast<long long>(topic.messages), topic.RateHz(),
                topic.longest_gap_s);
    if (topic.size_px) {
      std::printf("  %dx%d", (*topic.size_px)[0], (*topic.size_px)[1]);
    }
    if (topic.out_of_order > 0) {
      std::printf("  %lld out of order", static_cast<long long>(topic.out_of_order));
    }
    std::printf("\n");
  }
}

void PrintList(const char* title, const std::vector<std::string>& sentences) {
  for (const std::string& sentence : sentences) {
    std::printf("%-12s %s\n", title, sentence.c_str());
  }
}

void PrintText(const BagSummary& bag, const SurveyPlan& plan) {
  std::printf("bag          %s\nmessages     %lld in %.1f s, recorded %s to %s\n", bag.path.c_str(),
              static_cast<long long>(bag.messages), DurationS(bag), FormatSeconds(bag.recorded.first_ns).c_str(),
              FormatSeconds(bag.recorded.last_ns).c_str());
  PrintTopics(bag);
  PrintList("warning", bag.warnings);
  PrintList("chosen", plan.notes);
  PrintList("missing", plan.missing);
  std::printf("survey       %s\n", plan.missing.empty() ? "build --bag and export --survey can use it as it is"
                                                        : "not yet: see what is missing");
}

}  // namespace

void PrintBag(const BagSummary& bag, const SurveyPlan& plan, bool json) {
  if (json) {
    std::cout << ToJson(bag, plan).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
  } else {
    PrintText(bag, plan);
  }
}

}  // namespace floorloc
