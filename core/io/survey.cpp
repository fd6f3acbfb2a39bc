// SPDX-License-Identifier: Apache-2.0
#include "core/io/survey.h"

#include <algorithm>
#include <cctype>
#include <unordered_set>

#include "core/io/camera_mask.h"
#include "core/io/camera_yaml.h"
#include "core/io/delimited_text.h"
#include "core/io/input_error.h"
#include "core/io/planar_trajectory.h"
#include "core/io/text_file.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

bool IsFile(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

bool HasImageExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png";
}

std::vector<SurveyFrame> ListImages(const fs::path& folder) {
  const fs::path images = folder / "images";
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator it(images, error), end; !error && it != end; it.increment(error)) {
    if (IsFile(it->path()) && HasImageExtension(it->path())) {
      names.push_back("images/" + it->path().filename().string());
    }
  }
  if (error) {
    throw InputError(folder, "has neither frames.csv nor a readable folder images; add one of them");
  }
  if (names.empty()) {
    throw InputError(images, "has no frames; put JPEG or PNG images there");
  }
  std::sort(names.begin(), names.end());
  std::vector<SurveyFrame> frames;
  for (const std::string& name : names) {
    frames.push_back({static_cast<std::int64_t>(frames.size()) * kNsPerSecond, name});
  }
  return frames;
}

void SortByTime(Survey* survey) {
  const auto earlier = [](const SurveyFrame& a, const SurveyFrame& b) { return a.stamp_ns < b.stamp_ns; };
  for (std::size_t i = 1; i < survey->frames.size(); ++i) {
    survey->rows_out_of_order += earlier(survey->frames[i], survey->frames[i - 1]) ? 1 : 0;
  }
  std::stable_sort(survey->frames.begin(), survey->frames.end(), earlier);
}

// Keeps the usable rows and records the others with their reasons in skipped_frames.
void SkipBadFrames(Survey* survey) {
  SortByTime(survey);
  std::vector<SurveyFrame> kept;
  for (SurveyFrame& frame : survey->frames) {
    if (!IsFile(survey->ImagePath(frame))) {
      survey->skipped_frames.push_back({frame.filename, "image is missing"});
    } else if (!kept.empty() && kept.back().stamp_ns == frame.stamp_ns) {
      survey->skipped_frames.push_back({frame.filename, "time stamp is that of another frame"});
    } else {
      kept.push_back(std::move(frame));
    }
  }
  survey->frames = std::move(kept);
}

void ReadFrames(BadFramePolicy bad_frames, Survey* survey) {
  const fs::path file = survey->folder / "frames.csv";
  if (!Exists(file)) {
    survey->frames = ListImages(survey->folder);
    return;
  }
  const std::string text = ReadTextFile(file);
  survey->frames = ParseFramesCsv(text, file, bad_frames);
  if (bad_frames == BadFramePolicy::kSkip) {
    SkipBadFrames(survey);
    if (survey->frames.empty()) {
      throw InputError(file, "none of the listed images exists; copy them to " + survey->folder.string());
    }
    return;
  }
  for (std::size_t i = 0; i < survey->frames.size(); ++i) {  // in the order of the file
    const fs::path image_file = survey->ImagePath(survey->frames[i]);
    if (!IsFile(image_file)) {
      throw InputError(file, ContentLines(text)[i + 1].number,
                       "the image " + image_file.string() + " is missing; add it or delete the row");
    }
  }
}

void MoveStampsToMiddleRow(Survey* survey) {
  for (SurveyFrame& frame : survey->frames) {
    frame.stamp_ns += survey->camera.camera.readout.StampShiftNs();
  }
}

// Rejects rows of a table that name an image which is not a frame of the survey.
class FrameNames {
 public:
  explicit FrameNames(const Survey& survey) {
    for (const SurveyFrame& frame : survey.frames) {
      known_.insert(frame.filename);
    }
    for (const SkippedFrame& frame : survey.skipped_frames) {
      known_.insert(frame.filename);
    }
  }
  // The frame of this path or, as photogrammetry programs write it, of this name in its folder.
  std::string Find(const std::string& name) const {
    if (known_.contains(name)) {
      return name;
    }
    std::string found;
    for (const std::string& filename : known_) {
      if (fs::path(filename).filename() == fs::path(name).filename()) {
        if (!found.empty()) {
          return name;  // of two folders
        }
        found = filename;
      }
    }
    return found.empty() ? name : found;
  }
  // row: counted from 0 below the header line.
  void Require(const std::string& filename, std::size_t row, const fs::path& file, const std::string& text) const {
    if (!known_.contains(filename)) {
      throw InputError(file, ContentLines(text)[row + 1].number,
                       "the image " + filename + " is not a frame of the survey; correct or delete the row");
    }
  }

