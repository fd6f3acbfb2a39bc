// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/unpack/survey_plan.h"

#include <algorithm>
#include <cstdio>
#include <numbers>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/survey.h"
#include "core/io/text_file.h"
#include "mapbuilder/unpack/camera_of_bag.h"
#include "mapbuilder/unpack/topic_choice.h"

namespace floorloc {
namespace {

class Planner {
 public:
  Planner(const BagSummary& bag, const SurveyChoice& choice) : bag_(bag), choice_(choice), frames_(bag.FixedFrames()) {}

  SurveyPlan Plan() {
    const TopicSummary* image = ChooseImages();
    const TopicSummary* odometry = ChooseOdometry();
    plan_.base_frame = ChooseBase(odometry);
    PlanOdometry(odometry);
    if (image != nullptr) {
      PlanCamera(*image);
    }
    PlanImu();
    PlanTruth();
    return std::move(plan_);
  }

 private:
  void Miss(const std::string& what) { plan_.missing.push_back(what); }
  void Note(const std::string& what) { plan_.notes.push_back(what); }

  // nullptr: none, or it can't be told, which is then missing.
  const TopicSummary* Choose(const TopicQuery& query, const TopicList& candidates) {
    const TopicChoice choice = ChooseTopic(bag_, query, candidates);
    if (!choice.missing.empty()) {
      Miss(choice.missing);
    }
    return choice.topic;
  }

  const TopicSummary* ChooseImages() {
    TopicList candidates = TopicsThat(bag_, [](const TopicSummary& t) {
      return IsImageType(t.plain_type()) && !t.topic.ends_with("/compressedDepth");
    });
    if (choice_.image_topic.empty()) {
      for (const std::string& sentence : PreferRaw(bag_, &candidates)) {
        Note(sentence);
      }
    }
    const TopicSummary* image = Choose({choice_.image_topic, "images", "--image-topic"}, candidates);
    if (image == nullptr && candidates.empty() && choice_.image_topic.empty()) {
      Miss("has no images; record a topic of sensor_msgs/CompressedImage or sensor_msgs/Image");
    }
    if (image != nullptr) {
      plan_.image_topic = image->topic;
      Note("images: " + image->topic);
    }
    return image;
  }

  const TopicSummary* ChooseOdometry() {
    if (choice_.odom_topic == kNoTopic || (!choice_.odom_frame.empty() && choice_.odom_topic.empty())) {
      return nullptr;
    }
    const bool named = !choice_.odom_topic.empty();
    const TopicList candidates = TopicsThat(bag_, [&](const TopicSummary& t) {
      return named ? IsPoseType(t.plain_type()) : t.plain_type() == "nav_msgs/Odometry";
    });
    return Choose({choice_.odom_topic, "odometry", "--odom-topic (or leave it out: --odom-topic none)"}, candidates);
  }

  std::string ChooseBase(const TopicSummary* odometry) {
    if (!choice_.base_frame.empty()) {
      return choice_.base_frame;
    }
    std::string child = odometry == nullptr ? std::string() : odometry->child_frame_id;
    if (!child.empty() && frames_.Contains(child)) {
      return child;
    }
    for (const char* name : {"base_footprint", "base_link"}) {
      if (std::string found = frames_.FindName(name); !found.empty()) {
        return found;
      }
    }
    return child.empty() ? "base_link" : child;
  }

  void PlanOdometry(const TopicSummary* topic) {
    if (topic != nullptr) {
      plan_.odometry = PosesOfTopic(*topic, "odometry", "--odom-topic none");
    } else if (choice_.odom_topic.empty()) {
      PlanTransformedOdometry();
    }
    if (!plan_.odometry && plan_.missing.empty()) {
      Note("no odometry: the images alone say how the robot moved");
    }
  }

