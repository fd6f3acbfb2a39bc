// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/bag/open_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include "core/io/input_error.h"
#include "mapbuilder/bag/mcap_reader.h"
#include "mapbuilder/bag/ros_image.h"
#include "mapbuilder/bag/ros_messages.h"
#include "mapbuilder/bag/rosbag1_reader.h"
#include "mapbuilder/bag/rosbag2_reader.h"
#include "tests/mapbuilder/bag/bag_file_support.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kMs = 1'000'000;

std::vector<KeptMessage> OfTopic(const std::vector<KeptMessage>& all, const std::string& topic) {
  std::vector<KeptMessage> of_topic;
  std::copy_if(all.begin(), all.end(), std::back_inserter(of_topic),
               [&](const KeptMessage& m) { return m.connection.topic == topic; });
  return of_topic;
}

// Every kind of bag, written by others' libraries, all with the same messages.
class BagKindTest : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::unique_ptr<BagReader> reader = OpenBag(BagData(GetParam()));
    messages_ = AllMessages(*reader);
    warnings_ = reader->warnings();
  }
  std::vector<KeptMessage> Of(const std::string& topic) const { return OfTopic(messages_, topic); }

  std::vector<KeptMessage> messages_;
  std::vector<std::string> warnings_;
};

TEST_P(BagKindTest, HasAllMessagesInTheirOrder) {
  EXPECT_THAT(warnings_, IsEmpty());
  std::vector<std::string> topics;
  std::int64_t last_ns = 0;
  for (const KeptMessage& m : messages_) {
    if (topics.empty() || topics.back() != m.connection.topic) {
      topics.push_back(m.connection.topic);
    }
    EXPECT_GT(m.record_ns, last_ns);
    last_ns = m.record_ns;
  }
  EXPECT_EQ(messages_.size(), 24U);
  EXPECT_THAT(topics, ElementsAre("/tf_static", "/camera/camera_info", "/camera/image_raw/compressed", "/raw", "/odom",
                                  "/imu/data", "/tf", "/pose", "/amcl_pose", "/chatter"));
  EXPECT_EQ(messages_.front().record_ns, kStart);
  EXPECT_EQ(messages_.back().record_ns, kStart + 7 * kSecond);
  EXPECT_EQ(PlainType(messages_.back().connection.type), "std_msgs/String");
}

TEST_P(BagKindTest, ReadsCompressedImagesByTheirContent) {
  const auto images = Of("/camera/image_raw/compressed");
  ASSERT_EQ(images.size(), 3U);
  std::vector<std::int64_t> stamps;
  std::vector<std::string> formats, extensions;
  for (const KeptMessage& m : images) {
    const RosCompressedImage image = ParseCompressedImage(m.View());
    stamps.push_back(image.header.stamp_ns - kStart);
    formats.push_back(image.format);
    EXPECT_EQ(image.header.frame_id, "camera_optical");
    const ImageFile file = ToImageFile(m.View());
    extensions.push_back(file.extension);
    EXPECT_TRUE(std::equal(file.bytes.begin(), file.bytes.end(), image.data.begin(), image.data.end()));
  }
  EXPECT_THAT(stamps, ElementsAre(200 * kMs, 100 * kMs, 300 * kMs));
  EXPECT_THAT(formats, ElementsAre("jpeg", "bgr8; jpeg compressed bgr8", "jpeg"));
  EXPECT_THAT(extensions, ElementsAre(".jpg", ".jpg", ".png"));
}

TEST_P(BagKindTest, ReadsRawImages) {
  std::vector<std::string> encodings;
  for (const KeptMessage& m : Of("/raw")) {
    const RosImage image = ParseImage(m.View());
    encodings.push_back(image.encoding);
    EXPECT_EQ(image.width_px, 4U);
    EXPECT_FALSE(image.big_endian);
    ASSERT_EQ(image.data.size(), image.row_bytes * image.height_px);
    EXPECT_EQ(image.data[3], 22);
    EXPECT_EQ(ToImageFile(m.View()).extension, ".png");
  }
  EXPECT_THAT(encodings,
              ElementsAre("mono8", "mono16", "rgb8", "bgr8", "rgba8", "bgra8", "bayer_rggb8", "yuv422", "yuv422_yuy2"));
}

TEST_P(BagKindTest, ReadsTheCamera) {
  const RosCameraInfo info = ParseCameraInfo(Of("/camera/camera_info").at(0).View());
  EXPECT_EQ(info.header.stamp_ns, kStart + 1);
  EXPECT_EQ(info.height_px, 16U);
  EXPECT_EQ(info.width_px, 16U);
  EXPECT_EQ(info.distortion_model, "plumb_bob");
  EXPECT_THAT(info.d, ElementsAre(-0.1, 0.01, 0.001, -0.002, 0.003));
  EXPECT_THAT(info.k, ElementsAre(20, 0, 7.5, 0, 21, 8.5, 0, 0, 1));
  EXPECT_THAT(info.p, ElementsAre(19, 0, 7, 0, 0, 20, 8, 0, 0, 0, 1, 0));
  EXPECT_EQ(info.binning_x + info.binning_y + info.roi_width_px + info.roi_height_px, 0U);
}

