// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/io/input_error.h"
#include "core/surface/classes/model_file.h"
#include "mapbuilder/surface/class_training.h"
#include "mapbuilder/surface/labelled_picture.h"
#include "mapbuilder/surface/look_alike_folds.h"
#include "mapbuilder/surface/picture_folder.h"
#include "tests/synthetic/temporary_folder.h"

namespace floorloc {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// Coarse or fine noise, of any colour and brightness.
cv::Mat Picture(bool coarse, std::uint64_t seed, cv::Size size = {96, 72}) {
  cv::RNG random(seed);
  cv::Mat noise(size, CV_8UC3);
  random.fill(noise, cv::RNG::UNIFORM, 0, 120);
  if (coarse) {
    cv::GaussianBlur(noise, noise, {}, 4.0);
    noise = (noise - cv::Scalar::all(50)) * 4;
  }
  return noise + cv::Scalar(random.uniform(0, 90), random.uniform(0, 90), random.uniform(0, 90));
}

class SurfaceTraining : public testing::Test {
 protected:
  fs::path Add(const std::string& name, const cv::Mat& image) {
    fs::path file = folder_.path() / name;
    fs::create_directories(file.parent_path());
    cv::imwrite(file.string(), image);
    return file;
  }
  void AddClasses(int pictures) {
    for (int i = 0; i < pictures; ++i) {
      Add("fine/" + std::to_string(i) + ".png", Picture(false, static_cast<std::uint64_t>(i)));
      Add("coarse/" + std::to_string(i) + ".png", Picture(true, 100U + static_cast<std::uint64_t>(i)));
    }
  }
  std::string Refusal(const std::function<void()>& work) const {
    try {
      work();
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
  std::string RefusalOfClasses() const {
    return Refusal([this] { ListClasses(folder_.path()); });
  }

  TemporaryFolder folder_;
};

ClassTrainingOptions Quick() {
  ClassTrainingOptions options;
  options.boosting.rounds = 6;
  options.boosting.weak_samples = 40;
  options.segments_per_picture = 2;
  options.folds.folds = 2;
  options.folds.pictures_per_group = 1;
  options.grid.c = {1.0, 10.0};
  options.grid.gamma = {1.0};
  options.grid_rounds = 2;
  options.run.threads = 1;
  return options;
}

TEST_F(SurfaceTraining, LearnsToTellTexturesOfAnyColour) {
  AddClasses(8);
  const TrainedClasses trained = TrainClasses(ListClasses(folder_.path()), Quick());
  EXPECT_THAT(trained.model.classes, testing::ElementsAre("coarse", "fine"));
  EXPECT_GE(trained.report.held_out.RightShare(), 0.75) << "of 16 pictures";
  const SurfaceClassifier classifier(trained.model);
  for (std::uint64_t seed = 500; seed < 505; ++seed) {
    SurfaceImage image;
    image.color = Picture(seed % 2 == 0, seed);
    EXPECT_EQ(classifier.Classify(image).label, seed % 2 == 0 ? 0 : 1) << seed;
  }
}

TEST_F(SurfaceTraining, GivesTheSameModelTwiceAndForAnyNumberOfThreads) {
  AddClasses(4);
  ClassTrainingOptions options = Quick();
  const std::string once = FormatSurfaceModel(TrainClasses(ListClasses(folder_.path()), options).model);
  options.run.threads = 2;
  EXPECT_EQ(FormatSurfaceModel(TrainClasses(ListClasses(folder_.path()), options).model), once);
}

TEST_F(SurfaceTraining, TakesPicturesOfDifferentSizesAndDepthWithHoles) {
  for (const char* name : {"fine", "coarse"}) {
    const bool coarse = std::string(name) == "coarse";
    for (int i = 0; i < 3; ++i) {
      const std::string number = std::to_string(i);
      const cv::Size size(80 + 16 * i, 60);
      Add(name + ("/" + number) + ".png", Picture(coarse, static_cast<std::uint64_t>(i), size));
      cv::Mat depth(size, CV_16UC1, cv::Scalar(coarse ? 900 : 1400));
      depth(cv::Rect(0, 0, 40, 30)).setTo(0);
      Add(name + ("/depth/" + number) + ".png", depth);
      Add(name + ("/intensity/" + number) + ".png", cv::Mat(size, CV_16UC1, cv::Scalar(coarse ? 30 : 60)));
    }
  }
  const LabelledFolder folder = ListClasses(folder_.path());
  EXPECT_TRUE(folder.has_range());
  const TrainedClasses trained = TrainClasses(folder, Quick());
  EXPECT_EQ(trained.model.features.max_intensity, 61.0F);
  EXPECT_EQ(trained.report.inputs.size(), DefaultGroups().size());
}

TEST_F(SurfaceTraining, SaysWhatIsWrongWithAFolder) {
  EXPECT_THAT(RefusalOfClasses(), HasSubstr("has no folders of pictures; put the pictures of each class"));
  Add("wood/1.png", Picture(false, 1));
  Add("wood/2.png", Picture(false, 2));
  EXPECT_THAT(RefusalOfClasses(), HasSubstr("has one class only (wood)"));
  Add("tiles/1.png", Picture(false, 3));
  EXPECT_THAT(RefusalOfClasses(), AllOf(HasSubstr("tiles"), HasSubstr("has one picture only")));
  Add("tiles/2.png", Picture(false, 4));
  EXPECT_EQ(RefusalOfClasses(), "");
  fs::create_directories(folder_.path() / "wood/depth");
  EXPECT_THAT(RefusalOfClasses(), HasSubstr("has depth/ without intensity/"));
  fs::create_directories(folder_.path() / "wood/intensity");
  EXPECT_THAT(RefusalOfClasses(), AllOf(HasSubstr("tiles"), HasSubstr("has no depth/ and intensity/ while")));
  fs::create_directories(folder_.path() / "empty");
  EXPECT_THAT(RefusalOfClasses(), AllOf(HasSubstr("empty"), HasSubstr("has no JPEG or PNG pictures")));
  EXPECT_THAT(Refusal([this] { ListClasses(folder_.path() / "nowhere"); }), HasSubstr("cannot be read as a folder"));
}

TEST_F(SurfaceTraining, SaysWhatIsWrongWithAPicture) {
  const fs::path picture = Add("images/1.png", Picture(false, 1));
  const fs::path depth = folder_.path() / "depth/1.png";
  const auto refusal = [&] { return Refusal([&] { ReadPicture(ListPictures(folder_.path()), picture); }); };
  EXPECT_EQ(refusal(), "");
  Add("intensity/1.png", cv::Mat(72, 96, CV_8UC1, cv::Scalar(3)));
  fs::create_directories(depth.parent_path());
  EXPECT_THAT(refusal(), HasSubstr("depth/1.png: cannot be opened"));
  Add("depth/1.png", cv::Mat(72, 96, CV_8UC1, cv::Scalar(3)));
  EXPECT_THAT(refusal(), HasSubstr("has 8 bits per value; depth must be a grey PNG of 16 bits"));
  Add("depth/1.png", cv::Mat(36, 48, CV_16UC1, cv::Scalar(3)));
  EXPECT_THAT(refusal(), HasSubstr("is 48x36, its picture is 96x72; register it"));
  Add("depth/1.png", cv::Mat(72, 96, CV_16UC3, cv::Scalar(3, 4, 5)));
  EXPECT_THAT(refusal(), HasSubstr("has colours"));
  Add("depth/1.png", cv::Mat(72, 96, CV_16UC1, cv::Scalar(3)));
  EXPECT_EQ(refusal(), "");
  std::ofstream(picture) << "no image";
  EXPECT_THAT(refusal(), HasSubstr("is not a JPEG or PNG image"));
}

TEST_F(SurfaceTraining, OrdersPicturesByTheirNumbers) {
  for (const char* name : {"a10.png", "a9.png", "a010.jpg", "b.png"}) {
    Add(name, Picture(false, 1));
  }
  std::vector<std::string> names;
  for (const fs::path& picture : ListPictures(folder_.path()).pictures) {
    names.push_back(picture.filename().string());
  }
  EXPECT_THAT(names, testing::ElementsAre("b.png", "a9.png", "a010.jpg", "a10.png"));
}

TEST(LookAlikeFolds, KeepLookAlikesTogetherAndFoldsEven) {
  std::vector<std::vector<float>> looks;
  std::vector<int> labels;
  for (int i = 0; i < 80; ++i) {  // 20 rooms of 4 pictures, 10 of each class
    const auto room = static_cast<float>(i % 20);
    const int picture = i / 20;
    looks.push_back({room * room, 0.01F * static_cast<float>(picture)});
    labels.push_back(i % 20 < 10 ? 0 : 1);
  }
  FoldOptions options;
  options.pictures_per_group = 4;
  const std::vector<int> folds = LookAlikeFolds(looks, labels, options);
  std::vector<int> sizes(5, 0);
  for (int i = 0; i < 80; ++i) {
    EXPECT_EQ(folds[static_cast<std::size_t>(i)], folds[static_cast<std::size_t>(i % 20)]) << i;
    ++sizes[static_cast<std::size_t>(folds[static_cast<std::size_t>(i)])];
  }
  EXPECT_THAT(sizes, testing::Each(testing::AllOf(testing::Ge(12), testing::Le(20))));
}

TEST(LookAlikeFolds, TakeFewPicturesThatAllLookTheSame) {
  const std::vector<std::vector<float>> looks(4, {1.0F, 2.0F});
  const std::vector<int> labels = {0, 0, 1, 1};
  EXPECT_EQ(LookAlikeFolds(looks, labels, FoldOptions()).size(), 4U);
}

TEST(LabelledPicture, TintsByClass) {
  const cv::Mat picture(400, 400, CV_8UC3, cv::Scalar::all(100));
  cv::Mat classes = cv::Mat::zeros(40, 40, CV_32SC1);
  classes.colRange(20, 40).setTo(1);
  const cv::Mat tinted = TintByClass(picture, classes, {"a", "b"});
  const auto& left = tinted.at<cv::Vec3b>(390, 10);
  const auto& right = tinted.at<cv::Vec3b>(390, 390);
  EXPECT_NE(left, right);
  EXPECT_NEAR(left[1], 0.55 * 100 + 0.45 * ClassColor(0)[1], 1.0);
}

}  // namespace
}  // namespace floorloc
