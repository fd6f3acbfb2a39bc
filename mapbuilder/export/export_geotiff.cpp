// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/export/export_geotiff.h"

#include <tiffio.h>

#include <array>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string>

#include "core/io/input_error.h"
#include "core/map/part_file.h"
#include "mapbuilder/finished_map/mosaic_level.h"

namespace floorloc {
namespace {

// Tags and keys of GeoTIFF 1.1.
constexpr std::uint32_t kModelPixelScale = 33550;
constexpr std::uint32_t kModelTiepoint = 33922;
constexpr std::uint32_t kGeoKeyDirectory = 34735;
constexpr std::uint32_t kGeoAsciiParams = 34737;
constexpr std::uint16_t kModelTypeKey = 1024;
constexpr std::uint16_t kRasterTypeKey = 1025;
constexpr std::uint16_t kCitationKey = 1026;
constexpr std::uint16_t kLinearUnitsKey = 3076;
constexpr std::uint16_t kUserDefined = 32767;
constexpr std::uint16_t kPixelIsArea = 1;
constexpr std::uint16_t kMetre = 9001;

struct Closer {
  void operator()(TIFF* tiff) const { TIFFClose(tiff); }
};
using TiffFile = std::unique_ptr<TIFF, Closer>;

void IgnoreMessages(const char*, const char*, va_list) {}

// libtiff's messages would otherwise be printed to stderr beside ours.
TiffFile Open(const std::filesystem::path& file, const char* mode) {
  TIFFSetErrorHandler(IgnoreMessages);
  TIFFSetWarningHandler(IgnoreMessages);
  return TiffFile(TIFFOpen(file.c_str(), mode));
}

void Check(bool written, const std::filesystem::path& file) {
  if (!written) {
    throw InputError(file, "cannot be written; check the permissions and the free space");
  }
}

// Upper bound: the map's JPEG tiles take less than uncompressed subsampled pixels of 1.5 bytes.
bool NeedsBigTiff(const MosaicLevel& level) {
  const double pixels = static_cast<double>(level.layout.tile_px) * level.layout.tile_px;
  return static_cast<double>(level.columns()) * level.rows() * pixels * 1.5 > 4e9;
}

bool SetSizeTags(TIFF* tiff, const MosaicLevel& level) {
  const auto tile_px = static_cast<std::uint32_t>(level.layout.tile_px);
  return TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, static_cast<std::uint32_t>(level.columns()) * tile_px) == 1 &&
         TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, static_cast<std::uint32_t>(level.rows()) * tile_px) == 1 &&
         TIFFSetField(tiff, TIFFTAG_TILEWIDTH, tile_px) == 1 && TIFFSetField(tiff, TIFFTAG_TILELENGTH, tile_px) == 1 &&
         TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == 1;
}

bool SetImageTags(TIFF* tiff, const MosaicLevel& level) {
  return SetSizeTags(tiff, level) &&  //
         TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8) == 1 && TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 3) == 1 &&
         TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_JPEG) == 1 &&
         // Every tile contains its own JPEG tables.
         TIFFSetField(tiff, TIFFTAG_JPEGTABLESMODE, 0) == 1 &&
         TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_YCBCR) == 1 &&
         TIFFSetField(tiff, TIFFTAG_YCBCRSUBSAMPLING, 2, 2) == 1;
}

bool SetGeoTags(TIFF* tiff, const MosaicLevel& level, const std::string& map_name) {
  const auto field = [](std::uint32_t tag, TIFFDataType type, const char* name) {
    return TIFFFieldInfo{tag, -1, -1, type, FIELD_CUSTOM, 1, 1, const_cast<char*>(name)};
  };
  std::array<TIFFFieldInfo, 4> fields{field(kModelPixelScale, TIFF_DOUBLE, "ModelPixelScaleTag"),
                                      field(kModelTiepoint, TIFF_DOUBLE, "ModelTiepointTag"),
                                      field(kGeoKeyDirectory, TIFF_SHORT, "GeoKeyDirectoryTag"),
                                      field(kGeoAsciiParams, TIFF_ASCII, "GeoAsciiParamsTag")};
  fields[3].field_passcount = 0;
  TIFFMergeFieldInfo(tiff, fields.data(), static_cast<std::uint32_t>(fields.size()));
  const RectM extent = level.Extent();
  const std::array<double, 3> scale{level.resolution_m(), level.resolution_m(), 0.0};
  const std::array<double, 6> tiepoint{0.0, 0.0, 0.0, extent.x_min, extent.y_max, 0.0};  // outer corner of pixel (0, 0)
  const std::string citation = "floorloc map frame of " + map_name + "|";
  const std::array<std::uint16_t, 20> keys{1,
                                           1,
                                           1,
                                           4,  // version 1.1.1, four keys
                                           kModelTypeKey,
                                           0,
                                           1,
                                           kUserDefined,  //
                                           kRasterTypeKey,
                                           0,
                                           1,
                                           kPixelIsArea,  //
                                           kCitationKey,
                                           kGeoAsciiParams,
                                           static_cast<std::uint16_t>(citation.size()),
                                           0,  //
                                           kLinearUnitsKey,
                                           0,
                                           1,
                                           kMetre};
  return TIFFSetField(tiff, kModelPixelScale, static_cast<int>(scale.size()), scale.data()) == 1 &&
         TIFFSetField(tiff, kModelTiepoint, static_cast<int>(tiepoint.size()), tiepoint.data()) == 1 &&
         TIFFSetField(tiff, kGeoKeyDirectory, static_cast<int>(keys.size()), keys.data()) == 1 &&
         TIFFSetField(tiff, kGeoAsciiParams, citation.c_str()) == 1;
}

