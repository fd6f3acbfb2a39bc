// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/frame_journal.h"

#include <sys/stat.h>

#include <span>

#include "core/map/extractor_parameters.h"
#include "core/surface/texture/floor_blocks.h"
#include "mapbuilder/batch/journal_bytes.h"

namespace floorloc {
namespace {

void AddCamera(const FloorCamera& c, ContentHash* hash) {
  hash->Add(std::int64_t{c.camera.width_px}).Add(std::int64_t{c.camera.height_px});
  hash->Add(c.camera.fx).Add(c.camera.fy).Add(c.camera.cx).Add(c.camera.cy);
  hash->Add(std::string(ToString(c.camera.distortion_model)));
  for (const double number : c.camera.distortion) {
    hash->Add(number);
  }
  for (int i = 0; i < 9; ++i) {
    hash->Add(c.floor.base_from_pixel(i / 3, i % 3));
  }
  hash->Add(c.floor.roi.x_min).Add(c.floor.roi.x_max).Add(c.floor.roi.y_min).Add(c.floor.roi.y_max);
  hash->Add(c.floor.resolution_m);
  hash->Add(std::string(ToString(c.camera.readout.direction)));
}

// Checks the extractor's invariant, one descriptor per keypoint, of bytes or floats, and the matrices' types.
bool IsWhole(const Features& features, const cv::Mat& brightness, const cv::Mat& texture) {
  const cv::Mat& descriptors = features.descriptors;
  return static_cast<std::size_t>(descriptors.rows) == features.keypoints.size() &&
         (descriptors.type() == CV_8UC1 || descriptors.type() == CV_32FC1) &&
         (brightness.empty() || brightness.type() == CV_32FC1) &&
         (texture.empty() || (texture.type() == CV_64FC1 && texture.cols == BlockTexture::SizeAtCompileTime));
}

}  // namespace

ContentHash& AddFile(const std::filesystem::path& file, ContentHash* hash) {
  struct stat status {};
  stat(file.c_str(), &status);  // a missing file has size 0
  hash->Add(std::filesystem::absolute(file).lexically_normal().string()).Add(std::int64_t{status.st_size});
  return hash->Add(std::int64_t{status.st_mtim.tv_sec}).Add(std::int64_t{status.st_mtim.tv_nsec});
}

ContentHash& AddProgram(ContentHash* hash) {
  hash->Add(std::string(FLOORLOC_VERSION));
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? *hash : AddFile(program, hash);
}

FrameJournal::FrameJournal(BuildJournal* journal, const std::vector<LoadedSurvey>& surveys,
                           const ExtractorOptions& extractor)
    : journal_(journal), surveys_(surveys) {
  for (const LoadedSurvey& loaded : surveys) {
    ContentHash hash;
    AddProgram(&hash).Add(std::string("frame"));
    for (const auto& [name, value] : ToParameters(extractor)) {
      hash.Add(name).Add(value);
    }
    AddCamera(loaded.survey.camera, &hash);
    if (!loaded.survey.mask.empty()) {
      const cv::Mat& mask = loaded.survey.mask;
      hash.Add(std::span(mask.ptr<std::uint8_t>(), mask.total()));
    }
    survey_keys_.push_back(hash.Hex());
  }
}

std::string FrameJournal::KeyOf(const BuildFrame& frame) const {
  const auto survey = static_cast<std::size_t>(frame.survey);
  ContentHash hash;
  hash.Add(survey_keys_[survey]);
  for (const double number : frame.readout_motion) {
    hash.Add(number);
  }
  return AddFile(surveys_[survey].survey.ImagePath(frame.info), &hash).Hex();
}

bool FrameJournal::Restore(BuildFrame* frame) {
  const auto piece = journal_->Get(KeyOf(*frame));
  if (!piece) {
    return false;
  }
  Features features;
  cv::Mat brightness;
  ByteReader reader(*piece);
  reader.Read(&features.keypoints);
  reader.Read(&features.descriptors);
  reader.Read(&brightness);
  ImageQuality quality;
  reader.Read(&quality);
  cv::Mat texture;
  reader.Read(&texture);
  if (!reader.Complete() || !IsWhole(features, brightness, texture)) {
    return false;
  }
  frame->features = std::move(features);
  frame->brightness = brightness;
  frame->quality = quality;
  frame->texture = texture;
  ++restored_;
  return true;
}

void FrameJournal::Store(const BuildFrame& frame) {
  ByteWriter writer;
  writer.Add(frame.features.keypoints).Add(frame.features.descriptors).Add(frame.brightness).Add(frame.quality);
  writer.Add(frame.texture);
  journal_->Put(KeyOf(frame), writer.Take());
}

}  // namespace floorloc
