// SPDX-License-Identifier: Apache-2.0
#include "core/surface/classes/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/io/input_error.h"
#include "tests/core/surface/classes/model_test_support.h"

namespace floorloc {
namespace {

using testing::HasSubstr;

std::string RefusalOf(const std::string& bytes) {
  try {
    ParseSurfaceModel(bytes, "m.model");
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(ModelFile, KeepsTheModel) {
  SurfaceModel model = DarkOrBright();
  model.segmentation.k = 123.0;
  model.features.max_intensity = 4500.0F;
  model.image_sharpness = 2.5F;
  const std::string bytes = FormatSurfaceModel(model);
  const SurfaceModel read = ParseSurfaceModel(bytes, "m.model");
  EXPECT_EQ(read.classes, model.classes);
  EXPECT_EQ(read.segmentation.k, 123.0);
  EXPECT_EQ(read.boosted.weak.front().svm.weights, model.boosted.weak.front().svm.weights);
  EXPECT_EQ(FormatSurfaceModel(read), bytes);
}

TEST(ModelFile, RefusesWhatIsNoModel) {
  EXPECT_THAT(RefusalOf(""), HasSubstr("is not a model of surfaces; make one with 'train-surface --classes'"));
  EXPECT_THAT(RefusalOf(std::string(100, 'x')), HasSubstr("is not a model of surfaces"));
}

TEST(ModelFile, RefusesOtherVersions) {
  std::string bytes = FormatSurfaceModel(DarkOrBright());
  bytes[8] = 9;
  EXPECT_THAT(RefusalOf(bytes), HasSubstr("is a model of version 9, this program reads version 1; train it again"));
}

TEST(ModelFile, RefusesEveryCutAndEveryChangedByte) {
  const std::string bytes = FormatSurfaceModel(DarkOrBright());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    EXPECT_NE(RefusalOf(bytes.substr(0, i)), "") << i;
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0x20);
    EXPECT_NE(RefusalOf(changed), "") << i;
  }
}

TEST(ModelFile, RefusesWhatAChecksumDoesNotProtectFrom) {
  const std::string body = FormatSurfaceModel(DarkOrBright()).substr(20);
  EXPECT_THAT(RefusalOf(SealSurfaceModel(body + "x")), HasSubstr("goes on after its end"));
  EXPECT_THAT(RefusalOf(SealSurfaceModel(body.substr(0, 40))), HasSubstr("ends too early"));
  std::string many = body;
  many.replace(0, 4, "\xff\xff\xff\xff");
  EXPECT_THAT(RefusalOf(SealSurfaceModel(many)), HasSubstr("a list is too long"));
}

}  // namespace
}  // namespace floorloc