TEST_P(BagKindTest, ReadsPosesOfEachType) {
  const auto odometry = Of("/odom");
  ASSERT_EQ(odometry.size(), 4U);
  const RosPose last = ParsePose(odometry.back().View());
  EXPECT_EQ(last.header.stamp_ns, kStart + 300 * kMs);
  EXPECT_EQ(last.header.frame_id, "odom");
  EXPECT_EQ(last.child_frame_id, "base_link");
  EXPECT_EQ(last.pose.translation(), Eigen::Vector3d(0.75, 0.5, 0));
  const RosPose pose = ParsePose(Of("/pose").at(0).View());
  EXPECT_EQ(pose.pose.translation(), Eigen::Vector3d(3, 4, 0));
  EXPECT_NEAR(pose.pose.rotation()(0, 0), -1, 1e-12);
  EXPECT_EQ(ParsePose(Of("/amcl_pose").at(0).View()).pose.translation(), Eigen::Vector3d(5, 6, 0));
}

TEST_P(BagKindTest, ReadsTheImu) {
  const RosImu imu = ParseImu(Of("/imu/data").at(1).View());
  EXPECT_EQ(imu.header.stamp_ns, kStart + 100 * kMs);
  EXPECT_EQ(imu.angular_velocity, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(imu.acceleration, Eigen::Vector3d(1, 2, 9.75));
}

TEST_P(BagKindTest, ReadsTransforms) {
  const auto transforms = ParseTransforms(Of("/tf_static").at(0).View());
  ASSERT_EQ(transforms.size(), 3U);
  EXPECT_EQ(transforms[0].header.frame_id, "base_link");
  EXPECT_EQ(transforms[0].child_frame_id, "camera_link");
  EXPECT_TRUE((transforms[0].parent_from_child.translation().isApprox(Eigen::Vector3d(0.2, 0, 0.3))));
  const Eigen::Isometry3d base_from_optical = transforms[0].parent_from_child * transforms[1].parent_from_child;
  EXPECT_TRUE(base_from_optical.linear().col(2).isApprox(Eigen::Vector3d(0, 0, -1), 1e-12));
  const RosTransform moving = ParseTransforms(Of("/tf").at(0).View()).at(0);
  EXPECT_EQ(moving.header.frame_id, "odom");  // the bag has a slash before it
  EXPECT_NEAR(moving.parent_from_child.linear()(1, 0), 1, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(All, BagKindTest,
                         ::testing::Values("unchunked.mcap", "bare.mcap", "lz4.mcap", "zstd.mcap", "ros1.mcap",
                                           "big_endian.mcap", "none.bag", "bz2.bag", "lz4.bag", "foxy.db3", "jazzy.db3",
                                           "foxy.db3.zstd", "compressed_messages.db3", "split"),
                         [](const auto& kind) {
                           std::string name = kind.param;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

std::string ErrorOf(const std::filesystem::path& bag) {
  try {
    const std::unique_ptr<BagReader> reader = OpenBag(bag);
    AllMessages(*reader);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

class DamagedBagTest : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const std::vector<std::uint8_t>& bytes) const {
    std::ofstream(folder_.path() / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return folder_.path() / name;
  }
  TemporaryFolder folder_;
};

// Whatever was cut off: what is left is read in its order, and one sentence says what was cut.
TEST_F(DamagedBagTest, ReadsWhatIsLeftOfBagsThatWereCutOff) {
  for (const char* name : {"unchunked.mcap", "bare.mcap", "lz4.mcap", "zstd.mcap", "none.bag", "bz2.bag", "lz4.bag"}) {
    const std::unique_ptr<BagReader> whole = OpenBag(BagData(name));
    const std::vector<KeptMessage> all = AllMessages(*whole);
    const std::vector<std::uint8_t> bytes = BytesOf(BagData(name));
    std::size_t most = 0;
    for (std::size_t size = bytes.size() / 20; size < bytes.size() * 9 / 10; size += bytes.size() / 20) {
      const auto cut = Write(name, {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)});
      const std::unique_ptr<BagReader> reader = OpenBag(cut);
      const std::vector<KeptMessage> left = AllMessages(*reader);
      ASSERT_LE(left.size(), all.size()) << name;
      for (std::size_t i = 0; i < left.size(); ++i) {
        EXPECT_EQ(left[i].bytes, all[i].bytes) << name;
      }
      if (left.size() < all.size()) {
        ASSERT_EQ(reader->warnings().size(), 1U) << name << " " << size;
        EXPECT_THAT(reader->warnings()[0], HasSubstr("what comes before was read"));
      }
      EXPECT_GE(left.size(), most) << name;
      most = left.size();
    }
    EXPECT_GT(most, 5U) << name;
  }
}

TEST_F(DamagedBagTest, ReadsTheWholePartOfAChunkThatWasCutOff) {
  const std::vector<std::uint8_t> bytes = BytesOf(BagData("none.bag"));  // has one chunk
  const auto cut = Write("cut.bag", {bytes.begin(), bytes.begin() + 12000});
  const std::unique_ptr<BagReader> reader = OpenBag(cut);
  EXPECT_GT(AllMessages(*reader).size(), 3U);
  EXPECT_THAT(reader->warnings().at(0), HasSubstr("ends within a chunk at byte 12000"));
}

TEST_F(DamagedBagTest, RefusesChunksWithWrongBytes) {
  for (const char* name : {"bare.mcap", "lz4.mcap", "zstd.mcap", "bz2.bag", "lz4.bag"}) {
    std::vector<std::uint8_t> bytes = BytesOf(BagData(name));
    for (std::size_t i = bytes.size() / 3; i < bytes.size() / 3 + 40; ++i) {
      bytes[i] ^= 0x55;
    }
    EXPECT_THAT(ErrorOf(Write(name, bytes)), HasSubstr("damaged")) << name;
  }
}

TEST_F(DamagedBagTest, ReadsWhatIsLeftOfADatabaseThatWasCutOff) {
  const std::vector<std::uint8_t> bytes = BytesOf(BagData("foxy.db3"));
  const auto cut = Write("cut.db3", {bytes.begin(), bytes.end() - 3 * 1024});
  const std::unique_ptr<BagReader> reader = OpenBag(cut);
  const std::vector<KeptMessage> left = AllMessages(*reader);
  EXPECT_GT(left.size(), 0U);
  EXPECT_LT(left.size(), 24U);
  EXPECT_THAT(reader->warnings().at(0), HasSubstr("those were read"));
}

TEST_F(DamagedBagTest, ReadsFilesThatWereCompressedAsAWhole) {
  for (const char* name : {"lz4.mcap", "none.bag", "jazzy.db3"}) {
    const std::vector<std::uint8_t> bytes = BytesOf(BagData(name));
    std::vector<std::uint8_t> compressed(ZSTD_compressBound(bytes.size()));
    compressed.resize(ZSTD_compress(compressed.data(), compressed.size(), bytes.data(), bytes.size(), 1));
    const std::filesystem::path file = Write(std::string(name) + ".zstd", compressed);
    EXPECT_TRUE(IsBag(file));
    const std::unique_ptr<BagReader> reader = OpenBag(file);
    EXPECT_EQ(AllMessages(*reader).size(), 24U) << name;
    EXPECT_THAT(reader->warnings(), IsEmpty()) << name;
  }
}

TEST_F(DamagedBagTest, RefusesWhatIsNoBag) {
  EXPECT_THAT(ErrorOf(Write("a.bag", {'h', 'e', 'l', 'l', 'o'})), HasSubstr("is no bag; give a .mcap"));
  EXPECT_THAT(ErrorOf(folder_.path() / "missing.mcap"), HasSubstr("does not exist"));
  const std::string old = "#ROSBAG V1.2\n";
  EXPECT_THAT(ErrorOf(Write("old.bag", {old.begin(), old.end()})), HasSubstr("rosbag fix"));
  TemporaryFolder empty;
  EXPECT_THAT(ErrorOf(empty.path()), HasSubstr("holds no bag"));
  EXPECT_FALSE(IsBag(empty.path()));
}

TEST_F(DamagedBagTest, NamesFilesOfMetadataThatAreMissing) {
  std::filesystem::copy(BagData("split"), folder_.path(), std::filesystem::copy_options::recursive);
  std::filesystem::remove(folder_.path() / "split_0.db3");
  EXPECT_THAT(ErrorOf(folder_.path()), HasSubstr("lists split_0.db3, which is missing"));
}

TEST_F(DamagedBagTest, WithoutMetadataSplitsFollowTheirNumbers) {
  std::filesystem::copy(BagData("split/split_1.db3"), folder_.path() / "drive_9.db3");
  std::filesystem::copy(BagData("split/split_0.db3"), folder_.path() / "drive_10.db3");
  EXPECT_TRUE(IsBag(folder_.path()));
  const std::unique_ptr<BagReader> reader = OpenBag(folder_.path());
  EXPECT_EQ(AllMessages(*reader).front().connection.topic, "/tf_static");
}

TEST_F(DamagedBagTest, ReadsAnUnindexedBag) {
  std::vector<std::uint8_t> bytes = BytesOf(BagData("none.bag"));
  // As rosbag leaves it when it is killed: the header does not know the index, and there is none.
  const std::string mark = "index_pos=";
  const auto at = std::search(bytes.begin(), bytes.end(), mark.begin(), mark.end()) + 10;
  std::uint64_t index = 0;
  std::copy(at, at + 8, reinterpret_cast<std::uint8_t*>(&index));
  std::fill(at, at + 8, std::uint8_t{0});
  bytes.resize(index);
  const std::unique_ptr<BagReader> reader = OpenBag(Write("drive.bag.active", bytes));
  EXPECT_EQ(AllMessages(*reader).size(), 24U);
  EXPECT_THAT(reader->warnings(), IsEmpty());
}

}  // namespace
}  // namespace floorloc
