// SPDX-License-Identifier: Apache-2.0
#include "core/diagnosis/diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace floorloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr int kFrames = 60;

std::int64_t At(double seconds) { return 1'700'000'000'000'000'000 + std::llround(1e9 * seconds); }

// Turns right and left: 0.8 m/s and up to 0.9 rad/s.
Pose2 TruthAt(double seconds) { return {0.8 * seconds, 0.1 * std::sin(seconds), 0.9 * std::sin(seconds)}; }

// A drive of 12 s with 5 images and 20 odometry messages per second, of which a tracker finds nothing wrong.
class DiagnosisTest : public ::testing::Test {
 protected:
  DiagnosisTest() {
    camera_.estimate.status = CameraStatus::kAsCalibrated;
    camera_.view_m = 0.5;
    for (int i = 0; i < kFrames; ++i) {
      const double seconds = 0.2 * i;
      frames_.push_back({At(seconds), LocalizationStatus::kLocalized, NotLocalizedReason::kNone, TruthAt(seconds),
                         TruthAt(seconds), OdometryTrust{OdometryHealth::kOk, OdometryFault::kNone, 1.01, 0.99, 0.0}});
    }
    for (int i = 0; i <= 240; ++i) {
      odometry_ns_.push_back(At(0.05 * i));
    }
  }

  // As they arrive: an image after the odometry of its time.
  DriveRecord Record() const {
    DriveRecord record;
    std::size_t sent = 0;
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      for (; sent < odometry_ns_.size() * (i + 1) / frames_.size(); ++sent) {
        record.AddOdometry(odometry_ns_[sent]);
      }
      record.AddFrame(frames_[i]);
    }
    return record;
  }

  std::vector<Finding> Findings() const { return Diagnose(Record(), camera_, gyro_); }
  // The worst finding about a part.
  Finding About(const std::string& about) const {
    Finding worst{"", FindingStatus::kOk, "nothing", ""};
    for (const Finding& finding : Findings()) {
      if (finding.about == about && (worst.about.empty() || finding.status > worst.status)) {
        worst = finding;
      }
    }
    return worst;
  }
  void Expect(const std::string& about, FindingStatus status, const std::string& text) const {
    const Finding finding = About(about);
    EXPECT_EQ(finding.status, status) << finding.sentence;
    EXPECT_THAT(finding.sentence + " -> " + finding.cure, HasSubstr(text));
  }
  void ForFrames(std::size_t first, std::size_t last, const std::function<void(RecordedFrame&)>& change) {
    for (std::size_t i = first; i < last; ++i) {
      change(frames_[i]);
    }
  }
  void Lose(std::size_t first, std::size_t last, NotLocalizedReason reason) {
    ForFrames(first, last, [reason](RecordedFrame& frame) {
      frame.status = LocalizationStatus::kNotLocalized;
      frame.reason = reason;
    });
  }

  std::vector<RecordedFrame> frames_;
  std::vector<std::int64_t> odometry_ns_;
  ObservedCamera camera_;
  std::optional<GyroFit> gyro_ = GyroFit{1.0, 0.005, 5.0};
};

TEST_F(DiagnosisTest, ARobotThatIsWiredRightPasses) {
  const std::vector<Finding> findings = Findings();
  for (const Finding& finding : findings) {
    EXPECT_EQ(finding.status, FindingStatus::kOk) << finding.sentence;
    EXPECT_EQ(finding.cure, "") << finding.sentence;
  }
  EXPECT_EQ(findings.size(), 6U);
  EXPECT_EQ(WorstOf(findings), FindingStatus::kOk);
}

TEST_F(DiagnosisTest, NothingIsKnownBeforeTheFirstMetres) {
  frames_.resize(3);
  ForFrames(0, 3, [](RecordedFrame& frame) { frame.odometry = OdometryTrust(); });
  odometry_ns_.resize(12);
  camera_.estimate.status = CameraStatus::kLearning;
  gyro_ = GyroFit();
  for (const char* about : {"floor", "camera", "odometry", "clock", "gyro"}) {
    Expect(about, FindingStatus::kUnknown, "");
  }
  EXPECT_EQ(WorstOf(Findings()), FindingStatus::kUnknown);
}

TEST_F(DiagnosisTest, AnEmptyRecordIsUnknown) {
  frames_.clear();
  odometry_ns_.clear();
  Expect("floor", FindingStatus::kUnknown, "0 of 0 images");
  Expect("images", FindingStatus::kUnknown, "");
  Expect("odometry", FindingStatus::kNote, "there is no odometry");
}

TEST_F(DiagnosisTest, ImagesOfAnotherFloorAreNamed) {
  Lose(0, 55, NotLocalizedReason::kTooFewInliers);
  Expect("floor", FindingStatus::kWrong, "5 of 60 images were found in the map -> they do not match the map");
}