 private:
  std::unordered_set<std::string> known_;
};

std::vector<ControlPoint> ReadControlPoints(const fs::path& file, const FrameNames& names) {
  const std::string text = ReadTextFile(file);
  std::vector<ControlPoint> points = ParseControlPointsCsv(text, file);
  for (std::size_t i = 0; i < points.size(); ++i) {
    names.Require(points[i].filename, i, file, text);
  }
  return points;
}

std::vector<ControlPoint> ReadGcpList(const fs::path& file, const FrameNames& names) {
  const std::string text = ReadTextFile(file);
  std::vector<ControlPoint> points = ParseGcpList(text, file);
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].filename = names.Find(points[i].filename);
    names.Require(points[i].filename, i, file, text);
  }
  return points;
}

// Of control_points.csv, or of OpenDroneMap's gcp_list.txt.
void ReadAnyControlPoints(Survey* survey) {
  const fs::path own = survey->folder / "control_points.csv";
  const fs::path odm = survey->folder / "gcp_list.txt";
  if (Exists(own) && Exists(odm)) {
    throw InputError(odm, "stands beside control_points.csv; keep one of the two, so that no point counts twice");
  }
  if (Exists(own)) {
    survey->control_points = ReadControlPoints(own, FrameNames(*survey));
    survey->control_point_file = own;
  } else if (Exists(odm)) {
    survey->control_points = ReadGcpList(odm, FrameNames(*survey));
    survey->control_point_file = odm;
  }
}

std::vector<KnownDistance> ReadKnownDistances(const fs::path& file, const FrameNames& names) {
  const std::string text = ReadTextFile(file);
  std::vector<KnownDistance> distances = ParseKnownDistancesCsv(text, file);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    names.Require(distances[i].first_filename, i, file, text);
    names.Require(distances[i].second_filename, i, file, text);
  }
  return distances;
}

}  // namespace

std::string FolderName(const fs::path& folder) {
  const fs::path whole = fs::absolute(folder).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

Survey ReadSurvey(const std::filesystem::path& folder, BadFramePolicy bad_frames) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw InputError(folder, "is not a folder; name a folder with camera.yaml, floor.yaml and frames.csv");
  }
  Survey survey;
  survey.folder = folder;
  survey.camera = ReadFloorCamera(folder);
  survey.mask = ReadCameraMask(folder, survey.camera.camera);
  ReadFrames(bad_frames, &survey);
  MoveStampsToMiddleRow(&survey);
  if (const fs::path file = folder / "odometry.tum"; Exists(file)) {
    survey.odometry = ReadTum(file);
    CheckPlanar(survey.odometry, file);
  }
  if (const fs::path file = folder / "groundtruth.tum"; Exists(file)) {
    survey.ground_truth = ReadTum(file);
    CheckPlanar(survey.ground_truth, file);
  }
  if (const fs::path file = folder / "imu.csv"; Exists(file)) {
    survey.imu = ParseImuCsv(ReadTextFile(file), file);
  }
  ReadAnyControlPoints(&survey);
  if (const fs::path file = folder / "known_distances.csv"; Exists(file)) {
    survey.known_distances = ReadKnownDistances(file, FrameNames(survey));
  }
  return survey;
}

CameraRecording ReadCameraRecording(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw InputError(folder, "is not a folder; name a folder with camera.yaml and frames.csv");
  }
  Survey survey;
  survey.folder = folder;
  ReadFrames(BadFramePolicy::kThrow, &survey);
  const fs::path file = folder / "camera.yaml";
  return {folder, ParseCameraYaml(ReadTextFile(file), file), std::move(survey.frames)};
}

}  // namespace floorloc