  std::optional<PoseSource> PosesOfTopic(const TopicSummary& topic, const std::string& what,
                                         const std::string& way_out) {
    PoseSource source;
    source.topic = topic.topic;
    const std::string& child = topic.child_frame_id;
    if (!child.empty() && child != plan_.base_frame) {
      const std::optional<Eigen::Isometry3d> child_from_base = frames_.Find(child, plan_.base_frame);
      if (!child_from_base) {
        Miss(what + " of " + topic.topic + " is that of " + child + ", which no fixed transform connects with " +
             plan_.base_frame + "; name the robot's frame with --base-frame, or leave it out with " + way_out);
        return std::nullopt;
      }
      source.child_from_base = *child_from_base;
    }
    Note(what + ": " + topic.topic + (child.empty() ? "" : ", " + topic.frame_id + " -> " + child));
    return source;
  }

  // The transform odom -> base of /tf, where there is no topic of it.
  void PlanTransformedOdometry() {
    const std::string parent = choice_.odom_frame.empty() ? "odom" : choice_.odom_frame;
    for (const TransformSummary& transform : bag_.transforms) {
      const bool from_odom =
          transform.first.parent == parent || (choice_.odom_frame.empty() && transform.first.parent.ends_with("/odom"));
      const std::optional<Eigen::Isometry3d> child_from_base = frames_.Find(transform.first.child, plan_.base_frame);
      if (from_odom && child_from_base && transform.messages > 1) {
        plan_.odometry = PoseSource{{}, transform.first.parent, transform.first.child, *child_from_base};
        Note("odometry: /tf, " + transform.first.parent + " -> " + transform.first.child);
        return;
      }
    }
    if (!choice_.odom_frame.empty()) {
      Miss("/tf has no moving transform from " + parent + " to " + plan_.base_frame +
           "; name its frames with --odom-frame and --base-frame, or leave odometry out with --odom-topic none");
    }
  }

  void PlanCamera(const TopicSummary& image) {
    if (!choice_.camera_yaml.empty()) {
      plan_.camera = ParseCameraYaml(ReadTextFile(choice_.camera_yaml), choice_.camera_yaml);
      Note("camera: " + choice_.camera_yaml.string());
    } else if (!PlanCameraInfo(image)) {
      return;
    }
    if (image.size_px && *image.size_px != std::array{plan_.camera.width_px, plan_.camera.height_px}) {
      Miss("the images of " + image.topic + " are " + std::to_string((*image.size_px)[0]) + "x" +
           std::to_string((*image.size_px)[1]) + " but the calibration is for " +
           std::to_string(plan_.camera.width_px) + "x" + std::to_string(plan_.camera.height_px) +
           "; give that of these images with --camera camera.yaml");
      return;
    }
    PlanFloor(image);
  }

  // False when there is none.
  bool PlanCameraInfo(const TopicSummary& image) {
    const TopicSummary* topic = ChooseCameraInfo(image);
    if (topic == nullptr) {
      return false;
    }
    const bool rectified = RawTopic(image).substr(RawTopic(image).rfind('/') + 1).find("rect") != std::string::npos;
    try {
      plan_.camera = CameraOfInfo(bag_.cameras.at(topic->topic), rectified, topic->frame_id, topic->topic);
    } catch (const InputError& error) {
      Miss(error.what());
      return false;
    }
    Note("camera: " + topic->topic + (rectified ? ", of rectified images" : ""));
    return true;
  }

  const TopicSummary* ChooseCameraInfo(const TopicSummary& image) {
    TopicList candidates =
        TopicsThat(bag_, [](const TopicSummary& t) { return t.plain_type() == "sensor_msgs/CameraInfo"; });
    if (choice_.camera_info_topic.empty()) {
      const std::string raw = RawTopic(image);
      const std::string sibling = raw.substr(0, raw.rfind('/') + 1) + "camera_info";  // as image_transport finds it
      if (const TopicSummary* found = bag_.Find(sibling); found != nullptr && bag_.cameras.contains(sibling)) {
        return found;
      }
    }
    const TopicSummary* info = Choose({choice_.camera_info_topic, "sensor_msgs/CameraInfo",
                                       "--camera-info-topic (or give the calibration with --camera camera.yaml)"},
                                      candidates);
    if (info == nullptr && candidates.empty()) {
      Miss("has no sensor_msgs/CameraInfo; give the calibration with --camera camera.yaml");
    }
    return info;
  }

