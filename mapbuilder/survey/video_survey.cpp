// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/survey/video_survey.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

#include "core/io/camera_yaml.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/io/trajectory.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;

constexpr int kJpegQuality = 95;

// Images are compared downscaled by this factor, which suppresses sensor noise.
constexpr int kThumbnailShare = 8;
constexpr int kThumbnailMeanPx = 7;

// Two images are taken to show the same place when they differ by less than this share of their contrast.
constexpr double kMaxStationaryDifference = 0.25;

// The number of frames in a container's header is only approximate.
constexpr double kMinReadShare = 0.95;

struct VideoFrame {
  cv::Mat bgr;
  cv::Mat thumbnail;  // CV_32F, local contrast, independent of illumination
  double time_s = 0.0;
  double sharpness = 0.0;
};

VideoFrame Describe(const cv::Mat& bgr, double time_s) {
  VideoFrame frame{bgr.clone(), {}, time_s, 0.0};
  cv::Mat gray;
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  cv::Mat half;
  cv::resize(gray, half, {}, 0.5, 0.5, cv::INTER_AREA);
  cv::Mat edges;
  cv::Laplacian(half, edges, CV_16S);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(edges, mean, deviation);
  frame.sharpness = deviation[0];
  cv::Mat small;
  cv::resize(gray, small, {std::max(1, gray.cols / kThumbnailShare), std::max(1, gray.rows / kThumbnailShare)}, 0, 0,
             cv::INTER_AREA);
  small.convertTo(small, CV_32F);
  cv::Mat local_mean;
  cv::blur(small, local_mean, {kThumbnailMeanPx, kThumbnailMeanPx});
  frame.thumbnail = small - local_mean;
  return frame;
}

// The median ignores a part of the robot that is always in view.
double MedianMagnitude(const cv::Mat& values) {
  std::vector<float> magnitudes(values.begin<float>(), values.end<float>());
  std::for_each(magnitudes.begin(), magnitudes.end(), [](float& v) { v = std::abs(v); });
  const auto middle = magnitudes.begin() + static_cast<std::ptrdiff_t>(magnitudes.size() / 2);
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return *middle;
}

bool ShowSameFloor(const VideoFrame& a, const VideoFrame& b) {
  return MedianMagnitude(a.thumbnail - b.thumbnail) < kMaxStationaryDifference * MedianMagnitude(a.thumbnail);
}

// Reads the frames of a video in order, with seconds since the first.
class VideoReader {
 public:
  explicit VideoReader(const fs::path& file) : file_(file) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) {
      throw InputError(file, "is not a file; name a video");
    }
    // Fixed backends: OpenCV's others interpret file names as patterns or URLs.
    for (const int reader : {cv::CAP_FFMPEG, cv::CAP_OPENCV_MJPEG}) {
      if (!capture_.isOpened()) {
        capture_.open(file.string(), reader);
      }
    }
    if (!capture_.isOpened()) {
      throw InputError(file, "is no video that can be read; convert it, for example to MP4 with H.264");
    }
    capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);  // the calibration is for unrotated images
    fps_ = capture_.get(cv::CAP_PROP_FPS);
  }

  // Returns false at the end.
  bool Read(cv::Mat* bgr, double* time_s) {
    bool more = false;
    try {
      more = capture_.read(*bgr) && !bgr->empty();
    } catch (const cv::Exception&) {
      more = false;
    }
    if (more) {
      *time_s = NextTime();
      ++count_;
    }
    return more;
  }

  int count() const { return count_; }
  int expected() const {
    const double expected = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    return expected > 0.0 && expected < 1e9 ? static_cast<int>(expected) : 0;
  }

 private:
  // Time stamp from the container if it has any, since frame rates vary; otherwise evenly spaced.
  double NextTime() {
    const double at_s = 1e-3 * capture_.get(cv::CAP_PROP_POS_MSEC);
    if (count_ == 0) {
      first_s_ = at_s;
      return last_s_ = 0.0;
    }
    const double since_first_s = at_s - first_s_;
    if (since_first_s > last_s_) {
      return last_s_ = since_first_s;
    }
    if (!(fps_ > 0.0 && fps_ < 1e5)) {
      throw InputError(file_, "says neither times nor a rate of its images; convert it, for example to MP4");
    }
    return last_s_ += 1.0 / fps_;
  }

  fs::path file_;
  cv::VideoCapture capture_;
  double fps_ = 0.0;
  double first_s_ = 0.0;
  double last_s_ = 0.0;
  int count_ = 0;
};

// Writes the chosen frames to a survey folder.
class SurveyWriter {
 public:
  SurveyWriter(const fs::path& folder, double start_s) : folder_(folder), start_s_(start_s) {
    std::error_code error;
    fs::remove_all(folder_, error);
    fs::create_directories(folder_ / "images", error);
    if (error) {
      throw InputError(folder_, "cannot be created (" + error.message() + "); check the path and its permissions");
    }
  }