TEST_F(DiagnosisTest, TheMostFrequentReasonIsNamed) {
  Lose(0, 20, NotLocalizedReason::kTooFewKeypoints);
  Expect("floor", FindingStatus::kNote, "too little structure");
  Lose(5, 20, NotLocalizedReason::kViewDisagrees);
  Expect("floor", FindingStatus::kNote, "mask what is no floor");
  Lose(5, 20, NotLocalizedReason::kNoFloor);
  Expect("floor", FindingStatus::kNote, "they show no floor");
  Lose(5, 20, NotLocalizedReason::kOtherFloor);
  Expect("floor", FindingStatus::kNote, "looks different from the map's");
  ForFrames(0, 20, [](RecordedFrame& frame) { frame.status = LocalizationStatus::kAmbiguous; });
  Expect("floor", FindingStatus::kNote, "several places of the floor look alike");
}

// The second half of the drive is twice as fast as the first one.
TEST_F(DiagnosisTest, ImagesThatAreLostWhenDrivingFastAreBlurred) {
  ForFrames(30, 60, [](RecordedFrame& frame) {
    frame.odom_from_base = Pose2(2.0 * frame.odom_from_base->x() - TruthAt(5.8).x(), 0.0, 0.0);
  });
  const std::vector<RecordedFrame> found = frames_;
  Lose(0, 20, NotLocalizedReason::kTooFewKeypoints);
  Expect("floor", FindingStatus::kNote, "too little structure");
  frames_ = found;
  Lose(40, 60, NotLocalizedReason::kTooFewKeypoints);
  Expect("floor", FindingStatus::kNote, "shorten the exposure");
}

TEST_F(DiagnosisTest, ImagesFarApartMatterWithoutOdometryThatAgrees) {
  camera_.view_m = 0.2;
  Expect("images", FindingStatus::kOk, "images are up to 0.1");
  ForFrames(0, 60, [](RecordedFrame& frame) { frame.odometry->health = OdometryHealth::kRejected; });
  Expect("images", FindingStatus::kNote, "at 5.0 per second, a view is 0.20 m wide");
}

TEST_F(DiagnosisTest, ABumpedCameraIsNamed) {
  camera_.estimate.errors.mean(0) = 0.0175;
  camera_.estimate.status = CameraStatus::kCorrected;
  Expect("camera", FindingStatus::kNote, "roll +1.00");
  camera_.estimate.status = CameraStatus::kImplausible;
  Expect("camera", FindingStatus::kWrong, "calibrate and mount it anew");
}

TEST_F(DiagnosisTest, AFaultOfTheWheelsIsNamedWithItsCureAtOnce) {
  const auto reverse = [](RecordedFrame& frame) {
    frame.odometry = OdometryTrust{OdometryHealth::kRejected, OdometryFault::kReversed, -1.0, 1.0, 0.0};
  };
  ForFrames(59, 60, reverse);
  Expect("odometry", FindingStatus::kWrong, "change the sign of dx and dy");
  ForFrames(20, 60, reverse);
  Expect("odometry", FindingStatus::kWrong,
         "odometry contradicted 40 of 60 images (reversed): distances to be multiplied by -1.000, turns by 1.000");
}

TEST_F(DiagnosisTest, ASlipIsANote) {
  ForFrames(20, 26, [](RecordedFrame& frame) { frame.odometry->fault = OdometryFault::kInconsistent; });
  Expect("odometry", FindingStatus::kNote, "contradicted 6 of 60 images (inconsistent) and was not used there");
}

TEST_F(DiagnosisTest, WheelsThatAreALittleOffAreANote) {
  ForFrames(0, 60, [](RecordedFrame& frame) { frame.odometry->scale = 1.05; });
  Expect("odometry", FindingStatus::kNote, "distances to be multiplied by 1.050");
}

TEST_F(DiagnosisTest, OtherClocksAreNamed) {
  ForFrames(0, 60, [](RecordedFrame& frame) { frame.odometry->time_offset_s = 0.096; });
  Expect("clock", FindingStatus::kNote, "odometry is stamped 96 ms later than the images");
}

TEST_F(DiagnosisTest, AnotherEpochIsNamedWithBothRanges) {
  for (std::int64_t& stamp_ns : odometry_ns_) {
    stamp_ns -= At(-40.0);
  }
  const Finding clock = About("clock");
  EXPECT_EQ(clock.status, FindingStatus::kWrong);
  EXPECT_THAT(clock.sentence, AllOf(HasSubstr("1700000000.0"), HasSubstr("odometry from 40.0 to 52.0 s")));
  EXPECT_THAT(clock.cure, HasSubstr("Unix time"));
  Expect("odometry", FindingStatus::kUnknown, "before its stamps are right");
}

TEST_F(DiagnosisTest, AClockThatIsSetBackIsNamed) {
  for (std::size_t i = 100; i < odometry_ns_.size(); ++i) {
    odometry_ns_[i] -= std::llround(30e9);
  }
  Expect("clock", FindingStatus::kWrong,
         "1 of 241 odometry messages are not later than the one before, by up to 29.9 s");
}

