// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/surface/classes/surface_classifier.h"

namespace floorloc {

/// Of the file that FormatSurfaceModel writes. Others are refused: features and classifiers belong together.
constexpr std::uint32_t kSurfaceModelVersion = 1;

/// The bytes of a model file: "FLOORSRF", version (32 bits), checksum of what follows (64 bits), and the fields of
/// SurfaceModel in their order, numbers little-endian, each list after its length (32 bits).
std::string FormatSurfaceModel(const SurfaceModel& model);

/// Throws InputError when the bytes are not those of a model of this version, or damaged.
SurfaceModel ParseSurfaceModel(std::string_view bytes, const std::filesystem::path& source);

/// Throws InputError.
SurfaceModel ReadSurfaceModel(const std::filesystem::path& file);

/// Puts magic, version and checksum before a body.
std::string SealSurfaceModel(std::string_view body);

}  // namespace floorloc
