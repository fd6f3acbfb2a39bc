// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <opencv2/core.hpp>
#include <random>
#include <string>
#include <vector>

#include "core/map/map_database.h"
#include "core/map/map_writer.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc::testing_map {

using floorloc::TemporaryFolder;

/// The content of a map file.
struct MapContent {
  MapInfo info;
  MosaicLayout mosaic;
  std::vector<MapFrame> frames;
  std::vector<MapLink> links;
  MapKeypoints keypoints;
  DescriptorType type = DescriptorType::kBinary;
  std::vector<MosaicTile> tiles;
};

inline FloorCamera MakeCamera(DistortionModel model) {
  FloorCamera camera;
  camera.camera = {"front", 640, 480, 600.5, 601.25, 321.5, 238.75, model, {-0.25, 0.06, 0.0008, -0.0005}};
  if (model == DistortionModel::kRationalPolynomial) {
    camera.camera.distortion = {0.3, 0.05, 0.0006, -0.0004, 0.002, 0.55, 0.08, 0.004};
  } else if (model == DistortionModel::kEquidistant) {
    camera.camera.distortion = {0.02, -0.006, 0.003, -0.001};
  }
  camera.floor.base_from_pixel << 0.0, -0.00067, 0.36, -0.00067, 0.0, 0.2155, 0.0, 0.0, 1.0;
  camera.floor.roi = {0.1, 0.3, -0.15, 0.15};
  camera.floor.resolution_m = 0.0007;
  return camera;
}

/// What a self-calibration changes.
inline void Correct(FloorCamera* camera) {
  camera->camera.fx += 0.125;
  camera->camera.fy += 0.25;
  camera->camera.cx -= 0.5;
  camera->camera.cy += 0.75;
  camera->camera.distortion[0] += 1e-3;
  camera->camera.sigma_px = 1.0 / 3.0;
  camera->floor.base_from_pixel(0, 2) += 1e-3;
  camera->floor.offset_sigma_m = 1.0 / 7000.0;
}

inline MapKeypoints RandomKeypoints(int count, DescriptorType type, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0F, 1.0F);
  MapKeypoints keypoints;
  keypoints.descriptors = type == DescriptorType::kBinary ? cv::Mat(0, 32, CV_8U) : cv::Mat(0, 128, CV_32F);
  keypoints.descriptors.resize(static_cast<std::size_t>(count));
  if (count > 0) {
    cv::RNG(seed).fill(keypoints.descriptors, cv::RNG::UNIFORM, 0, 256);
  }
  for (int i = 0; i < count; ++i) {
    const float x = 3.0F * unit(random) - 1.5F;
    const float y = 2.0F * unit(random) - 0.7F;
    keypoints.keypoints.push_back({x, y, 6.0F * unit(random) - 3.0F, 0.02F * unit(random), 100.0F * unit(random)});
    keypoints.observations.push_back(static_cast<std::uint16_t>(random() % 65536));
    keypoints.distinctiveness.push_back(static_cast<std::uint8_t>(random() % 256));
    keypoints.last_survey.push_back(static_cast<std::uint16_t>(random() % 2));
  }
  return keypoints;
}

inline MapContent MakeContent(DescriptorType type = DescriptorType::kBinary,
                              DistortionModel model = DistortionModel::kPlumbBob) {
  MapContent content;
  content.type = type;
  content.info.builder_version = "9.8.7";
  content.info.id = "0b9f4f1e-3c1f-4f63-9d6f-7a1f4f0e2c11";
  content.info.name = "hall \"A\"; DROP TABLE map;--";
  content.info.created = "2024-05-06T07:08:09Z";
  content.info.extent = {-1.5, 1.5, -0.7, 1.3};
  content.info.area_m2 = 5.25;
  content.info.extractor = {type == DescriptorType::kBinary ? ExtractorType::kOrb : ExtractorType::kSift,
                            1234,
                            37,
                            3,
                            1.25,
                            0.00123456789,
                            21,
                            0.75};
  content.info.cameras = {MakeCamera(model), MakeCamera(DistortionModel::kEquidistant)};
  content.info.given_cameras = content.info.cameras;
  Correct(&content.info.cameras[0]);
  content.info.parents = {{"merges", "an id", "a version"}, {"merges", "another id", "another version"}};
  content.info.surveys_json = R"([{"folder":"s\u00fc\u00df"}])";
  content.info.report_json = R"({"frames":2})";
  content.mosaic = {256, 2, 0.0007};
  content.frames = {
      {1'700'000'000'123'456'789, "images/0.jpg", Pose2(1.0 / 3.0, -0.5, 3.1)},
      {1'700'000'000'223'456'789, "images/\u00fc.jpg", Pose2(0.1, 0.2, -3.1), 1, 0.75, Pose2(4.0, 5.0, 1.0 / 7.0)}};
  content.links = {{0, 1, Pose2(0.3, 1.0 / 3.0, -0.5), Eigen::Vector3d(1e-8, 2e-8, 3e-6).asDiagonal(), 77, 2e-4, 0.9}};
  content.links[0].covariance(0, 2) = content.links[0].covariance(2, 0) = 1e-9;
  content.keypoints = RandomKeypoints(1500, type, 1);
  for (int z = 0; z <= 2; ++z) {
    for (int x = -1; x <= 1; ++x) {
      content.tiles.push_back(
          {{z, x, -z},
           std::vector<std::uint8_t>(static_cast<std::size_t>(20000 + 100 * x), static_cast<std::uint8_t>(7 * z + x))});
    }
  }
  return content;
}

/// Writes a map; returns its content version.
inline std::string WriteMap(const std::filesystem::path& file, const MapContent& content) {
  MapWriter writer(file);
  writer.WriteFrames(content.frames);
  writer.WriteLinks(content.links);
  writer.WriteKeypoints(content.keypoints, content.type);
  writer.WriteMosaicTiles(content.tiles);
  writer.WriteUprightDescriptors(content.keypoints);
  return writer.Commit(content.info, content.mosaic);
}

/// The message of the MapError that `work` throws; fails the test when it throws nothing or another exception.
inline std::string ErrorOf(const std::function<void()>& work) {
  try {
    work();
  } catch (const MapError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "more than one line";
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "not a MapError: " << error.what();
    return {};
  }
  ADD_FAILURE() << "no error";
  return {};
}

inline std::string ReadBytes(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

inline void WriteBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

inline std::vector<std::string> FilesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  return names;
}

inline bool SameKeypoints(const MapKeypoints& a, const MapKeypoints& b) {
  const auto same = [](const Keypoint& p, const Keypoint& q) {
    return p.x_m == q.x_m && p.y_m == q.y_m && p.angle_rad == q.angle_rad && p.size_m == q.size_m &&
           p.response == q.response;
  };
  return a.size() == b.size() && a.observations == b.observations && a.distinctiveness == b.distinctiveness &&
         a.last_survey == b.last_survey &&
         std::equal(a.keypoints.begin(), a.keypoints.end(), b.keypoints.begin(), same) &&
         a.descriptors.size() == b.descriptors.size() && a.descriptors.type() == b.descriptors.type() &&
         cv::norm(a.descriptors, b.descriptors, cv::NORM_INF) == 0.0;
}

}  // namespace floorloc::testing_map
