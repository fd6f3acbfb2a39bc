// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/check.h"

#include <fstream>
#include <sstream>

#include "server/http/listener.h"
#include "tests/server/fixture/server_fixture.h"

namespace floorloc {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Checked {
  int exit_code = 0;
  std::string text;
};

class CheckTest : public testing::Test {
 protected:
  CheckTest() {
    std::filesystem::create_directory(maps_);
    std::filesystem::copy_file(SharedMaps().folder() / "hall.floormap", maps_ / "hall.floormap");
    options_.maps_folder = maps_;
    options_.listen = "127.0.0.1:0";
  }
  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path() / name) << text;
    std::filesystem::permissions(folder_.path() / name, std::filesystem::perms::owner_read);
  }
  void Configure(const std::string& text) {
    Write("server.json", text);
    options_.config_file = folder_.path() / "server.json";
  }
  Checked Check() const {
    std::ostringstream out;
    const int exit_code = CheckDeployment(options_, out);
    return {exit_code, out.str()};
  }

  TemporaryFolder folder_;
  const std::filesystem::path maps_ = folder_.path() / "maps";
  DaemonOptions options_;
};

TEST_F(CheckTest, SaysWhatWouldBeServed) {
  const Checked good = Check();
  EXPECT_EQ(good.exit_code, 0) << good.text;
  for (const char* line :
       {"ok      configuration: the defaults\n", "note    tokens: none", "ok      address: 127.0.0.1:0 can be used\n",
        "ok      hall: version ", "every byte verified", "ready to serve\n"}) {
    EXPECT_THAT(good.text, HasSubstr(line));
  }
  EXPECT_THAT(good.text, Not(HasSubstr("FAILED")));
}

TEST_F(CheckTest, NamesEverythingThatWouldFailAndGoesOn) {
  Configure(R"({"token_file": "tokens", "threads": 2})");
  std::ofstream(maps_ / "broken.floormap") << "no map";
  std::filesystem::copy_file(maps_ / "hall.floormap", maps_ / "a name.floormap");
  const Checked bad = Check();
  EXPECT_EQ(bad.exit_code, 1);
  for (const char* line : {"ok      configuration: ", "FAILED  tokens: ", "FAILED  broken: not served: ",
                           "ok      hall: version ", "FAILED  a name.floormap: not served: ", "not ready"}) {
    EXPECT_THAT(bad.text, HasSubstr(line));
  }
}

TEST_F(CheckTest, CountsTokensAndShowsNone) {
  Configure(R"({"token_file": "tokens"})");
  const std::string digits(63, '0');
  Write("tokens", "v vehicle " + digits + "1 a\nw vehicle " + digits + "2 b\no operator " + digits + "3\n");
  const Checked good = Check();
  EXPECT_EQ(good.exit_code, 0) << good.text;
  EXPECT_THAT(good.text, HasSubstr("ok      tokens: 3 (vehicle 2, operator 1, admin 0)\n"));
  EXPECT_THAT(good.text, Not(HasSubstr(digits)));
}

TEST_F(CheckTest, AByteThatIsNotAsItWasBuiltIsFound) {
  // In the middle of a JPEG of the mosaic, which is verified only when it is asked for.
  std::fstream file(maps_ / "hall.floormap", std::ios::binary | std::ios::in | std::ios::out);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::size_t jpeg = bytes.rfind("\xFF\xD8\xFF\xE0");
  ASSERT_NE(jpeg, std::string::npos);
  file.seekp(static_cast<std::streamoff>(jpeg + 300));
  file.put(static_cast<char>(bytes[jpeg + 300] ^ 1));
  file.close();
  const Checked bad = Check();
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.text, HasSubstr("FAILED  hall: ")) << bad.text;
}

TEST_F(CheckTest, ABadConfigurationIsNoReasonToSkipTheMaps) {
  Configure(R"({"thread": 2})");
  options_.listen = "0.0.0.0:0";
  const Checked bad = Check();
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.text, testing::AllOf(HasSubstr("FAILED  configuration: "), HasSubstr("thread is not a known key"),
                                       Not(HasSubstr("tokens"))));
  EXPECT_THAT(bad.text, HasSubstr("ok      hall: version "));
}

TEST_F(CheckTest, ContradictingOptionsAreWrongUsage) {
  options_.listen = "0.0.0.0:0";
  const Checked open = Check();
  EXPECT_EQ(open.exit_code, 2);
  EXPECT_THAT(open.text, HasSubstr("no token is set"));
  options_.listen = "nonsense";
  EXPECT_THROW(Check(), std::invalid_argument);
}

TEST_F(CheckTest, APortInUseIsANote) {
  const Listener taken = Listen("127.0.0.1", 0);
  options_.listen = "127.0.0.1:" + std::to_string(taken.port);
  const Checked busy = Check();
  EXPECT_EQ(busy.exit_code, 0) << busy.text;
  EXPECT_THAT(busy.text, HasSubstr("is in use"));
  options_.listen = "192.0.2.1:0";  // of documentation, no address of any machine
  Configure(R"({"open": true})");
  const Checked foreign = Check();
  EXPECT_EQ(foreign.exit_code, 1);
  EXPECT_THAT(foreign.text, HasSubstr("FAILED  address: "));
}

TEST_F(CheckTest, AnEmptyFolderServesNothing) {
  std::filesystem::remove(maps_ / "hall.floormap");
  const Checked empty = Check();
  EXPECT_EQ(empty.exit_code, 1);
  EXPECT_THAT(empty.text, HasSubstr("no NAME.floormap"));
}

}  // namespace
}  // namespace floorloc
