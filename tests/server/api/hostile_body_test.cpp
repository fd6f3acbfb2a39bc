// SPDX-License-Identifier: Apache-2.0
#include <fstream>

#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

constexpr const char* kLocalize = "/v1/maps/hall/localize";

std::string Part(const std::string& headers, const std::string& content) {
  return "--b\r\n" + headers + "\r\n\r\n" + content + "\r\n";
}

/// A localize call whose part `request` is this text.
std::string CallWith(const std::string& request, const std::string& image) {
  return Part("Content-Type: image/jpeg\r\nContent-Disposition: form-data; name=image; filename=a.jpg", image) +
         Part("Content-Disposition: form-data; name=request", request) + "--b--\r\n";
}

/// Peak of this process's memory since the construction.
class MemoryPeak {
 public:
  MemoryPeak() { std::ofstream("/proc/self/clear_refs") << "5"; }
  std::size_t bytes() const { return Field("VmHWM:") - start_; }

 private:
  static std::size_t Field(const std::string& name) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
      if (word == name) {
        std::size_t kib = 0;
        status >> kib;
        return kib << 10;
      }
    }
    return 0;
  }

  std::size_t start_ = Field("VmRSS:");
};

class HostileBodyTest : public testing::Test {
 protected:
  HostileBodyTest() { client_.Put("/v1/vehicles/agv", VehicleBody().dump()); }
  TestServer server_;
  ContractClient client_{server_.port()};
};

TEST_F(HostileBodyTest, PartsAreReadAsDotNetSendsThem) {
  const std::string body = CallWith(R"({"vehicle":"agv"})", SharedMaps().KnownJpeg());
  for (const char* type : {"multipart/form-data; boundary=\"b\"", "Multipart/Form-Data; charset=utf-8; BOUNDARY=b"}) {
    const httplib::Response response = client_.Post(kLocalize, body, type);
    ASSERT_EQ(response.status, 200) << response.body;
    EXPECT_EQ(Json(response)["status"], "localized");
  }
  ExpectProblem(client_.Post(kLocalize, body, "multipart/form-data"), 400, "malformed_body");
  ExpectProblem(client_.Post(kLocalize, body + "--", "multipart/form-data; boundary=c"), 400, "malformed_body");
}

// Of a request, and of this client's own copies of it. The address sanitizer keeps for a while what was freed.
#if defined(__SANITIZE_ADDRESS__)  // GCC
#define FLOORLOC_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)  // clang
#define FLOORLOC_ADDRESS_SANITIZER
#endif
#endif
#ifdef FLOORLOC_ADDRESS_SANITIZER
constexpr std::size_t kMostBytes = std::size_t{160} << 20;
#else
constexpr std::size_t kMostBytes = std::size_t{64} << 20;
#endif

TEST_F(HostileBodyTest, JsonOfAnySizeCostsLittle) {
  std::string wide = "{\"a\":[0";
  while (wide.size() < (std::size_t{15} << 20)) {
    wide += ",0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0";
  }
  for (const std::string& text : {std::string(std::size_t{15} << 20, '['), wide + "]}"}) {
    const std::string body = CallWith(text, "x");
    const MemoryPeak peak;
    ExpectProblem(client_.Post(kLocalize, body, "multipart/form-data; boundary=b"), 413, "json_too_large");
    EXPECT_LT(peak.bytes(), kMostBytes);
    ExpectProblem(client_.Put("/v1/vehicles/b", text), 413, "json_too_large");
  }
  ExpectProblem(client_.Post("/v1/vehicles/agv/odometry", std::string(300'000, ' '), "application/json"), 413,
                "json_too_large");
  ExpectProblem(
      client_.Post("/v1/vehicles/agv/odometry", std::string(17, '[') + std::string(17, ']'), "application/json"), 400,
      "malformed_json");
}

TEST_F(HostileBodyTest, AKeyIsGivenOnce) {
  ExpectProblem(client_.Post("/v1/vehicles/agv/initialpose", R"({"x":1,"y":1,"yaw":0,"x":2})", "application/json"), 400,
                "malformed_json");
}

TEST_F(HostileBodyTest, IdsAreNoPaths) {
  for (const char* id : {"%2e", "%2e%2e", "a%2fb"}) {
    EXPECT_GE(client_.Put(std::string("/v1/vehicles/") + id, VehicleBody().dump()).status, 400) << id;
  }
}

}  // namespace
}  // namespace floorloc
