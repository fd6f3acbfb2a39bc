// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "core/io/floor_picture.h"
#include "core/io/input_error.h"
#include "core/io/text_file.h"
#include "core/surface/classes/model_file.h"
#include "mapbuilder/batch/parallel.h"
#include "mapbuilder/batch/progress.h"
#include "mapbuilder/cli/classify_texture.h"
#include "mapbuilder/cli/command.h"
#include "mapbuilder/surface/labelled_picture.h"
#include "mapbuilder/surface/picture_folder.h"
#include "mapbuilder/surface/texture_training.h"

namespace floorloc {
namespace {

// Raw command line arguments.
struct Arguments {
  std::filesystem::path model;
  std::filesystem::path images;
  std::filesystem::path results;
  std::filesystem::path out;
  int threads = 0;
};

double Rounded(double value) { return std::round(value * 1e4) / 1e4; }

std::string ToLine(const std::string& filename, const SurfaceModel& model, const SurfaceResult& result) {
  const auto name = [&](int label) { return model.classes[static_cast<std::size_t>(label)]; };
  nlohmann::ordered_json segments = nlohmann::json::array();
  for (const SegmentClass& segment : result.segments) {
    segments.push_back({{"class", name(segment.label)},
                        {"score", Rounded(segment.score)},
                        {"share", Rounded(segment.pixels / static_cast<double>(result.segment_of_pixel.total()))},
                        {"box", {segment.box.x, segment.box.y, segment.box.width, segment.box.height}}});
  }
  const nlohmann::ordered_json line{
      {"filename", filename}, {"class", name(result.label)}, {"score", Rounded(result.score)}, {"segments", segments}};
  return line.dump() + "\n";
}

// Labelled pictures are JPEGs: "5.jpg" and "5.png.jpg".
std::filesystem::path LabelledName(const std::filesystem::path& picture) {
  std::filesystem::path name = picture.filename();
  return name.extension() == ".jpg" ? name : name += ".jpg";
}

void CreateOutFolder(const Arguments& a) {
  std::error_code error;
  std::filesystem::create_directories(a.out, error);
  CheckWritable(a.out / "labelled.jpg");
  for (const std::filesystem::path& source : {a.images, a.images / "images"}) {
    if (std::filesystem::equivalent(a.out, source, error)) {
      throw InputError(a.out, "is the folder of the pictures, which would be replaced; name another");
    }
  }
}

void WriteLabelled(const std::filesystem::path& file, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", picture, bytes);
  WriteFileAtomically(file, std::string(bytes.begin(), bytes.end()));
}

// Writes the tinted picture if it is wanted, and returns the line of JSON.
using ClassifyPicture = std::function<std::string(const std::filesystem::path& picture)>;

ClassifyPicture ByTexture(const Arguments& a) {
  std::vector<std::string> names;
  for (const TextureClass texture : kTextureClasses) {
    names.emplace_back(ToString(texture));
  }
  return [&a, names, classifier = ReadTextureModel(a.model)](const std::filesystem::path& picture) {
    const cv::Mat image = ReadPictureOfAnySize(picture);
    const TextureResult result = ClassifyTexture(image, picture.filename().string(), classifier);
    if (!a.out.empty()) {
      WriteLabelled(a.out / LabelledName(picture), TintByClass(image, result.class_of_block, names));
    }
    return result.line;
  };
}

ClassifyPicture BySurface(const Arguments& a, const PictureFolder& folder) {
  const auto classifier = std::make_shared<SurfaceClassifier>(ReadSurfaceModel(a.model));
  return [&a, &folder, classifier](const std::filesystem::path& picture) {
    const SurfaceImage image = ReadPicture(folder, picture);
    const SurfaceResult result = classifier->Classify(image);
    if (!a.out.empty()) {
      WriteLabelled(a.out / LabelledName(picture),
                    TintByClass(image.color, ClassOfPixel(result), classifier->model().classes));
    }
    return ToLine(picture.filename().string(), classifier->model(), result);
  };
}

void Run(const Arguments& a) {
  PictureFolder folder;
  const ClassifyPicture classify = IsTextureModel(a.model) ? ByTexture(a) : BySurface(a, folder);
  folder = ListPictures(a.images);
  if (!a.results.empty()) {
    CheckWritable(a.results);
  }
  if (!a.out.empty()) {
    CreateOutFolder(a);
  }
  std::vector<std::string> lines(folder.pictures.size());
  ProgressBar progress("classifying", static_cast<std::int64_t>(lines.size()), ProgressOutput::Stderr());
  ParallelFor(static_cast<int>(lines.size()), a.threads, [&](int i) {
    lines[static_cast<std::size_t>(i)] = classify(folder.pictures[static_cast<std::size_t>(i)]);
    progress.Advance();
  });
  std::string text;
  for (const std::string& line : lines) {
    text += line;
  }
  if (a.results.empty()) {
    std::cout << text;
  } else {
    WriteFileAtomically(a.results, text);
  }
}

}  // namespace

void AddClassifyCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("classify", "Says what floor pictures show, as a whole and in parts");
  const auto a = std::make_shared<Arguments>();
  command->add_option("--model", a->model, "Made by 'train-surface'")->required();
  command
      ->add_option("--images", a->images,
                   "Folder of pictures, or with images/; depth/ and intensity/ beside them if there is a range sensor")
      ->required();
  command->add_option("--results", a->results, "Write one JSON line per picture there; default: print them");
  command->add_option("--out", a->out, "Write pictures tinted by class there");
  command->add_option("--threads", a->threads, "Number of threads; 0: one per core")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
