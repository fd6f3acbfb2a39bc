// SPDX-License-Identifier: Apache-2.0
#include "core/vision/image/motion_blur.h"

#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>

#include "core/geometry/option_check.h"

namespace floorloc {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kMiddle = 128.0;  // mean grey level of a normalised image
constexpr double kContrast = 0.7;  // the filter raises the contrast; so no grey level is cut off
constexpr double kLagStepPx = 0.5;
constexpr double kMinLagPx = 4.0;  // nearer, the floor's own texture has its dip

// Space around the image, so that its sides do not touch in the periodic transform.
int PaddedSize(int size, const MotionBlurOptions& options) {
  return cv::getOptimalDFTSize(size + static_cast<int>(std::ceil(options.max_length_px)));
}

cv::Mat SpectrumOf(const cv::Mat& normalized, const MotionBlurOptions& options) {
  cv::Mat centred;
  normalized.convertTo(centred, CV_32F, 1.0, -kMiddle);
  cv::Mat padded = cv::Mat::zeros(PaddedSize(centred.rows, options), PaddedSize(centred.cols, options), CV_32F);
  centred.copyTo(padded(cv::Rect({}, centred.size())));
  cv::Mat spectrum;
  cv::dft(padded, spectrum, cv::DFT_COMPLEX_OUTPUT, normalized.rows);
  return spectrum;
}

// Applies change(value, frequency along the direction in cycles per pixel) to a copy of the spectrum, and transforms it
// back.
template <typename Change>
cv::Mat Filtered(const cv::Mat& spectrum, const Eigen::Vector2d& direction, const Change& change) {
  cv::Mat changed(spectrum.size(), CV_32FC2);
  const auto frequency = [](int k, int size) { return (k <= size / 2 ? k : k - size) / static_cast<double>(size); };
  for (int v = 0; v < spectrum.rows; ++v) {
    const double along_v = frequency(v, spectrum.rows) * direction.y();
    const auto* from = spectrum.ptr<cv::Vec2f>(v);
    auto* to = changed.ptr<cv::Vec2f>(v);
    for (int u = 0; u < spectrum.cols; ++u) {
      to[u] = change(from[u], along_v + frequency(u, spectrum.cols) * direction.x());
    }
  }
  cv::Mat image;
  cv::dft(changed, image, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
  return image;
}

// Of a periodic image, bilinear.
double SampleAt(const cv::Mat& image, const Eigen::Vector2d& at) {
  const int u = static_cast<int>(std::floor(at.x()));
  const int v = static_cast<int>(std::floor(at.y()));
  const double a = at.x() - u;
  const double b = at.y() - v;
  const auto pixel = [&](int row, int column) {
    return static_cast<double>(image.at<float>((row + image.rows) % image.rows, (column + image.cols) % image.cols));
  };
  return (1.0 - b) * ((1.0 - a) * pixel(v, u) + a * pixel(v, u + 1)) +
         b * ((1.0 - a) * pixel(v + 1, u) + a * pixel(v + 1, u + 1));
}

// 0: no blur is seen.
double MeasureLength(const cv::Mat& spectrum, const Eigen::Vector2d& direction, const MotionBlurOptions& options) {
  const cv::Mat correlation = Filtered(spectrum, direction, [](const cv::Vec2f& value, double along) {
    const auto power_of_slope = static_cast<float>(2.0 - 2.0 * std::cos(2.0 * kPi * along));
    return cv::Vec2f(value.dot(value) * power_of_slope, 0.0F);
  });
  double length = 0.0;
  double lowest = -options.min_dip * SampleAt(correlation, Eigen::Vector2d::Zero());
  for (double lag = kMinLagPx; lag <= options.max_length_px; lag += kLagStepPx) {
    const double here = SampleAt(correlation, lag * direction);
    if (here < lowest) {
      lowest = here;
      length = lag;
    }
  }
  return length;
}

}  // namespace

void MotionBlurOptions::Check() const {
  RequireOption(min_length_px > 0.0, "min_length_px must be positive");
  RequireOption(max_length_px >= min_length_px && max_length_px <= 1000.0,
                "max_length_px must be min_length_px to 1000");
  RequireOption(min_dip > 0.0 && min_dip < 1.0, "min_dip must be above 0 and below 1");
  RequireOption(noise_share > 0.0, "noise_share must be positive");
  RequireOption(max_exposure_s >= 0.0, "max_exposure_s must not be negative");
}

std::optional<cv::Mat> UndoMotionBlur(const cv::Mat& normalized, const Eigen::Vector2d& direction,
                                      const MotionBlurOptions& options) {
  const cv::Mat spectrum = SpectrumOf(normalized, options);
  const double length = MeasureLength(spectrum, direction, options);
  if (length < options.min_length_px) {
    return std::nullopt;
  }
  const cv::Mat sharp = Filtered(spectrum, direction, [&](const cv::Vec2f& value, double along) {
    const double x = kPi * length * along;
    const double passed = std::abs(x) < 1e-6 ? 1.0 : std::sin(x) / x;
    return value * static_cast<float>(passed * (1.0 + options.noise_share) / (passed * passed + options.noise_share));
  });
  cv::Mat image;
  sharp(cv::Rect({}, normalized.size())).convertTo(image, CV_8U, kContrast, kMiddle);
  return image;
}

}  // namespace floorloc
