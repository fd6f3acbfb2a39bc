// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/unpack_bag.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"
#include "core/io/trajectory.h"
#include "mapbuilder/bag/open_bag.h"
#include "mapbuilder/bag/ros_image.h"
#include "mapbuilder/batch/pending_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

// Stamps of topics whose headers have none are those of recording; single ones without are left out. A clock of a
// simulation begins at 0, so that its first message may have that very stamp.
class Clock {
 public:
  explicit Clock(const TopicSummary* topic) {
    if (topic != nullptr) {
      by_recording_ = topic->unstamped == topic->messages && topic->messages > 1;
      constexpr std::int64_t kLongestSimulationNs = 1'000'000'000'000'000;
      drops_zero_ = !by_recording_ && topic->unstamped > 0 &&
                    (topic->unstamped > 1 || topic->stamps.last_ns > kLongestSimulationNs);
    }
  }
  // Empty: the message is of no use.
  std::optional<std::int64_t> StampOf(const RosHeader& header, const BagMessage& message) const {
    if (by_recording_) {
      return message.record_ns;
    }
    return drops_zero_ && header.stamp_ns == 0 ? std::nullopt : std::optional(header.stamp_ns);
  }
  bool by_recording() const { return by_recording_; }
  bool drops_zero() const { return drops_zero_; }

 private:
  bool by_recording_ = false;
  bool drops_zero_ = false;
};

// Sorts by time and leaves out repeated stamps. Returns how many those are.
template <typename Row>
std::size_t PutInOrder(std::vector<Row>* rows) {
  std::stable_sort(rows->begin(), rows->end(), [](const Row& a, const Row& b) { return a.stamp_ns < b.stamp_ns; });
  const auto repeated =
      std::unique(rows->begin(), rows->end(), [](const Row& a, const Row& b) { return a.stamp_ns == b.stamp_ns; });
  const auto count = static_cast<std::size_t>(rows->end() - repeated);
  rows->erase(repeated, rows->end());
  return count;
}

class Unpacker {
 public:
  Unpacker(const BagSummary& bag, const SurveyPlan& plan, const fs::path& folder)
      : bag_(bag),
        plan_(plan),
        folder_(folder),
        image_clock_(bag.Find(plan.image_topic)),
        odometry_clock_(plan.odometry ? bag.Find(plan.odometry->topic) : nullptr),
        truth_clock_(plan.truth ? bag.Find(plan.truth->topic) : nullptr),
        imu_clock_(bag.Find(plan.imu_topic)) {
    std::error_code error;
    fs::create_directories(folder_ / "images", error);
    if (error) {
      throw InputError(folder_ / "images", "cannot be created (" + error.message() + "); check its permissions");
    }
  }

  void Take(const BagMessage& message) {
    const std::string& topic = message.connection->topic;
    if (topic == plan_.image_topic) {
      TakeImage(message);
    }
    if (plan_.odometry && topic == plan_.odometry->topic) {
      TakePose(message, *plan_.odometry, odometry_clock_, &odometry_);
    }
    if (plan_.truth && topic == plan_.truth->topic) {
      TakePose(message, *plan_.truth, truth_clock_, &truth_);
    }
    if (!plan_.imu_topic.empty() && topic == plan_.imu_topic) {
      TakeImu(message);
    }
    if (plan_.odometry && plan_.odometry->topic.empty() && IsTransformType(PlainType(message.connection->type))) {
      TakeTransforms(message);
    }
  }

  UnpackedBag Finish() {
    UnpackedBag result;
    result.notes = plan_.notes;
    result.warnings = bag_.warnings;
    Finish("images", plan_.image_topic, image_clock_, &frames_, &result);
    Finish("odometry", plan_.odometry ? plan_.odometry->topic : "", odometry_clock_, &odometry_, &result);
    Finish("ground truth", plan_.truth ? plan_.truth->topic : "", truth_clock_, &truth_, &result);
    Finish("IMU", plan_.imu_topic, imu_clock_, &imu_, &result);
    if (frames_.empty()) {
      throw InputError(bag_.path, "has no image with a stamp; correct the driver, or record again");
    }
    result.frames = static_cast<std::int64_t>(frames_.size());
    result.odometry = static_cast<std::int64_t>(odometry_.size());
    result.imu = static_cast<std::int64_t>(imu_.size());
    WriteTables();
    return result;
  }

 private:
  void TakeImage(const BagMessage& message) {
    const std::optional<std::int64_t> stamp_ns = image_clock_.StampOf(ParseHeader(message), message);
    if (!stamp_ns) {
      return;
    }
    const ImageFile image = ToImageFile(message);
    char name[40];
    std::snprintf(name, sizeof(name), "images/%06zu%s", frames_.size(), image.extension.c_str());
    std::ofstream out(folder_ / name, std::ios::binary);
    out.write(reinterpret_cast<const char*>(image.bytes.data()), static_cast<std::streamsize>(image.bytes.size()));
    out.close();
    if (!out) {
      throw InputError(folder_ / name, "cannot be written; is the disk full?");
    }
    frames_.push_back({*stamp_ns, name});
  }

