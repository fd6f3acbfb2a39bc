// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/join_parts.h"

#include <gtest/gtest.h>

#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

// Two rows of frames at steps of 0.15 m, 0.2 m apart.
constexpr int kPerRow = 10;
constexpr double kTileM = 0.3;

Pose2 Truth(int frame) { return Pose2(0.15 * (frame % kPerRow), frame < kPerRow ? 0.0 : 0.2, 0.0); }

Link MakeLink(int first, int second, double agreement) {
  Link link;
  link.first = first;
  link.second = second;
  link.first_from_second = Truth(first).Between(Truth(second));
  link.inliers = 100;
  link.agreement = agreement;
  return link;
}

std::vector<Link> Rows() {
  std::vector<Link> links;
  for (int i = 0; i + 1 < 2 * kPerRow; ++i) {
    if (i + 1 != kPerRow) {
      links.push_back(MakeLink(i, i + 1, 0.4));
    }
  }
  return links;
}

// A false link on a tiled floor, off by one tile.
Link OneTileOff(Link link) {
  link.first_from_second = Pose2(0.0, -kTileM, 0.0) * link.first_from_second;
  link.inliers = 150;  // more than a true link: the apparent overlap is larger
  return link;
}

bool IsTrue(const Link& link) {
  const Pose2 truth = Truth(link.first).Between(Truth(link.second));
  return (truth.translation() - link.first_from_second.translation()).norm() < 1e-9;
}

TEST(JoinPartsTest, PartsAreJoinedByLinksThatAgree) {
  std::vector<Link> candidates = {MakeLink(2, 12, 0.4), MakeLink(5, 15, 0.4), MakeLink(8, 18, 0.4)};
  Link lie = MakeLink(3, 16, 0.4);
  lie.first_from_second = Pose2(0.3, 0.1, 2.0);
  candidates.push_back(lie);
  const std::vector<Link> joining = FindJoiningLinks(2 * kPerRow, Rows(), candidates);
  EXPECT_EQ(joining.size(), 3U);
  EXPECT_TRUE(std::all_of(joining.begin(), joining.end(), IsTrue));
}

TEST(JoinPartsTest, OneLinkDoesNotJoinLargeParts) {
  EXPECT_TRUE(FindJoiningLinks(2 * kPerRow, Rows(), {MakeLink(2, 12, 0.4)}).empty());
}

TEST(JoinPartsTest, UnorderedFramesAreJoined) {
  std::vector<Link> candidates = Rows();
  for (int i = 0; i < kPerRow; ++i) {
    candidates.push_back(MakeLink(i, i + kPerRow, 0.4));
  }
  const std::vector<Link> joining = FindJoiningLinks(2 * kPerRow, {}, candidates);
  const std::vector<int> component = FindComponents(2 * kPerRow, joining);
  EXPECT_EQ(component, std::vector<int>(2 * kPerRow, 0));
}

// False links with more inliers that agree with each other: only the lower similarity of the images distinguishes them.
TEST(JoinPartsTest, OnRepetitiveFloorsLessSimilarLinksDoNotJoin) {
  std::vector<Link> candidates;
  for (Link link : Rows()) {
    link.rival_agreement = 0.3;
    candidates.push_back(link);
  }
  for (int i = 0; i < kPerRow; ++i) {
    Link lie = OneTileOff(MakeLink(i, i + kPerRow, 0.31));
    lie.rival_agreement = 0.25;
    candidates.push_back(lie);
  }
  ASSERT_TRUE(IsRepetitiveFloor(candidates));
  EXPECT_TRUE(FindJoiningLinks(2 * kPerRow, Rows(), candidates).empty());

  for (const int i : {1, 4, 7}) {
    Link truth = MakeLink(i, i + kPerRow, 0.39);
    truth.rival_agreement = 0.31;
    candidates.push_back(truth);
  }
  const std::vector<Link> joining = FindJoiningLinks(2 * kPerRow, Rows(), candidates);
  EXPECT_EQ(joining.size(), 3U);
  EXPECT_TRUE(std::all_of(joining.begin(), joining.end(), IsTrue));
}

}  // namespace
}  // namespace floorloc
