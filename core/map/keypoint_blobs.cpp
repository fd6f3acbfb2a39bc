// SPDX-License-Identifier: Apache-2.0
#include "core/map/keypoint_blobs.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "core/map/content_hash.h"

namespace floorloc {
namespace {

static_assert(std::endian::native == std::endian::little, "blobs are little-endian");

template <typename T>
void Append(Blob* blob, T value) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
  blob->insert(blob->end(), bytes, bytes + sizeof(T));
}

template <typename T>
T Get(const Blob& blob, std::size_t index) {
  T value;
  std::memcpy(&value, blob.data() + index * sizeof(T), sizeof(T));
  return value;
}

bool HasValidLengths(const KeypointBlobs& blobs, std::size_t row_bytes) {
  const auto n = static_cast<std::size_t>(blobs.count);
  return blobs.position.size() == n * 8 && blobs.angle.size() == n * 4 && blobs.size.size() == n * 4 &&
         blobs.response.size() == n * 4 && blobs.observations.size() == n * 2 && blobs.distinctiveness.size() == n &&
         blobs.last_survey.size() == n * 2 && blobs.descriptor.size() == n * row_bytes;
}

// Rounding to float moves a position in the tile at most onto its edges.
bool LiesInTile(float x_m, float y_m, const KeypointTile& tile) {
  const auto side_m = static_cast<float>(tile.side_m);
  const float slack_m = 1e-3F * side_m;
  return x_m >= -slack_m && x_m <= side_m + slack_m && y_m >= -slack_m && y_m <= side_m + slack_m;
}

bool AreFinite(const Blob& floats) {
  for (std::size_t i = 0; i < floats.size() / sizeof(float); ++i) {
    if (!std::isfinite(Get<float>(floats, i))) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::int64_t KeypointBlobs::Checksum() const {
  ContentHash hash;
  return hash.Add(position)
      .Add(angle)
      .Add(size)
      .Add(response)
      .Add(observations)
      .Add(distinctiveness)
      .Add(last_survey)
      .Add(descriptor)
      .Checksum();
}

std::map<std::pair<int, int>, std::vector<int>> KeypointsByTile(const MapKeypoints& keypoints, double tile_m) {
  std::map<std::pair<int, int>, std::vector<int>> tiles;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const Eigen::Vector2d tile = keypoints.PositionInMap(i) / tile_m;
    const int x = static_cast<int>(std::floor(tile.x()));
    const int y = static_cast<int>(std::floor(tile.y()));
    tiles[{x, y}].push_back(static_cast<int>(i));
  }
  return tiles;
}

KeypointBlobs PackKeypoints(const MapKeypoints& keypoints, std::span<const int> indices, const KeypointTile& tile) {
  KeypointBlobs blobs;
  blobs.count = static_cast<int>(indices.size());
  const std::size_t row_bytes = static_cast<std::size_t>(keypoints.descriptors.cols) * keypoints.descriptors.elemSize();
  for (const int i : indices) {
    const auto index = static_cast<std::size_t>(i);
    const Keypoint& k = keypoints.keypoints[index];
    const Eigen::Vector2d in_tile = keypoints.PositionInMap(index) - tile.Corner();
    Append(&blobs.position, static_cast<float>(in_tile.x()));
    Append(&blobs.position, static_cast<float>(in_tile.y()));
    Append(&blobs.angle, k.angle_rad);
    Append(&blobs.size, k.size_m);
    Append(&blobs.response, k.response);
    Append(&blobs.observations, keypoints.observations[index]);
    Append(&blobs.distinctiveness, keypoints.distinctiveness[index]);
    Append(&blobs.last_survey, keypoints.last_survey[index]);
    const std::uint8_t* row = keypoints.descriptors.ptr(i);
    blobs.descriptor.insert(blobs.descriptor.end(), row, row + row_bytes);
  }
  return blobs;
}

bool UnpackKeypoints(const KeypointBlobs& blobs, const KeypointTile& tile, std::size_t row_bytes,
                     MapKeypoints* keypoints) {
  if (blobs.count < 0 || !HasValidLengths(blobs, row_bytes) ||
      (keypoints->descriptors.depth() == CV_32F && !AreFinite(blobs.descriptor))) {
    return false;
  }
  const Eigen::Vector2d corner = tile.Corner() - keypoints->origin_m;
  for (std::size_t i = 0; i < static_cast<std::size_t>(blobs.count); ++i) {
    Keypoint k;
    const auto x_m = Get<float>(blobs.position, 2 * i);
    const auto y_m = Get<float>(blobs.position, 2 * i + 1);
    k.x_m = static_cast<float>(x_m + corner.x());
    k.y_m = static_cast<float>(y_m + corner.y());
    k.angle_rad = Get<float>(blobs.angle, i);
    k.size_m = Get<float>(blobs.size, i);
    k.response = Get<float>(blobs.response, i);
    if (!LiesInTile(x_m, y_m, tile) || !std::isfinite(k.angle_rad) || !std::isfinite(k.size_m)) {
      return false;
    }
    keypoints->keypoints.push_back(k);
    keypoints->observations.push_back(Get<std::uint16_t>(blobs.observations, i));
    keypoints->distinctiveness.push_back(blobs.distinctiveness[i]);
    keypoints->last_survey.push_back(Get<std::uint16_t>(blobs.last_survey, i));
  }
  const int first = keypoints->descriptors.rows;
  const std::size_t row_size =
      static_cast<std::size_t>(keypoints->descriptors.cols) * keypoints->descriptors.elemSize();
  if (row_size != row_bytes) {
    return false;
  }
  keypoints->descriptors.resize(static_cast<std::size_t>(first) + static_cast<std::size_t>(blobs.count));
  if (blobs.count > 0) {
    std::memcpy(keypoints->descriptors.ptr(first), blobs.descriptor.data(), blobs.descriptor.size());
  }
  return true;
}

}  // namespace floorloc