  // Removes an unfinished folder, which was not renamed to its final name.
  ~SurveyWriter() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
    fs::remove(folder_.parent_path(), ignored);  // when empty
  }
  SurveyWriter(const SurveyWriter&) = delete;
  SurveyWriter& operator=(const SurveyWriter&) = delete;

  void Add(VideoFrame frame) {
    if (!last_.bgr.empty() && ShowSameFloor(last_, frame)) {
      return;
    }
    char name[32];
    std::snprintf(name, sizeof(name), "images/%06d.jpg", count_);
    bool written = false;
    try {
      written = cv::imwrite((folder_ / name).string(), frame.bgr, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
    } catch (const cv::Exception&) {
      written = false;
    }
    if (!written) {
      throw InputError(folder_ / name, "cannot be written; is the disk full?");
    }
    const auto stamp_ns = static_cast<std::int64_t>(std::llround(1e9 * (start_s_ + frame.time_s)));
    table_ += FormatSeconds(stamp_ns) + "," + name + "\n";
    last_ = std::move(frame);
    ++count_;
  }

  int Finish() {
    WriteFileAtomically(folder_ / "frames.csv", table_);
    return count_;
  }

 private:
  fs::path folder_;
  double start_s_;
  std::string table_ = "timestamp,filename\n";
  VideoFrame last_;
  int count_ = 0;
};

void CheckSize(const cv::Mat& frame, const CameraModel& camera, const VideoSurveyOptions& options) {
  if (frame.cols != camera.width_px || frame.rows != camera.height_px) {
    throw InputError(options.video, "the images are " + std::to_string(frame.cols) + "x" + std::to_string(frame.rows) +
                                        " but " + options.camera_yaml.string() + " says " +
                                        std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px) +
                                        "; use a video of the calibrated camera");
  }
}

// Writes the sharpest image of every time step.
void PickFrames(const VideoSurveyOptions& options, const CameraModel& camera, VideoReader* reader,
                SurveyWriter* writer) {
  ProgressBar progress("video", reader->expected(), options.run.progress);
  VideoFrame best;
  std::int64_t span = 0;
  cv::Mat bgr;
  double time_s = 0.0;
  while (reader->Read(&bgr, &time_s)) {
    CheckSize(bgr, camera, options);
    const auto frame_span = static_cast<std::int64_t>(time_s / options.step_s);
    if (frame_span != span && !best.bgr.empty()) {
      writer->Add(std::move(best));
      best = VideoFrame();
    }
    span = frame_span;
    VideoFrame frame = Describe(bgr, time_s);
    if (best.bgr.empty() || frame.sharpness > best.sharpness) {
      best = std::move(frame);
    }
    progress.Advance();
  }
  if (!best.bgr.empty()) {
    writer->Add(std::move(best));
  }
}

void Copy(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) {
    throw InputError(from, "cannot be copied to " + to.string() + " (" + error.message() + "); check both");
  }
}

}  // namespace

void VideoSurveyOptions::Check() const {
  if (!(step_s > 0.0 && step_s <= 60.0)) {
    throw std::invalid_argument("the time between images of a video must be above 0 and at most 60 seconds");
  }
  if (!(std::abs(start_s) <= 4e9)) {
    throw std::invalid_argument("the start of a video must be a time in seconds, at most 4e9");
  }
}

VideoSurveyResult WriteVideoSurvey(const VideoSurveyOptions& options) {
  options.Check();
  const CameraModel camera = ParseCameraYaml(ReadTextFile(options.camera_yaml), options.camera_yaml);
  VideoReader reader(options.video);
  fs::path pending = options.out;
  pending += ".partial";
  SurveyWriter writer(pending, options.start_s);
  PickFrames(options, camera, &reader, &writer);
  VideoSurveyResult result{reader.count(), writer.Finish(), {}};
  if (result.frames_written == 0) {
    throw InputError(options.video, "has no image that can be read; record it again or convert it");
  }
  if (reader.count() < kMinReadShare * reader.expected()) {
    result.warnings.push_back(options.video.string() + ": only " + std::to_string(reader.count()) + " of about " +
                              std::to_string(reader.expected()) + " images could be read; the file may be cut off");
  }
  Copy(options.camera_yaml, pending / "camera.yaml");
  Copy(options.floor_yaml, pending / "floor.yaml");
  if (!options.odometry.empty()) {
    Copy(options.odometry, pending / "odometry.tum");
  }
  std::error_code error;
  fs::remove_all(options.out, error);
  fs::rename(pending, options.out, error);
  if (error) {
    throw InputError(options.out, "cannot be created (" + error.message() + "); check the path and its permissions");
  }
  return result;
}

fs::path FindVideo(const fs::path& folder) {
  std::error_code ignored;
  if (fs::exists(folder / "frames.csv", ignored) || fs::exists(folder / "images", ignored)) {
    return {};
  }
  for (const char* name : {"video.mp4", "video.avi", "video.mkv", "video.mov"}) {
    if (fs::is_regular_file(folder / name, ignored)) {
      return folder / name;
    }
  }
  return {};
}

}  // namespace floorloc
