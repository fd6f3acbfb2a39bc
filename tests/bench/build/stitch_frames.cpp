// SPDX-License-Identifier: Apache-2.0
// Runs OpenCV's Stitcher in SCANS mode, as in its documentation, on the images of a folder.
// stitch_frames FOLDER OUT: writes OUT/mosaic.jpg and OUT/positions.csv (filename,x,y): the centre of each placed
// image, in pixels of the first image.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/stitching.hpp>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> Images(const fs::path& folder) {
  std::vector<fs::path> images;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".png") {
      images.push_back(entry.path());
    }
  }
  std::sort(images.begin(), images.end());
  return images;
}

const char* ToText(cv::Stitcher::Status status) {
  switch (status) {
    case cv::Stitcher::OK:
      return "ok";
    case cv::Stitcher::ERR_NEED_MORE_IMGS:
      return "finds no images that overlap";
    case cv::Stitcher::ERR_HOMOGRAPHY_EST_FAIL:
      return "cannot estimate the motions";
    case cv::Stitcher::ERR_CAMERA_PARAMS_ADJUST_FAIL:
      return "cannot adjust the poses";
  }
  return "unknown status";
}

// In SCANS mode R of camera i maps pixels of image i to the common plane.
void WritePositions(const fs::path& file, const cv::Stitcher& stitcher, const std::vector<fs::path>& images,
                    const cv::Size& size) {
  std::ofstream out(file);
  out.precision(12);
  const std::vector<cv::detail::CameraParams> cameras = stitcher.cameras();
  const std::vector<int> component = stitcher.component();
  for (std::size_t i = 0; i < component.size(); ++i) {
    cv::Mat transform;
    cameras[i].R.convertTo(transform, CV_64F);
    const cv::Mat middle = (cv::Mat_<double>(3, 1) << 0.5 * (size.width - 1), 0.5 * (size.height - 1), 1.0);
    const cv::Mat at = transform * middle;
    out << images[static_cast<std::size_t>(component[i])].filename().string() << "," << at.at<double>(0) << ","
        << at.at<double>(1) << "\n";
  }
}

int Stitch(const fs::path& folder, const fs::path& out) {
  const std::vector<fs::path> files = Images(folder);
  std::vector<cv::Mat> images;
  for (const fs::path& file : files) {
    images.push_back(cv::imread(file.string()));
  }
  cv::setRNGSeed(1);
  const cv::Ptr<cv::Stitcher> stitcher = cv::Stitcher::create(cv::Stitcher::SCANS);
  cv::Stitcher::Status status = stitcher->estimateTransform(images);
  if (status == cv::Stitcher::OK) {
    WritePositions(out / "positions.csv", *stitcher, files, images.front().size());
    cv::Mat mosaic;
    status = stitcher->composePanorama(mosaic);
    if (status == cv::Stitcher::OK) {
      cv::imwrite((out / "mosaic.jpg").string(), mosaic);
    }
  }
  if (status != cv::Stitcher::OK) {
    std::cerr << ToText(status) << "\n";
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: stitch_frames FOLDER OUT\n";
    return 2;
  }
  try {
    return Stitch(argv[1], argv[2]);
  } catch (const std::bad_alloc&) {
    std::cerr << "out of memory\n";
  } catch (const cv::Exception& error) {
    std::cerr << (error.code == cv::Error::StsNoMem ? "out of memory" : error.err) << "\n";
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
  }
  return 1;
}
