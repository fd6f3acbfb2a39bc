// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/calibration/camera_calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/option_check.h"
#include "core/io/input_error.h"
#include "mapbuilder/calibration/initial_lens.h"

namespace floorloc {
namespace {

constexpr std::size_t kMinViews = 3;
constexpr int kMaxSteps = 200;
constexpr int kK3 = kFirstCoefficient + 4;

// k3 is kept if it lowers the cost significantly (chi-square with one degree of freedom, 0.1 %) ...
constexpr double kSignificantChiSquare = 10.8;
// ... and its uncertainty displaces the image corner by less than this.
constexpr double kMaxK3EffectPx = 0.3;

int CoefficientCount(DistortionModel model) {
  switch (model) {
    case DistortionModel::kPlumbBob:
      return 5;
    case DistortionModel::kRationalPolynomial:
      return 8;
    case DistortionModel::kEquidistant:
      return 4;
  }
  return 0;
}

std::vector<int> FixedParameters(DistortionModel model, bool with_k3) {
  std::vector<int> fixed;
  if (model == DistortionModel::kPlumbBob && !with_k3) {
    fixed.push_back(kK3);
  }
  for (int i = kFirstCoefficient + CoefficientCount(model); i < kLensParameters; ++i) {
    fixed.push_back(i);
  }
  return fixed;
}

// A finished adjustment with derived quantities.
struct Solution {
  LensAdjustment adjustment;
  AdjustmentSummary summary;

  std::size_t corner_count() const {
    std::size_t count = 0;
    for (const ObservedPoints& view : adjustment.views) {
      count += view.raw_px.size();
    }
    return count;
  }
  double free_count() const {
    return static_cast<double>(kLensParameters - adjustment.fixed.size() + 6 * adjustment.poses.size());
  }
  // Variance of a corner's coordinate, estimated from the residuals.
  double variance_px2() const {
    return 2.0 * summary.cost_px2 / std::max(1.0, 2.0 * static_cast<double>(corner_count()) - free_count());
  }
  double BayesianInformation() const {
    const double n = 2.0 * static_cast<double>(corner_count());
    return n * std::log(std::max(2.0 * summary.cost_px2 / n, 1e-12)) + free_count() * std::log(n);
  }
};

std::optional<Solution> Solve(LensAdjustment start, double height_px) {
  if (start.poses.empty() && !FindInitialLens(height_px, &start)) {
    return std::nullopt;
  }
  Solution solution{std::move(start), {}};
  solution.summary = Adjust(&solution.adjustment, kMaxSteps, true);
  return std::isfinite(solution.summary.cost_px2) ? std::optional(std::move(solution)) : std::nullopt;
}

// Displacement of the farthest image corner by one standard deviation of k3, px.
double K3EffectPx(const Solution& solution, double height_px) {
  if (!solution.summary.covariance) {
    return std::numeric_limits<double>::infinity();
  }
  const LensParameters& lens = solution.adjustment.lens;
  const double aspect = height_px / solution.adjustment.width_px;
  const double r =
      std::hypot(std::max(lens[2], 1.0 - lens[2]) / lens[0], std::max(lens[3], aspect - lens[3]) / lens[1]);
  const double sigma = std::sqrt((*solution.summary.covariance)(kK3, kK3) * solution.variance_px2());
  return sigma * std::pow(r, 7) * lens[0] * solution.adjustment.width_px;
}

std::optional<Solution> SolveModel(const LensAdjustment& start, double height_px) {
  LensAdjustment simple = start;
  simple.fixed = FixedParameters(start.model, false);
  std::optional<Solution> solution = Solve(std::move(simple), height_px);
  if (!solution || start.model != DistortionModel::kPlumbBob) {
    return solution;
  }
  LensAdjustment with_k3 = solution->adjustment;
  with_k3.fixed = FixedParameters(start.model, true);
  std::optional<Solution> other = Solve(std::move(with_k3), height_px);
  if (other &&
      2.0 * (solution->summary.cost_px2 - other->summary.cost_px2) > kSignificantChiSquare * other->variance_px2() &&
      K3EffectPx(*other, height_px) < kMaxK3EffectPx) {
    return other;
  }
  return solution;
}

std::optional<Solution> SolveBestModel(const LensAdjustment& start, const CameraCalibrationOptions& options,
                                       double height_px) {
  std::optional<Solution> best;
  for (const DistortionModel model :
       {DistortionModel::kPlumbBob, DistortionModel::kEquidistant, DistortionModel::kRationalPolynomial}) {
    if (options.model && *options.model != model) {
      continue;
    }
    LensAdjustment problem = start;
    problem.model = model;
    std::optional<Solution> solution = SolveModel(problem, height_px);
    if (solution && (!best || solution->BayesianInformation() < best->BayesianInformation())) {
      best = std::move(solution);
    }
  }
  return best;
}

ObservedPoints PointsOf(const Board& board, const BoardView& view) {
  ObservedPoints points;
  for (std::size_t i = 0; i < view.corners.size(); ++i) {
    const Eigen::Vector2d corner = board.Corner(view.corners[i]);
    points.points_m.emplace_back(corner.x(), corner.y(), 0.0);
    points.raw_px.push_back(view.raw_px[i]);
  }
  return points;
}

void MeasureFit(const LensAdjustment& adjustment, std::size_t index, ViewFit* fit) {
  const ObservedPoints& view = adjustment.views[index];
  const std::vector<Eigen::Vector2d> expected = Project(adjustment, adjustment.poses[index], view.points_m);
  double squares = 0.0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double distance = (expected[i] - view.raw_px[i]).norm();
    squares += distance * distance;
    fit->max_px = std::max(fit->max_px, distance);
  }
  fit->rms_px = std::sqrt(squares / static_cast<double>(expected.size()));
  fit->camera_from_board = ToIsometry(adjustment.poses[index]);
}

CameraModel ToCamera(const Solution& solution, double height_px) {
  const LensAdjustment& a = solution.adjustment;
  CameraModel camera;
  camera.width_px = static_cast<int>(a.width_px);
  camera.height_px = static_cast<int>(height_px);
  camera.fx = a.lens[0] * a.width_px;
  camera.fy = a.lens[1] * a.width_px;
  camera.cx = a.lens[2] * a.width_px;
  camera.cy = a.lens[3] * a.width_px;
  camera.distortion_model = a.model;
  camera.distortion.assign(a.lens.begin() + kFirstCoefficient,
                           a.lens.begin() + kFirstCoefficient + CoefficientCount(a.model));
  return camera;
}

class Calibrator {
 public:
  Calibrator(const CameraCalibrationInput& input, const CameraCalibrationOptions& options)
      : input_(input), options_(options) {
    for (const NamedView& view : input.views) {
      result_.views.push_back({view.name, true, Eigen::Isometry3d::Identity(), 0.0, 0.0});
    }
  }