  void PlanFloor(const TopicSummary& image) {
    if (!choice_.floor_yaml.empty()) {
      plan_.floor = ParseFloorYaml(ReadTextFile(choice_.floor_yaml), choice_.floor_yaml);
      plan_.mounting = choice_.floor_yaml.filename().string();
      Note("mounting: " + choice_.floor_yaml.string());
    } else if (choice_.needs_floor) {
      PlanMounting(image);
    }
  }

  void PlanMounting(const TopicSummary& image) {
    constexpr const char* kFix = "; give the mounting with --floor floor.yaml (calibrate and import-camera make one)";
    const std::string camera_frame = image.frame_id.empty() ? plan_.camera.name : image.frame_id;
    std::optional<Eigen::Isometry3d> base_from_camera = frames_.Find(plan_.base_frame, camera_frame);
    if (!base_from_camera || camera_frame.empty() || !frames_.Contains(camera_frame)) {
      Miss("nothing says how the camera hangs: /tf_static does not connect " + plan_.base_frame +
           " with the images' frame '" + camera_frame + "'" + kFix);
      return;
    }
    base_from_camera->translation().z() += BaseHeight();
    const std::string way = "/tf_static " + plan_.base_frame + " -> " + camera_frame;
    try {
      plan_.floor = FloorOfMounting(plan_.camera, *base_from_camera, choice_.mounting);
    } catch (const InputError& error) {
      Miss(way + " " + error.what() + "; correct it (an optical frame has z forward and x right)" + kFix);
      return;
    }
    char text[96];
    std::snprintf(text, sizeof(text), ": %.3f m over the floor, looking %.1f degrees below the horizon",
                  base_from_camera->translation().z(), PitchDownRad(*base_from_camera) * 180.0 / std::numbers::pi);
    plan_.mounting = way + text;
    Note("mounting: " + plan_.mounting);
  }

  // Of the base frame's origin over the floor.
  double BaseHeight() {
    if (choice_.base_height_m) {
      return *choice_.base_height_m;
    }
    const std::string footprint = frames_.FindName("base_footprint");
    const std::optional<Eigen::Isometry3d> found =
        footprint.empty() ? std::nullopt : frames_.Find(plan_.base_frame, footprint);
    if (found) {
      return -found->translation().z();
    }
    Note(plan_.base_frame +
         " is taken to be on the floor, since the bag has no base_footprint; --base-height says how "
         "high it is");
    return 0.0;
  }

  void PlanImu() {
    if (choice_.imu_topic == kNoTopic) {
      return;
    }
    const TopicList candidates =
        TopicsThat(bag_, [](const TopicSummary& t) { return t.plain_type() == "sensor_msgs/Imu"; });
    const TopicSummary* imu =
        Choose({choice_.imu_topic, "sensor_msgs/Imu", "--imu-topic (or leave it out: --imu-topic none)"}, candidates);
    if (imu == nullptr) {
      return;
    }
    plan_.imu_topic = imu->topic;
    const std::optional<Eigen::Isometry3d> base_from_imu = frames_.Find(plan_.base_frame, imu->frame_id);
    plan_.base_from_imu = base_from_imu ? Eigen::Matrix3d(base_from_imu->linear()) : Eigen::Matrix3d::Identity();
    Note("IMU: " + imu->topic +
         (base_from_imu ? ", turned to the axes of " + plan_.base_frame
                        : ", taken to have the robot's axes: /tf_static does not know '" + imu->frame_id + "'"));
  }

  void PlanTruth() {
    if (choice_.truth_topic.empty()) {
      return;
    }
    const TopicList candidates = TopicsThat(bag_, [](const TopicSummary& t) { return IsPoseType(t.plain_type()); });
    if (const TopicSummary* truth = Choose({choice_.truth_topic, "poses", "--truth-topic"}, candidates)) {
      plan_.truth = PosesOfTopic(*truth, "ground truth", "no --truth-topic");
    }
  }

  const BagSummary& bag_;
  const SurveyChoice& choice_;
  FrameTree frames_;
  SurveyPlan plan_;
};

}  // namespace

SurveyPlan PlanSurvey(const BagSummary& bag, const SurveyChoice& choice) { return Planner(bag, choice).Plan(); }

}  // namespace floorloc
