// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/topic_choice.h"

#include <algorithm>

namespace floorloc {
namespace {

std::string Listed(const TopicList& topics) {
  std::string text;
  for (const TopicSummary* topic : topics) {
    text += (text.empty() ? "" : ", ") + topic->topic;
  }
  return text;
}

}  // namespace

TopicList TopicsThat(const BagSummary& bag, const std::function<bool(const TopicSummary&)>& fit) {
  TopicList found;
  for (const TopicSummary& topic : bag.topics) {
    if (topic.problem.empty() && fit(topic)) {
      found.push_back(&topic);
    }
  }
  return found;
}

TopicChoice ChooseTopic(const BagSummary& bag, const TopicQuery& query, const TopicList& candidates) {
  TopicChoice choice;
  if (!query.named.empty()) {
    const auto found = std::find_if(candidates.begin(), candidates.end(),
                                    [&](const TopicSummary* topic) { return topic->topic == query.named; });
    if (found != candidates.end()) {
      choice.topic = *found;
    } else if (const TopicSummary* other = bag.Find(query.named); other != nullptr && !other->problem.empty()) {
      choice.missing = other->problem;
    } else {
      choice.missing = "has no topic " + query.named + " of " + query.what +
                       (candidates.empty() ? "" : "; " + query.option + " may be " + Listed(candidates));
    }
  } else if (candidates.size() == 1) {
    choice.topic = candidates.front();
  } else if (candidates.size() > 1) {
    choice.missing = "has " + std::to_string(candidates.size()) + " topics of " + query.what + " (" +
                     Listed(candidates) + "); choose one with " + query.option;
  }
  return choice;
}

std::string RawTopic(const TopicSummary& topic) {
  const bool below = topic.plain_type() == "sensor_msgs/CompressedImage" && topic.topic.ends_with("/compressed");
  return below ? topic.topic.substr(0, topic.topic.rfind('/')) : topic.topic;
}

std::vector<std::string> PreferRaw(const BagSummary& bag, TopicList* topics) {
  std::vector<std::string> sentences;
  std::erase_if(*topics, [&](const TopicSummary* topic) {
    const TopicSummary* raw = bag.Find(RawTopic(*topic));
    const bool has_raw = raw != nullptr && raw != topic && raw->plain_type() == "sensor_msgs/Image" &&
                         raw->problem.empty() && raw->messages >= topic->messages;
    if (has_raw) {
      sentences.push_back(raw->topic + " is taken rather than " + topic->topic +
                          ": raw images have no artefacts of compression");
    }
    return has_raw;
  });
  return sentences;
}

}  // namespace floorloc