  CameraCalibration Run() {
    Solution solution = SolveUsed();
    while (ExcludeWorst()) {
      solution = SolveUsed();
    }
    result_.camera = ToCamera(solution, input_.height_px);
    if (solution.summary.covariance) {
      result_.covariance = *solution.summary.covariance * solution.variance_px2();
    }
    double squares = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < result_.views.size(); ++i) {
      if (result_.views[i].used) {
        const auto corners = static_cast<double>(input_.views[i].view.corners.size());
        squares += corners * result_.views[i].rms_px * result_.views[i].rms_px;
        count += corners;
      }
    }
    result_.rms_px = std::sqrt(squares / count);
    return std::move(result_);
  }

 private:
  // Adjusts the camera to the images in use and records the error of each image.
  Solution SolveUsed() {
    LensAdjustment problem;
    problem.width_px = input_.width_px;
    std::vector<ViewFit*> used;
    for (std::size_t i = 0; i < input_.views.size(); ++i) {
      if (result_.views[i].used) {
        problem.views.push_back(PointsOf(input_.board, input_.views[i].view));
        used.push_back(&result_.views[i]);
      }
    }
    std::optional<Solution> solution = SolveBestModel(problem, options_, input_.height_px);
    if (!solution) {
      throw InputError(
          "the images of the board fit no camera; check --board and --square, and that all images are of one "
          "camera at one zoom and focus");
    }
    for (std::size_t i = 0; i < used.size(); ++i) {
      used[i]->max_px = 0.0;
      MeasureFit(solution->adjustment, i, used[i]);
    }
    return *std::move(solution);
  }

  // Returns false when all images are consistent or too few would be left.
  bool ExcludeWorst() {
    std::vector<double> errors;
    ViewFit* worst = nullptr;
    for (ViewFit& view : result_.views) {
      if (view.used) {
        errors.push_back(view.rms_px);
        worst = worst == nullptr || view.rms_px > worst->rms_px ? &view : worst;
      }
    }
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    if (errors.size() <= kMinViews || 2 * errors.size() <= result_.views.size() ||
        worst->rms_px < std::max(options_.max_error_floor_px, options_.max_error_ratio * *middle)) {
      return false;
    }
    worst->used = false;
    return true;
  }

  const CameraCalibrationInput& input_;
  const CameraCalibrationOptions& options_;
  CameraCalibration result_;
};

}  // namespace

double CameraCalibration::SigmaPx(int lens_parameter) const {
  return covariance ? std::sqrt((*covariance)(lens_parameter, lens_parameter)) * camera.width_px
                    : std::numeric_limits<double>::infinity();
}

int CameraCalibration::used_count() const {
  return static_cast<int>(std::count_if(views.begin(), views.end(), [](const ViewFit& view) { return view.used; }));
}

void CameraCalibrationOptions::Check() const {
  RequireOption(max_error_ratio > 1.0, "max_error_ratio must be above 1");
  RequireOption(max_error_floor_px >= 0.0, "max_error_floor_px must not be negative");
}

CameraCalibration CalibrateCamera(const CameraCalibrationInput& input, const CameraCalibrationOptions& options) {
  options.Check();
  if (input.views.size() < kMinViews) {
    throw InputError("the board was found in " + std::to_string(input.views.size()) +
                     " images, and a camera takes at least 3, better 15, from different sides; add images");
  }
  return Calibrator(input, options).Run();
}

}  // namespace floorloc
