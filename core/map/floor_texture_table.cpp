// SPDX-License-Identifier: Apache-2.0
#include "core/map/floor_texture_table.h"

#include <Eigen/Cholesky>
#include <limits>
#include <span>

#include "core/map/checked_row.h"
#include "core/map/map_contract.h"

namespace floorloc {
namespace {

constexpr int kSize = MapFloorTexture::kSize;
constexpr std::size_t kTriangle = static_cast<std::size_t>(kSize) * (kSize + 1) / 2;
constexpr double kMaxLogarithm = 50.0;  // of a ratio of contrasts

std::vector<double> UpperTriangle(const MapFloorTexture::Covariance& covariance) {
  std::vector<double> upper;
  for (int row = 0; row < kSize; ++row) {
    for (int column = row; column < kSize; ++column) {
      upper.push_back(covariance(row, column));
    }
  }
  return upper;
}

MapFloorTexture::Covariance FromUpperTriangle(const std::vector<double>& upper) {
  MapFloorTexture::Covariance covariance;
  auto next = upper.begin();
  for (int row = 0; row < kSize; ++row) {
    for (int column = row; column < kSize; ++column) {
      covariance(row, column) = covariance(column, row) = *next++;
    }
  }
  return covariance;
}

MapFloorTexture ReadFloorTexture(const CheckedRow& row) {
  MapFloorTexture texture;
  texture.blocks = row.Integer(1, "blocks", 1, std::numeric_limits<int>::max());
  const std::vector<double> mean = row.Doubles(2, "mean", kSize);
  texture.mean = Eigen::Map<const MapFloorTexture::Mean>(mean.data());
  texture.covariance = FromUpperTriangle(row.Doubles(3, "covariance", kTriangle));
  if (texture.mean.cwiseAbs().maxCoeff() > kMaxLogarithm ||
      texture.covariance.cwiseAbs().maxCoeff() > kMaxLogarithm * kMaxLogarithm) {
    row.Refuse("mean or covariance is out of range");
  }
  if (texture.covariance.llt().info() != Eigen::Success) {
    row.Refuse("covariance is not positive definite");
  }
  return texture;
}

}  // namespace

void WriteFloorTextures(const SqliteConnection& connection, const MapInfo& info) {
  SqliteStatement insert(connection, "INSERT INTO floor_texture VALUES (?,?,?,?)");
  for (std::size_t survey = 0; survey < info.floor_textures.size(); ++survey) {
    const MapFloorTexture& texture = info.floor_textures[survey];
    if (texture.blocks > 0) {
      insert.Bind(static_cast<std::int64_t>(survey)).Bind(texture.blocks);
      insert.Bind(PackDoubles(std::span(texture.mean.data(), kSize)));
      insert.Bind(PackDoubles(UpperTriangle(texture.covariance))).Run();
    }
  }
}

std::vector<MapFloorTexture> ReadFloorTextures(const SqliteConnection& connection, const MapInfo& info) {
  std::vector<MapFloorTexture> textures(info.cameras.size());
  SqliteStatement statement(connection, "SELECT survey, blocks, mean, covariance FROM floor_texture ORDER BY survey");
  while (statement.Step()) {
    const CheckedRow row(connection, statement, "floor_texture");
    const int survey = row.Integer(0, "survey", 0, static_cast<std::int64_t>(textures.size()) - 1);
    textures[static_cast<std::size_t>(survey)] = ReadFloorTexture(row);
  }
  return textures;
}

}  // namespace floorloc
