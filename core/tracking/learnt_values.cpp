// SPDX-License-Identifier: Apache-2.0
#include "core/tracking/learnt_values.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace floorloc {
namespace {

// Grows when the numbers below change.
constexpr double kFormat = 1.0;

// Far beyond what is ever learnt: such numbers are damage.
constexpr double kMax = 1e15;
constexpr double kMaxCount = 1e9;
constexpr double kMaxReadouts = 1000.0;
constexpr double kMaxCells = 256.0;  // across and down
constexpr double kMaxFactor = 1e6;
constexpr double kMaxOffsetNs = 1e10;

class NumberWriter {
 public:
  void Add(double number) { numbers_.push_back(number); }
  template <typename Derived>
  void Add(const Eigen::DenseBase<Derived>& matrix) {
    for (const double number : matrix.reshaped()) {
      Add(number);
    }
  }
  // In halves, since a double holds 53 bits.
  void AddKey(std::size_t key) {
    Add(static_cast<double>(key >> 32U));
    Add(static_cast<double>(key & 0xFFFFFFFFU));
  }
  void Add(const cv::Mat& floats) {
    for (const float number : cv::Mat_<float>(floats)) {
      Add(static_cast<double>(number));
    }
  }
  std::vector<double> Take() { return std::move(numbers_); }

 private:
  std::vector<double> numbers_;
};

// After the first number that is missing, not finite or beyond its bounds all are 0, and Complete() is false.
class NumberReader {
 public:
  explicit NumberReader(const std::vector<double>& numbers) : numbers_(numbers) {}

  double Real(double min = -kMax, double max = kMax) {
    if (failed_ || at_ >= numbers_.size() || !(numbers_[at_] >= min && numbers_[at_] <= max)) {
      failed_ = true;
      return 0.0;
    }
    return numbers_[at_++];
  }
  double Whole(double max) {
    const double number = Real(0.0, max);
    failed_ = failed_ || number != std::floor(number);
    return failed_ ? 0.0 : number;
  }
  bool Flag() { return Whole(1.0) == 1.0; }
  int Integer(double max) { return static_cast<int>(Whole(max)); }
  std::size_t Key() {
    const auto high = static_cast<std::size_t>(Whole(0xFFFFFFFF));
    return (high << 32U) | static_cast<std::size_t>(Whole(0xFFFFFFFF));
  }
  template <typename Matrix>
  Matrix Numbers() {
    Matrix matrix;
    for (double& number : matrix.reshaped()) {
      number = Real();
    }
    return matrix;
  }
  // A covariance or an information matrix.
  template <typename Matrix>
  Matrix Semidefinite() {
    const Matrix matrix = Numbers<Matrix>();
    const double rounding = 1e-9 * matrix.diagonal().maxCoeff() + std::numeric_limits<double>::min();
    const Eigen::LLT<Matrix> factor(matrix + rounding * Matrix::Identity());
    failed_ = failed_ || matrix != matrix.transpose() || factor.info() != Eigen::Success;
    return failed_ ? Matrix(Matrix::Zero()) : matrix;
  }
  cv::Mat Floats(const cv::Size& size) {
    cv::Mat_<float> floats(failed_ ? cv::Size() : size);
    for (float& number : floats) {
      number = static_cast<float>(Real(0.0, kMaxFactor));
    }
    return floats;
  }
  void Require(bool condition) { failed_ = failed_ || !condition; }
  bool Complete() const { return !failed_ && at_ == numbers_.size(); }

