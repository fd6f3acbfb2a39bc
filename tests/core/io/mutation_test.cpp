// SPDX-License-Identifier: Apache-2.0
// A short version of the fuzzers of tests/fuzz: for any mutation of a valid input the parser reads it or throws
// InputError.
#include <exception>
#include <functional>
#include <random>

#include "core/io/camera_import.h"
#include "core/io/camera_yaml.h"
#include "core/io/image.h"
#include "core/io/survey.h"
#include "core/io/trajectory.h"
#include "tests/core/io/io_test_support.h"

namespace floorloc {
namespace {

constexpr int kMutations = 2000;

class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : rng_(seed) {}

  // One to four mutations: set a byte; remove, duplicate or replace a piece.
  std::string operator()(std::string text) {
    for (std::size_t changes = 1 + Below(4); changes > 0; --changes) {
      const std::size_t at = Below(text.size() + 1);
      const std::size_t length = Below(std::min<std::size_t>(text.size() - at, 12) + 1);
      switch (Below(4)) {
        case 0:
          text.insert(at, 1, static_cast<char>(Below(256)));
          break;
        case 1:
          text.erase(at, length);
          break;
        case 2:
          text.insert(at, text.substr(at, length));
          break;
        default:
          text.replace(at, length, HostileToken());
      }
    }
    return text;
  }

 private:
  std::size_t Below(std::size_t limit) { return std::uniform_int_distribution<std::size_t>(0, limit - 1)(rng_); }
  std::string HostileToken() {
    static const std::vector<std::string> kAll = {
        "nan",
        "-inf",
        "1e999",
        "-",
        "99999999999999999999",
        "0",
        "1e-320",
        "\n",
        "\r",
        ",",
        " ",
        ": ",
        "[",
        "{",
        "&a ",
        "*a",
        "<<: ",
        std::string(1, '\0'),
        "#",
        "!!",
        "|",
        "\xFF\xD9",
        "../",
        "/",
        "\t",
        "---",
        "%",
        "? ",
        "\xFF\xDA",
        "e",
        ".",
        "'",
        "\"",
    };
    return kAll[Below(kAll.size())];
  }

  std::mt19937_64 rng_;
};

struct Parser {
  const char* name;
  std::string valid;
  std::function<void(const std::string&)> parse;
};
std::ostream& operator<<(std::ostream& out, const Parser& parser) { return out << parser.name; }

std::string Text(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

void DecodeAnySize(const std::string& text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  const ImageHeader header = ProbeImage(bytes).value_or(ImageHeader{ImageFormat::kJpeg, 40, 30});
  if (header.width_px <= 1024 && header.height_px <= 1024) {
    DecodeGray(bytes, header.width_px, header.height_px, "mutated");
  }
}

std::vector<Parser> AllParsers() {
  return {
      {"CameraYaml", testing_io::kCameraYaml, [](const std::string& text) { ParseCameraYaml(text, "mutated"); }},
      {"Camchain",
       "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [-0.277, 0.0671, 0.000875, 0.000116]\n  distortion_model: "
       "radtan\n  intrinsics: [461.6, 460.2, 362.7, 246.0]\n  resolution: [752, 480]\n",
       [](const std::string& text) { ImportCamera(text, "mutated", {}); }},
      {"OpenCvCamera",
       "%YAML:1.0\n---\nwidth: 640\nheight: 480\nK: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ "
       "598., 0., 322., 0., 597., 238., 0., 0., 1. ]\nD: [[-0.25, 0.06, 0.0008, -0.0005, 0.01]]\n",
       [](const std::string& text) { ImportCamera(text, "mutated", {}); }},
      {"FloorYaml", testing_io::kFloorYaml, [](const std::string& text) { ParseFloorYaml(text, "mutated"); }},
      {"Tum", "# t\n1.5 1 2 3 0 0 0 1\n2.5 -1 2e0 3 0 0 1 0\n",
       [](const std::string& text) { ParseTum(text, "mutated"); }},
      {"Euroc", "#t\n10,1,2,3,1,0,0,0,5\n20,1,2,3,0,1,0,0\n",
       [](const std::string& text) { ParseEurocCsv(text, "mutated"); }},
      {"FramesCsv", "timestamp,filename\n1.5,images/a.jpg\n2.5,images/b.jpg\n",
       [](const std::string& text) { ParseFramesCsv(text, "mutated"); }},
      {"ImuCsv", "#t\n10,1,2,3,4,5,6\n20,1,2,3,4,5,6\n", [](const std::string& text) { ParseImuCsv(text, "mutated"); }},
      {"MarkersCsv", "id,x,y,yaw\n3,1,2,\n17,0,4,1.57\n",
       [](const std::string& text) { ParseMarkersCsv(text, "mutated"); }},
      {"ControlPointsCsv", "filename,u,v,x,y\na.jpg,1,2,3,4\nb.jpg,5,6,7,8\n",
       [](const std::string& text) { ParseControlPointsCsv(text, "mutated"); }},
      {"Jpeg", Text(testing_io::EncodedImage(".jpg", 40, 30)), DecodeAnySize},
      {"Png", Text(testing_io::EncodedImage(".png", 40, 30)), DecodeAnySize},
  };
}

class Mutations : public ::testing::TestWithParam<Parser> {};

TEST_P(Mutations, AreReadOrRefused) {
  const Parser& parser = GetParam();
  ASSERT_NO_THROW(parser.parse(parser.valid));
  int refused = 0;
  for (int seed = 0; seed < kMutations; ++seed) {
    const std::string text = Mutator(static_cast<std::uint64_t>(seed))(parser.valid);
    try {
      parser.parse(text);
    } catch (const InputError&) {
      ++refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "seed " << seed << ": " << error.what();
    }
  }
  EXPECT_GT(refused, kMutations / 10) << "the mutations are too tame";
}

INSTANTIATE_TEST_SUITE_P(All, Mutations, ::testing::ValuesIn(AllParsers()),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace floorloc
