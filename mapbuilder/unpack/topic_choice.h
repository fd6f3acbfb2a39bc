// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mapbuilder/unpack/bag_summary.h"

namespace floorloc {

using TopicList = std::vector<const TopicSummary*>;

/// Those that can be read and fit, by name.
TopicList TopicsThat(const BagSummary& bag, const std::function<bool(const TopicSummary&)>& fit);

/// What a topic is sought for.
struct TopicQuery {
  std::string named;   ///< by its option; empty: the only one
  std::string what;    ///< "images", as in a sentence
  std::string option;  ///< "--image-topic", and what else would help
};

struct TopicChoice {
  const TopicSummary* topic = nullptr;  ///< nullptr: there is none, or it can't be told
  std::string missing;                  ///< why it can't be told, with the topics there are and the option; else empty
};

/// The topic that an option names, or the only candidate.
TopicChoice ChooseTopic(const BagSummary& bag, const TopicQuery& query, const TopicList& candidates);

/// The name of a camera's raw topic, whose compressed ones are below it (wiki.ros.org/image_transport).
std::string RawTopic(const TopicSummary& topic);

/// Leaves out compressed topics of cameras that were recorded raw as well: raw images have no artefacts of compression.
/// Returns a sentence for each.
std::vector<std::string> PreferRaw(const BagSummary& bag, TopicList* topics);

}  // namespace floorloc