 private:
  const std::vector<double>& numbers_;
  std::size_t at_ = 0;
  bool failed_ = false;
};

void Add(const std::optional<LearntOdometry>& odometry, NumberWriter* writer) {
  writer->Add(odometry ? 1.0 : 0.0);
  if (odometry) {
    writer->Add(odometry->bias.scale);
    writer->Add(odometry->bias.yaw_scale);
    writer->Add(odometry->bias.drift_rad_per_m);
    writer->Add(Eigen::Matrix3d(0.5 * (odometry->covariance + odometry->covariance.transpose())));
    writer->Add(odometry->noise_factor);
    writer->Add(static_cast<double>(odometry->offset_ns));
  }
}

std::optional<LearntOdometry> ReadOdometry(NumberReader* reader) {
  if (!reader->Flag()) {
    return std::nullopt;
  }
  LearntOdometry odometry;
  odometry.bias.scale = reader->Real(-1.0, 1.0);
  odometry.bias.yaw_scale = reader->Real(-1.0, 1.0);
  odometry.bias.drift_rad_per_m = reader->Real(-1.0, 1.0);
  odometry.covariance = reader->Semidefinite<Eigen::Matrix3d>();
  odometry.noise_factor = reader->Real(1.0 / kMaxFactor, kMaxFactor);
  odometry.offset_ns = std::llround(reader->Real(-kMaxOffsetNs, kMaxOffsetNs));
  return odometry;
}

void Add(const LearntCamera::Sums& sums, NumberWriter* writer) {
  writer->Add(CameraErrorMatrix(0.5 * (sums.information + sums.information.transpose())));
  writer->Add(sums.pull);
}

LearntCamera::Sums ReadSums(NumberReader* reader) {
  LearntCamera::Sums sums;
  sums.information = reader->Semidefinite<CameraErrorMatrix>();
  sums.pull = reader->Numbers<CameraErrors>();
  return sums;
}

void Add(const LearntCamera& camera, NumberWriter* writer) {
  writer->AddKey(camera.camera);
  writer->Add(camera.fixes);
  writer->Add(camera.last_used ? 1.0 : 0.0);
  if (camera.last_used) {
    writer->Add(Eigen::Vector3d(camera.last_used->x(), camera.last_used->y(), camera.last_used->yaw()));
    Add(camera.all, writer);
    Add(camera.recent, writer);
  }
}

LearntCamera ReadCamera(NumberReader* reader) {
  LearntCamera camera;
  camera.camera = reader->Key();
  camera.fixes = reader->Integer(kMaxCount);
  if (reader->Flag()) {
    const auto at = reader->Numbers<Eigen::Vector3d>();
    camera.last_used = Pose2(at.x(), at.y(), at.z());
    camera.all = ReadSums(reader);
    camera.recent = ReadSums(reader);
  }
  reader->Require(camera.last_used.has_value() == (camera.fixes > 0));
  return camera;
}

void Add(const std::vector<ReadoutMeasurement>& readout, NumberWriter* writer) {
  writer->Add(static_cast<double>(readout.size()));
  for (const ReadoutMeasurement& measurement : readout) {
    writer->Add(measurement.seconds);
    writer->Add(measurement.sigma_s);
  }
}

std::vector<ReadoutMeasurement> ReadReadout(NumberReader* reader) {
  std::vector<ReadoutMeasurement> readout(static_cast<std::size_t>(reader->Whole(kMaxReadouts)));
  for (ReadoutMeasurement& measurement : readout) {
    measurement.seconds = reader->Real(-1.0, 1.0);
    measurement.sigma_s = reader->Real(1e-9, 1.0);
  }
  return readout;
}

void Add(const MaskEvidence& mask, NumberWriter* writer) {
  writer->Add(mask.pairs);
  if (mask.pairs > 0) {
    writer->Add(mask.share);
    writer->Add(mask.cells.width);
    writer->Add(mask.cells.height);
    writer->Add(mask.grid.x_top_m);
    writer->Add(mask.grid.y_left_m);
    writer->Add(mask.grid.resolution_m);
    for (const cv::Mat* votes : {&mask.votes.views, &mask.votes.standing, &mask.votes.floor}) {
      writer->Add(*votes);
    }
  }
}

MaskEvidence ReadMask(NumberReader* reader) {
  MaskEvidence mask;
  mask.pairs = reader->Integer(kMaxCount);
  if (mask.pairs > 0) {
    mask.share = reader->Real(0.0, 1.0);
    mask.cells.width = reader->Integer(kMaxCells);
    mask.cells.height = reader->Integer(kMaxCells);
    reader->Require(mask.cells.area() > 0);
    mask.grid.x_top_m = reader->Real();
    mask.grid.y_left_m = reader->Real();
    mask.grid.resolution_m = reader->Real();
    mask.votes = {reader->Floats(mask.cells), reader->Floats(mask.cells), reader->Floats(mask.cells)};
  }
  return mask;
}

}  // namespace

LearntValues HeldWith(const LearntWith& now, LearntValues learnt, const LearntWith& before) {
  LearntValues held;
  if (now.in_map == before.in_map) {
    held = std::move(learnt);
  } else {
    held.mask = std::move(learnt.mask);
  }
  if (now.given != before.given) {
    held.mask = MaskEvidence();
  }
  return held;
}

std::vector<double> ToNumbers(const LearntValues& learnt) {
  NumberWriter writer;
  writer.Add(kFormat);
  Add(learnt.odometry, &writer);
  Add(learnt.camera, &writer);
  Add(learnt.readout, &writer);
  Add(learnt.mask, &writer);
  return writer.Take();
}

std::optional<LearntValues> FromNumbers(const std::vector<double>& numbers) {
  NumberReader reader(numbers);
  reader.Require(reader.Real() == kFormat);
  LearntValues learnt;
  learnt.odometry = ReadOdometry(&reader);
  learnt.camera = ReadCamera(&reader);
  learnt.readout = ReadReadout(&reader);
  learnt.mask = ReadMask(&reader);
  return reader.Complete() ? std::optional(std::move(learnt)) : std::nullopt;
}

}  // namespace floorloc