TEST_F(DiagnosisTest, ACameraWhoseClockIsSetBackIsNamed) {
  ForFrames(30, 60, [](RecordedFrame& frame) { frame.stamp_ns -= std::llround(30e9); });
  Expect("clock", FindingStatus::kWrong, "1 of 60 images are not later than the one before, by up to 29.8 s");
}

TEST_F(DiagnosisTest, TwoSendersOfOneNameAreNamed) {
  for (std::size_t i = 1; i < odometry_ns_.size(); i += 2) {
    odometry_ns_[i] -= std::llround(0.2e9);
  }
  Expect("clock", FindingStatus::kWrong, "two senders use one name");
}

// Swapped on the network.
TEST_F(DiagnosisTest, SomeMessagesMaySwap) {
  std::swap(odometry_ns_[50], odometry_ns_[51]);
  Expect("clock", FindingStatus::kOk, "");
}

TEST_F(DiagnosisTest, MillisecondsAreNamed) {
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    frames_[i].stamp_ns = std::llround(200e9 * static_cast<double>(i));
  }
  for (std::size_t i = 0; i < odometry_ns_.size(); ++i) {
    odometry_ns_[i] = std::llround(50e9 * static_cast<double>(i));
  }
  Expect("clock", FindingStatus::kWrong, "odometry is stamped every 50.0 s -> stamps are in seconds");
}

TEST_F(DiagnosisTest, GapsAndSlowOdometryAreNamed) {
  odometry_ns_.erase(odometry_ns_.begin() + 100, odometry_ns_.begin() + 130);
  Expect("odometry", FindingStatus::kNote, "odometry comes every 0.05 s, with a gap of 1.6 s");
  odometry_ns_.clear();
  for (int i = 0; i < 12; ++i) {
    odometry_ns_.push_back(At(i));
  }
  Expect("odometry", FindingStatus::kNote, "odometry comes every 1.0 s only");
}

TEST_F(DiagnosisTest, OdometryThatStopsIsNamedAndNotItsClock) {
  DriveRecord record;
  for (const std::int64_t stamp_ns : odometry_ns_) {
    record.AddOdometry(stamp_ns - std::llround(60e9));
  }
  for (const RecordedFrame& frame : frames_) {
    record.AddFrame(frame);
  }
  std::vector<std::string> notes;
  for (const Finding& finding : Diagnose(record, camera_, gyro_)) {
    if (finding.status != FindingStatus::kOk) {
      notes.push_back(finding.about + ": " + finding.sentence);
    }
  }
  EXPECT_THAT(notes, ::testing::ElementsAre("odometry: no odometry came with the last 60 images"));
}

// A client that sends by stamp sends all of it before the first image.
TEST_F(DiagnosisTest, AnotherEpochIsNamedAlsoOfOdometryThatCameFirst) {
  DriveRecord record;
  for (const std::int64_t stamp_ns : odometry_ns_) {
    record.AddOdometry(stamp_ns - At(-40.0));
  }
  for (const RecordedFrame& frame : frames_) {
    record.AddFrame(frame);
  }
  const std::vector<Finding> findings = Diagnose(record, camera_, gyro_);
  EXPECT_EQ(WorstOf(findings), FindingStatus::kWrong);
}

TEST_F(DiagnosisTest, AGyroThatIsWiredWronglyIsNamed) {
  gyro_ = GyroFit{-1.0, 0.0, 5.0};
  Expect("gyro", FindingStatus::kWrong, "turns right while the images turn left");
  gyro_ = GyroFit{1.0 / 57.29578, 0.0, 5.0};
  Expect("gyro", FindingStatus::kWrong, "degrees per second");
  gyro_ = GyroFit{1.0 / 1.2, 0.0, 5.0};
  Expect("gyro", FindingStatus::kWrong, "scale 0.833");
  gyro_ = GyroFit{1.0, 0.05, 5.0};
  Expect("gyro", FindingStatus::kNote, "bias +0.0500 rad/s");
  gyro_ = std::nullopt;
  EXPECT_EQ(Findings().size(), 5U);
}

TEST_F(DiagnosisTest, ARecordIsBounded) {
  DriveRecord record({.max_frames = 2, .max_odometry = 3});
  for (int i = 0; i < 10; ++i) {
    record.AddOdometry(i);
    record.AddFrame(RecordedFrame::Of(i, {}, std::nullopt));
  }
  EXPECT_EQ(record.frames().size(), 2U);
  EXPECT_EQ(record.frames().front().stamp_ns, 8);
  EXPECT_EQ(record.odometry_stamps().size(), 3U);
}

TEST_F(DiagnosisTest, RefusesBadOptions) {
  EXPECT_THROW(Diagnose(DriveRecord(), camera_, gyro_, {.max_gap_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(DriveRecord({.max_frames = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace floorloc
