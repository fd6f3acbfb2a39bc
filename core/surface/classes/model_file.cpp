// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/model_file.h"

#include <stdexcept>
#include <utility>

#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/surface/classes/model_bytes.h"

namespace floorloc {
namespace {

constexpr std::string_view kMagic = "FLOORSRF";
constexpr std::size_t kHeaderBytes = 8 + 4 + 8;
constexpr std::size_t kMaxClasses = 64;
constexpr std::size_t kMaxNameBytes = 255;
constexpr std::size_t kMaxInputs = 64;
constexpr std::size_t kMaxWeak = 10'000;
constexpr std::size_t kMaxVectors = 100'000;

// FNV-1a.
std::uint64_t Checksum(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  for (const char byte : bytes) {
    hash = (hash ^ static_cast<std::uint8_t>(byte)) * 0x100000001b3U;
  }
  return hash;
}

// --- groups and matrices ---

void AddGroups(const std::vector<FeatureGroup>& groups, ModelWriter* out) {
  out->AddLength(groups.size());
  for (const FeatureGroup group : groups) {
    out->Add(static_cast<std::uint8_t>(group));
  }
}

std::vector<FeatureGroup> TakeGroups(ModelReader* in) {
  std::vector<FeatureGroup> groups(in->TakeLength(kFeatureGroups));
  for (FeatureGroup& group : groups) {
    const auto number = in->Take<std::uint8_t>();
    if (number >= kFeatureGroups) {
      throw ModelDamage("a group of features is unknown");
    }
    group = static_cast<FeatureGroup>(number);
  }
  return groups;
}

template <typename Matrix>
void TakeMatrix(Eigen::Index rows, Eigen::Index columns, ModelReader* in, Matrix* matrix) {
  in->Require(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns) * sizeof(float));
  matrix->resize(rows, columns);
  in->TakeAll(matrix->data(), static_cast<std::size_t>(matrix->size()));
}

template <typename Matrix>
void AddMatrix(const Matrix& matrix, ModelWriter* out) {
  out->AddAll(matrix.data(), static_cast<std::size_t>(matrix.size()));
}

// --- parts of the model ---

void AddInput(const SvmInput& input, ModelWriter* out) {
  AddGroups(input.groups, out);
  out->AddAll(input.mean.data(), input.mean.size());
  out->AddAll(input.scale.data(), input.scale.size());
}

SvmInput TakeInput(ModelReader* in) {
  SvmInput input;
  input.groups = TakeGroups(in);
  input.mean.resize(static_cast<std::size_t>(input.size()));
  input.scale.resize(input.mean.size());
  in->TakeAll(input.mean.data(), input.mean.size());
  in->TakeAll(input.scale.data(), input.scale.size());
  return input;
}

void AddWeak(const WeakSvm& weak, ModelWriter* out) {
  out->Add(static_cast<std::uint32_t>(weak.input));
  out->Add(weak.svm.gamma);
  out->AddLength(static_cast<std::size_t>(weak.svm.vectors.rows()));
  AddMatrix(weak.svm.vectors, out);
  AddMatrix(weak.svm.weights, out);
  AddMatrix(weak.svm.bias, out);
  out->Add(static_cast<std::uint8_t>(weak.confidences.size() > 0));
  AddMatrix(weak.confidences, out);
}

WeakSvm TakeWeak(const BoostedSvm& boosted, ModelReader* in) {
  WeakSvm weak;
  const auto input = in->Take<std::uint32_t>();
  if (input >= boosted.inputs.size()) {
    throw ModelDamage("a classifier's input is unknown");
  }
  weak.input = static_cast<int>(input);
  weak.svm.gamma = in->Take<float>();
  const auto vectors = static_cast<Eigen::Index>(in->TakeLength(kMaxVectors));
  TakeMatrix(vectors, boosted.inputs[input].size(), in, &weak.svm.vectors);
  TakeMatrix(vectors, boosted.classes, in, &weak.svm.weights);
  TakeMatrix(1, boosted.classes, in, &weak.svm.bias);
  const auto has_confidences = in->Take<std::uint8_t>();
  if (has_confidences > 1) {
    throw ModelDamage("a mark is neither 0 nor 1");
  }
  if (has_confidences == 1) {
    TakeMatrix(kDecisionBlocks, boosted.classes, in, &weak.confidences);
  }
  return weak;
}

std::string FormatBody(const SurfaceModel& model) {
  ModelWriter out;
  out.AddLength(model.classes.size());
  for (const std::string& name : model.classes) {
    out.AddLength(name.size());
    out.AddAll(name.data(), name.size());
  }
  out.Add(static_cast<std::int32_t>(model.max_side_px));
  out.Add(model.segmentation.sigma_px);
  out.Add(model.segmentation.k);
  out.Add(static_cast<std::int32_t>(model.segmentation.min_size_px));
  AddGroups(model.features.groups, &out);
  out.Add(model.features.max_intensity);
  out.Add(static_cast<std::int32_t>(model.features.pattern_threshold));
  out.Add(model.features.seed);
  out.AddLength(model.boosted.inputs.size());
  for (const SvmInput& input : model.boosted.inputs) {
    AddInput(input, &out);
  }
  out.AddLength(model.boosted.weak.size());
  for (const WeakSvm& weak : model.boosted.weak) {
    AddWeak(weak, &out);
  }
  out.Add(model.segment_sharpness);
  out.Add(model.image_sharpness);
  return out.Take();
}

SurfaceModel ParseBody(std::string_view bytes) {
  ModelReader in(bytes);
  SurfaceModel model;
  model.classes.resize(in.TakeLength(kMaxClasses));
  for (std::string& name : model.classes) {
    name.resize(in.TakeLength(kMaxNameBytes));
    in.TakeAll(name.data(), name.size());
  }
  model.max_side_px = in.Take<std::int32_t>();
  model.segmentation.sigma_px = in.Take<double>();
  model.segmentation.k = in.Take<double>();
  model.segmentation.min_size_px = in.Take<std::int32_t>();
  model.features.groups = TakeGroups(&in);
  model.features.max_intensity = in.Take<float>();
  model.features.pattern_threshold = in.Take<std::int32_t>();
  model.features.seed = in.Take<std::uint64_t>();
  model.boosted.classes = static_cast<int>(model.classes.size());
  const std::size_t inputs = in.TakeLength(kMaxInputs);
  for (std::size_t i = 0; i < inputs; ++i) {
    model.boosted.inputs.push_back(TakeInput(&in));
  }
  const std::size_t weak = in.TakeLength(kMaxWeak);
  for (std::size_t i = 0; i < weak; ++i) {
    model.boosted.weak.push_back(TakeWeak(model.boosted, &in));
  }
  model.segment_sharpness = in.Take<float>();
  model.image_sharpness = in.Take<float>();
  if (!in.at_end()) {
    throw ModelDamage("the file goes on after its end");
  }
  model.Check();
  return model;
}

}  // namespace

