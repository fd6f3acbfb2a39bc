// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/io/stamp_range.h"
#include "mapbuilder/bag/ros_messages.h"
#include "mapbuilder/unpack/frame_tree.h"

namespace floorloc {

struct TopicSummary {
  std::string topic;
  std::string type;  ///< as the bag has it
  std::int64_t messages = 0;
  StampRange stamps;              ///< earliest and latest, of the headers where messages have one, else of recording
  double longest_gap_s = 0.0;     ///< between stamps in their order in the bag
  std::int64_t out_of_order = 0;  ///< messages that are earlier than the one before
  std::int64_t unstamped = 0;     ///< messages whose header has the stamp 0
  std::string frame_id;           ///< of the first message
  std::string child_frame_id;     ///< of the first message
  std::optional<std::array<int, 2>> size_px;  ///< width and height of the first image
  std::string problem;  ///< why the first of its messages that cannot be read cannot; empty: all can

  std::string plain_type() const { return PlainType(type); }
  double DurationS() const { return 1e-9 * static_cast<double>(stamps.last_ns - stamps.first_ns); }
  /// Messages per second; 0 where there is one.
  double RateHz() const {
    return messages > 1 && DurationS() > 0.0 ? static_cast<double>(messages - 1) / DurationS() : 0.0;
  }
};

/// One transform of the transforms' topics, at all times.
struct TransformSummary {
  FixedTransform first;
  std::int64_t messages = 0;
  bool moves = false;
  bool on_static_topic = false;
};

/// What is in a bag. The first CameraInfo of each topic is kept, and of each transform the first.
struct BagSummary {
  std::filesystem::path path;
  std::vector<TopicSummary> topics;  ///< by name; those without messages are not listed
  std::vector<TransformSummary> transforms;
  std::map<std::string, RosCameraInfo> cameras;  ///< by topic
  std::int64_t messages = 0;
  StampRange recorded;                ///< of the times of recording
  std::vector<std::string> warnings;  ///< what was cut, and what can't be read; one sentence each

  const TopicSummary* Find(const std::string& topic) const;
  /// Those that never change.
  FrameTree FixedFrames() const;
};

/// Reads a bag from its first to its last message. Throws InputError.
BagSummary SummarizeBag(const std::filesystem::path& path);

}  // namespace floorloc
