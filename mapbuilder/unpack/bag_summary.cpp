// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/bag_summary.h"

#include <algorithm>

#include "core/io/image.h"
#include "core/io/input_error.h"
#include "mapbuilder/bag/open_bag.h"

namespace floorloc {
namespace {

// Static transforms that nodes publish again and again differ by rounding only.
constexpr double kSameTransform = 1e-6;

std::optional<std::array<int, 2>> SizeOf(const BagMessage& message) {
  if (PlainType(message.connection->type) == "sensor_msgs/Image") {
    const RosImage image = ParseImage(message);
    return std::array{static_cast<int>(image.width_px), static_cast<int>(image.height_px)};
  }
  const std::optional<ImageHeader> header = ProbeImage(ParseCompressedImage(message).data);
  return header ? std::optional(std::array{header->width_px, header->height_px}) : std::nullopt;
}

class Summarizer {
 public:
  explicit Summarizer(BagSummary* summary) : summary_(*summary) {}

  void Add(const BagMessage& message) {
    if (summary_.messages++ == 0) {
      summary_.recorded = {message.record_ns, message.record_ns};
    }
    summary_.recorded.first_ns = std::min(summary_.recorded.first_ns, message.record_ns);
    summary_.recorded.last_ns = std::max(summary_.recorded.last_ns, message.record_ns);
    Topic& topic = topics_[message.connection->topic];
    if (topic.summary.messages == 0) {
      topic.summary.topic = message.connection->topic;
      topic.summary.type = message.connection->type;
    }
    std::int64_t stamp_ns = message.record_ns;
    try {
      Describe(message, &topic.summary);
      stamp_ns = HasHeader(topic.summary.plain_type()) ? ParseHeader(message).stamp_ns : stamp_ns;
    } catch (const InputError& error) {
      topic.summary.problem = topic.summary.problem.empty() ? error.what() : topic.summary.problem;
    }
    CountStamp(stamp_ns, &topic);
  }

  void Finish() {
    for (auto& [name, topic] : topics_) {
      if (!topic.summary.problem.empty()) {
        summary_.warnings.push_back(topic.summary.problem);
      }
      summary_.topics.push_back(std::move(topic.summary));
    }
    for (auto& [names, transform] : transforms_) {
      summary_.transforms.push_back(std::move(transform));
    }
  }

 private:
  struct Topic {
    TopicSummary summary;
    std::int64_t last_ns = 0;
  };

  static void CountStamp(std::int64_t stamp_ns, Topic* topic) {
    TopicSummary& s = topic->summary;
    if (s.messages++ == 0) {
      s.stamps = {stamp_ns, stamp_ns};
    } else {
      s.longest_gap_s = std::max(s.longest_gap_s, 1e-9 * static_cast<double>(stamp_ns - topic->last_ns));
      s.out_of_order += stamp_ns < topic->last_ns ? 1 : 0;
    }
    s.unstamped += stamp_ns == 0 ? 1 : 0;
    s.stamps.first_ns = std::min(s.stamps.first_ns, stamp_ns);
    s.stamps.last_ns = std::max(s.stamps.last_ns, stamp_ns);
    topic->last_ns = stamp_ns;
  }

  // What the first message tells, of transforms each.
  void Describe(const BagMessage& message, TopicSummary* topic) {
    const std::string type = topic->plain_type();
    if (IsTransformType(type)) {
      AddTransforms(message);
    }
    if (topic->messages > 0 || !HasHeader(type)) {
      return;
    }
    topic->frame_id = ParseHeader(message).frame_id;
    if (IsImageType(type)) {
      topic->size_px = SizeOf(message);
    } else if (IsPoseType(type)) {
      topic->child_frame_id = ParsePose(message).child_frame_id;
    } else if (type == "sensor_msgs/CameraInfo") {
      summary_.cameras.emplace(topic->topic, ParseCameraInfo(message));
    }
  }

  void AddTransforms(const BagMessage& message) {
    const bool is_static = message.connection->topic.ends_with("tf_static");
    for (RosTransform& t : ParseTransforms(message)) {
      const auto [found, is_new] = transforms_.try_emplace({t.header.frame_id, t.child_frame_id});
      TransformSummary& transform = found->second;
      if (is_new) {
        transform.first = {t.header.frame_id, t.child_frame_id, t.parent_from_child};
      }
      ++transform.messages;
      transform.on_static_topic |= is_static;
      transform.moves |= !transform.first.parent_from_child.isApprox(t.parent_from_child, kSameTransform);
    }
  }

  BagSummary& summary_;
  std::map<std::string, Topic> topics_;
  std::map<std::pair<std::string, std::string>, TransformSummary> transforms_;
};

}  // namespace

const TopicSummary* BagSummary::Find(const std::string& topic) const {
  const auto found =
      std::find_if(topics.begin(), topics.end(), [&](const TopicSummary& t) { return t.topic == topic; });
  return found == topics.end() ? nullptr : &*found;
}

FrameTree BagSummary::FixedFrames() const {
  std::vector<FixedTransform> fixed;
  for (const TransformSummary& transform : transforms) {
    if (transform.on_static_topic || !transform.moves) {
      fixed.push_back(transform.first);
    }
  }
  return FrameTree(std::move(fixed));
}

BagSummary SummarizeBag(const std::filesystem::path& path) {
  const std::unique_ptr<BagReader> reader = OpenBag(path);
  BagSummary summary;
  summary.path = path;
  Summarizer summarizer(&summary);
  while (const std::optional<BagMessage> message = reader->Next()) {
    summarizer.Add(*message);
  }
  summary.warnings = reader->warnings();
  summarizer.Finish();
  return summary;
}

}  // namespace floorloc
