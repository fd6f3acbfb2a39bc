// SPDX-License-Identifier: Apache-2.0
#include "core/io/imported_lens.h"

#include <algorithm>

namespace floorloc {
namespace {

// Which lens, and how many numbers it takes; trailing zeros beyond them change nothing.
struct Lens {
  DistortionModel model = DistortionModel::kPlumbBob;
  std::size_t count = 5;
};

std::optional<Lens> LensOfName(const std::string& name) {
  const std::string key = NormalizedKey(name);
  const auto is = [&](Names names) { return std::find(names.begin(), names.end(), key) != names.end(); };
  if (is({"plumbbob", "radtan", "radialtangential", "none", ""})) {
    return Lens{DistortionModel::kPlumbBob, 5};
  }
  if (is({"rationalpolynomial"})) {
    return Lens{DistortionModel::kRationalPolynomial, 8};
  }
  if (is({"equidistant", "equi", "fisheye", "kannalabrandt"})) {
    return Lens{DistortionModel::kEquidistant, 4};
  }
  return std::nullopt;
}

// OpenCV's coefficients tell their model by their number, but both the fisheye and the pinhole model may have 4.
Lens LensOfCount(const YamlDocument& document, const YAML::Mark& mark, std::size_t count) {
  const YAML::Node fisheye = document.root()["fisheye_model"];
  if (fisheye.IsDefined() && fisheye.IsScalar() && fisheye.Scalar() != "0" && fisheye.Scalar() != "false") {
    return {DistortionModel::kEquidistant, 4};
  }
  if (count == 4 && !fisheye.IsDefined()) {
    document.Fail(mark,
                  "4 distortion coefficients may be a fisheye's or a pinhole camera's; say which: --model equidistant "
                  "(cv::fisheye) or --model plumb_bob (cv::calibrateCamera)");
  }
  return count <= 5 ? Lens{DistortionModel::kPlumbBob, 5} : Lens{DistortionModel::kRationalPolynomial, 8};
}

std::vector<double> Trimmed(const YamlDocument& document, const YAML::Mark& mark, std::vector<double> numbers,
                            std::size_t count) {
  for (std::size_t i = count; i < numbers.size(); ++i) {
    if (numbers[i] != 0.0) {
      document.Fail(mark, "the lens has " + std::to_string(numbers.size()) +
                              " distortion coefficients (thin prism or tilted sensor, if OpenCV made them), of which " +
                              std::to_string(count) + " can be used; calibrate again without the others");
    }
  }
  numbers.resize(numbers.empty() ? count : std::min(numbers.size(), count));
  return numbers;
}

}  // namespace

void ReadLens(const YamlDocument& document, const LensSource& lens_source, CameraModel* camera) {
  const auto& [model, numbers, assumed] = lens_source;
  const YAML::Mark mark = numbers ? numbers->value.Mark() : document.root().Mark();
  const std::vector<double> all = numbers ? MatrixNumbers(document, *numbers) : std::vector<double>{};
  std::optional<Lens> lens;
  if (model) {
    const std::string name = document.Text(model->value, model->key);
    lens = LensOfName(name);
    if (!lens) {
      document.Fail(model->value.Mark(), model->key + " '" + name +
                                             "' cannot be used; calibrate with plumb_bob (radtan), "
                                             "rational_polynomial or equidistant (fisheye)");
    }
  } else if (assumed) {
    lens = LensOfName(ToString(*assumed));
  } else {
    lens = LensOfCount(document, mark, all.size());
  }
  camera->distortion_model = lens->model;
  camera->distortion = Trimmed(document, mark, all, lens->count);
}

}  // namespace floorloc
