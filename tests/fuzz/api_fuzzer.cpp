// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "server/api/app.h"
#include "tests/fuzz/byte_source.h"
#include "tests/fuzz/small_map.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

constexpr int kMaxCalls = 8;

ServerConfig SmallConfig() {
  spdlog::set_level(spdlog::level::off);
  ServerConfig config;
  config.threads = 1;
  config.limits.max_image_pixels = 100'000;
  config.limits.max_rectifier_bytes = std::size_t{16} << 20;
  config.queue_timeout_s = 60.0;
  return config;
}

/// A folder with the map "hall", and an image of its floor.
struct Hall {
  Hall() {
    const TemporaryFolder survey;
    WriteSmallSurvey(survey.path(), 0.4, 6);
    WriteSmallMap(survey.path(), maps.path() / "hall.floormap");
    std::vector<std::uint8_t> bytes;
    cv::imencode(".png", SmallImage(0.5, 0.5), bytes);
    image.assign(bytes.begin(), bytes.end());
  }
  TemporaryFolder maps;
  std::string image;
};

// A call: "METHOD PATH", a zero byte, a byte with its form, then texts that end with a zero byte: names and values of
// the query (bits 4 and 5 say how many), the body.
HttpRequest TakeCall(const std::string& image, ByteSource& source) {
  HttpRequest request;
  const std::string line = source.Text();
  const std::size_t space = std::min(line.find(' '), line.size());
  request.method = line.substr(0, space);
  request.path = line.substr(std::min(space + 1, line.size()));
  const unsigned form = source.Byte();
  for (unsigned i = 0; i < (form >> 4U & 3U); ++i) {
    const std::string name = source.Text();
    request.query.emplace(name, source.Text());
  }
  const std::string body = source.Text();
  const bool is_image = (form & 1U) != 0;
  if ((form & 2U) != 0) {
    request.headers["content-type"] = "multipart/form-data; boundary=x";
    request.parts = {{"request", "application/json", body}, {"image", "image/png", is_image ? image : body}};
  } else {
    request.headers["content-type"] = is_image ? "image/png" : "application/json";
    request.body = is_image ? image : body;
  }
  return request;
}

}  // namespace
}  // namespace floorloc

// A few calls in a row of a server that has just been started: whatever they say, none fails by an error of the
// server's own.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace floorloc;
  static const Hall hall;
  App app(SmallConfig(), hall.maps.path());
  ByteSource source({data, size});
  for (int i = 0; i < kMaxCalls && !source.empty(); ++i) {
    const HttpRequest request = TakeCall(hall.image, source);
    if (!app.router().Admit(request) && app.router().Handle(request).status == 500) {
      std::abort();
    }
  }
  return 0;
}