std::vector<std::uint8_t> BlackTile(int tile_px) {
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", cv::Mat::zeros(tile_px, tile_px, CV_8UC3), jpeg);
  return jpeg;
}

bool SetMaskTags(TIFF* tiff, const MosaicLevel& level) {
  return TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, FILETYPE_MASK) == 1 && SetSizeTags(tiff, level) &&
         TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 1) == 1 && TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1) == 1 &&
         TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE) == 1 &&
         TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MASK) == 1;
}

// One bit per pixel, the first in the highest bit; rows begin on bytes.
std::vector<std::uint8_t> PackedBits(const cv::Mat& mask) {
  const auto row_bytes = static_cast<std::size_t>((mask.cols + 7) / 8);
  std::vector<std::uint8_t> bits(row_bytes * static_cast<std::size_t>(mask.rows), 0);
  for (int v = 0; v < mask.rows; ++v) {
    for (int u = 0; u < mask.cols; ++u) {
      if (mask.at<std::uint8_t>(v, u) != 0) {
        bits[static_cast<std::size_t>(v) * row_bytes + static_cast<std::size_t>(u / 8)] |=
            static_cast<std::uint8_t>(0x80 >> (u % 8));
      }
    }
  }
  return bits;
}

// A mask rather than a colour that means "no data": floor may have any colour, and JPEG changes black.
void WriteMask(TIFF* tiff, const MapDatabase& map, const MosaicLevel& level, const std::filesystem::path& file) {
  const std::set<TileId> present(level.tiles.begin(), level.tiles.end());
  const cv::Size tile_size(level.layout.tile_px, level.layout.tile_px);
  std::uint32_t index = 0;
  for (int y = level.max_y; y >= level.min_y; --y) {
    for (int x = level.min_x; x <= level.max_x; ++x, ++index) {
      const TileId tile{level.zoom, x, y};
      std::vector<std::uint8_t> bits =
          PackedBits(present.contains(tile) ? SurveyedPixels(DecodeMosaicTile(map, level, tile))
                                            : cv::Mat(cv::Mat::zeros(tile_size, CV_8UC1)));
      const auto size = static_cast<tmsize_t>(bits.size());
      Check(TIFFWriteEncodedTile(tiff, index, bits.data(), size) == size, file);
    }
  }
}

// Row-major from the upper left, the order of tiles in TIFF.
void WriteTiles(TIFF* tiff, const MapDatabase& map, const MosaicLevel& level, const std::filesystem::path& file) {
  const std::set<TileId> present(level.tiles.begin(), level.tiles.end());
  const std::vector<std::uint8_t> black = BlackTile(level.layout.tile_px);
  std::uint32_t index = 0;
  for (int y = level.max_y; y >= level.min_y; --y) {
    for (int x = level.min_x; x <= level.max_x; ++x, ++index) {
      const TileId tile{level.zoom, x, y};
      std::vector<std::uint8_t> jpeg = black;
      if (present.contains(tile)) {
        jpeg = map.ReadMosaicTile(tile).value_or(black);
      }
      const auto size = static_cast<tmsize_t>(jpeg.size());
      Check(TIFFWriteRawTile(tiff, index, jpeg.data(), size) == size, file);
    }
  }
}

}  // namespace

GeoTiffSummary ExportGeoTiff(const MapDatabase& map, double resolution_m, const std::filesystem::path& file) {
  const MosaicLevel level = ReadMosaicLevel(map, resolution_m);
  std::filesystem::path part_name = file;
  PartFile part(part_name += ".part");
  {
    const TiffFile tiff = Open(part.path(), NeedsBigTiff(level) ? "w8" : "w");
    Check(tiff && SetImageTags(tiff.get(), level) && SetGeoTags(tiff.get(), level, map.ReadInfo().name), file);
    WriteTiles(tiff.get(), map, level, file);
    Check(TIFFWriteDirectory(tiff.get()) == 1 && SetMaskTags(tiff.get(), level), file);
    WriteMask(tiff.get(), map, level, file);
    Check(TIFFFlush(tiff.get()) == 1, file);
  }
  part.MoveTo(file);
  const auto tile_px = static_cast<std::int64_t>(level.layout.tile_px);
  return {level.columns() * tile_px, level.rows() * tile_px, level.resolution_m()};
}

}  // namespace floorloc
