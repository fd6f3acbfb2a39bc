// SPDX-License-Identifier: Apache-2.0
#include "core/vision/features/keypoint_selection.h"

#include <algorithm>
#include <tuple>

namespace floorloc {

void KeepStrongest(const cv::Mat& mask, int count, std::vector<cv::KeyPoint>* keypoints) {
  if (!mask.empty()) {
    std::erase_if(*keypoints,
                  [&](const cv::KeyPoint& k) { return mask.at<std::uint8_t>(cvRound(k.pt.y), cvRound(k.pt.x)) == 0; });
  }
  // All fields, so that the order is deterministic for equal responses.
  const auto order = [](const cv::KeyPoint& k) { return std::make_tuple(-k.response, k.pt.y, k.pt.x, k.size); };
  std::sort(keypoints->begin(), keypoints->end(),
            [&](const cv::KeyPoint& a, const cv::KeyPoint& b) { return order(a) < order(b); });
  if (count > 0 && keypoints->size() > static_cast<std::size_t>(count)) {
    keypoints->resize(static_cast<std::size_t>(count));
  }
}

void DropNearEdge(const cv::Size& image_size, const std::function<float(const cv::KeyPoint&)>& reach_px,
                  std::vector<cv::KeyPoint>* keypoints) {
  std::erase_if(*keypoints, [&](const cv::KeyPoint& k) {
    const float reach = reach_px(k);
    return !(k.pt.x >= reach && k.pt.y >= reach && k.pt.x <= static_cast<float>(image_size.width - 1) - reach &&
             k.pt.y <= static_cast<float>(image_size.height - 1) - reach);
  });
}

}  // namespace floorloc