std::string SealSurfaceModel(std::string_view body) {
  ModelWriter header;
  header.AddAll(kMagic.data(), kMagic.size());
  header.Add(kSurfaceModelVersion);
  header.Add(Checksum(body));
  return header.Take().append(body);
}

std::string FormatSurfaceModel(const SurfaceModel& model) { return SealSurfaceModel(FormatBody(model)); }

SurfaceModel ParseSurfaceModel(std::string_view bytes, const std::filesystem::path& source) {
  if (bytes.size() < kHeaderBytes || bytes.substr(0, kMagic.size()) != kMagic) {
    throw InputError(source, "is not a model of surfaces; make one with 'train-surface --classes'");
  }
  ModelReader header(bytes.substr(kMagic.size()));
  const auto version = header.Take<std::uint32_t>();
  if (version != kSurfaceModelVersion) {
    throw InputError(source, "is a model of version " + std::to_string(version) + ", this program reads version " +
                                 std::to_string(kSurfaceModelVersion) + "; train it again");
  }
  const std::string_view body = bytes.substr(kHeaderBytes);
  if (header.Take<std::uint64_t>() != Checksum(body)) {
    throw InputError(source, "is damaged (its checksum does not fit); copy it again or train it again");
  }
  try {
    return ParseBody(body);
  } catch (const ModelDamage& damage) {
    throw InputError(source, std::string("is damaged (") + damage.what() + "); copy it again or train it again");
  } catch (const std::invalid_argument& misfit) {
    throw InputError(source, std::string("is damaged (") + misfit.what() + "); copy it again or train it again");
  }
}

SurfaceModel ReadSurfaceModel(const std::filesystem::path& file) { return ParseSurfaceModel(ReadTextFile(file), file); }

}  // namespace floorloc