  static void AddPose(std::int64_t stamp_ns, const Eigen::Isometry3d& pose, Trajectory* trajectory) {
    trajectory->push_back({stamp_ns, pose.translation(), Eigen::Quaterniond(pose.linear())});
  }

  static void TakePose(const BagMessage& message, const PoseSource& source, const Clock& clock,
                       Trajectory* trajectory) {
    const RosPose pose = ParsePose(message);
    if (const auto stamp_ns = clock.StampOf(pose.header, message)) {
      AddPose(*stamp_ns, pose.pose * source.child_from_base, trajectory);
    }
  }

  void TakeTransforms(const BagMessage& message) {
    for (const RosTransform& t : ParseTransforms(message)) {
      if (t.header.frame_id == plan_.odometry->parent && t.child_frame_id == plan_.odometry->child) {
        AddPose(t.header.stamp_ns, t.parent_from_child * plan_.odometry->child_from_base, &odometry_);
      }
    }
  }

  void TakeImu(const BagMessage& message) {
    const RosImu imu = ParseImu(message);
    if (const auto stamp_ns = imu_clock_.StampOf(imu.header, message)) {
      imu_.push_back({*stamp_ns, plan_.base_from_imu * imu.angular_velocity, plan_.base_from_imu * imu.acceleration});
    }
  }

  template <typename Row>
  void Finish(const std::string& what, const std::string& name, const Clock& clock, std::vector<Row>* rows,
              UnpackedBag* result) const {
    const std::size_t repeated = PutInOrder(rows);
    if (repeated > 0) {
      result->warnings.push_back(what + ": left out " + std::to_string(repeated) + " with the stamp of another one");
    }
    const TopicSummary* topic = bag_.Find(name);
    if (topic == nullptr) {
      return;
    }
    if (clock.by_recording()) {
      result->warnings.push_back(what + ": the headers of " + name + " have no stamps; those of recording are used");
    } else if (clock.drops_zero()) {
      result->warnings.push_back(what + ": left out " + std::to_string(topic->unstamped) + " without a stamp");
    }
    if (topic->out_of_order > 0) {
      result->warnings.push_back(what + ": " + std::to_string(topic->out_of_order) +
                                 " were recorded after a later one; they were put in order");
    }
  }

  void WriteTables() const {
    WriteFileAtomically(folder_ / "camera.yaml", FormatCameraYaml(plan_.camera));
    if (plan_.floor) {
      WriteFileAtomically(folder_ / "floor.yaml", FormatFloorYaml(*plan_.floor, plan_.mounting));
    }
    if (!odometry_.empty()) {
      WriteFileAtomically(folder_ / "odometry.tum", FormatTum(odometry_));
    }
    if (!truth_.empty()) {
      WriteFileAtomically(folder_ / "groundtruth.tum", FormatTum(truth_));
    }
    if (!imu_.empty()) {
      WriteFileAtomically(folder_ / "imu.csv", FormatImuCsv(imu_));
    }
    std::string table = "timestamp,filename\n";
    for (const SurveyFrame& frame : frames_) {
      table += FormatSeconds(frame.stamp_ns) + "," + frame.filename + "\n";
    }
    WriteFileAtomically(folder_ / "frames.csv", table);
  }

  const BagSummary& bag_;
  const SurveyPlan& plan_;
  fs::path folder_;
  Clock image_clock_, odometry_clock_, truth_clock_, imu_clock_;
  std::vector<SurveyFrame> frames_;
  Trajectory odometry_;
  Trajectory truth_;
  std::vector<ImuSample> imu_;
};

}  // namespace

std::string BagName(const std::filesystem::path& bag) {
  std::string name = FolderName(bag);
  std::error_code ignored;
  if (fs::is_directory(bag, ignored)) {
    return name;
  }
  for (const char* ending : {".zstd", ".active", ".db3", ".mcap", ".bag"}) {
    if (name.ends_with(ending)) {
      name.resize(name.size() - std::string_view(ending).size());
    }
  }
  return name;
}

UnpackedBag UnpackBag(const BagSummary& bag, const SurveyPlan& plan, const std::filesystem::path& folder,
                      const RunOptions& run) {
  run.Check();
  if (!plan.missing.empty()) {
    throw InputError(bag.path, plan.missing.front());
  }
  PendingFolder pending(folder);
  Unpacker unpacker(bag, plan, pending.path());
  const std::unique_ptr<BagReader> reader = OpenBag(bag.path);
  ProgressBar progress("unpack", bag.messages, run.progress);
  while (const std::optional<BagMessage> message = reader->Next()) {
    unpacker.Take(*message);
    progress.Advance();
  }
  UnpackedBag result = unpacker.Finish();
  pending.Complete();
  return result;
}

}  // namespace floorloc
