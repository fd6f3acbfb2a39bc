// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/connected_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/io/input_error.h"
#include "mapbuilder/placement/spanning_forest.h"

namespace floorloc {
namespace {

// A part of unknown position is put this far to the right of everything else.
constexpr double kPartGapM = 1.0;

// Frames by the part of the graph that images connect.
struct Parts {
  std::vector<int> of_frame;
  std::map<int, int> size;
  int largest = 0;

  bool IsSingle(std::size_t frame) const { return size.at(of_frame[frame]) == 1 && of_frame.size() > 1; }
};

Parts FindParts(int frames, const std::vector<Link>& links) {
  Parts parts;
  parts.of_frame = FindComponents(frames, links);
  for (const int part : parts.of_frame) {
    ++parts.size[part];
  }
  parts.largest = std::max_element(parts.size.begin(), parts.size.end(), [](const auto& a, const auto& b) {
                    return a.second < b.second;
                  })->first;
  return parts;
}

// Those whose position in the map is known, by two poses or control points; the largest when none is.
std::set<int> PartsToKeep(const Parts& parts, const PoseGraph& graph) {
  std::map<int, int> known;
  for (const PosePriorFactor& prior : graph.priors) {
    ++known[parts.of_frame[static_cast<std::size_t>(prior.frame)]];
  }
  for (const ControlPointFactor& point : graph.control_points) {
    ++known[parts.of_frame[static_cast<std::size_t>(point.frame)]];
  }
  std::set<int> keep;
  for (const auto& [number, count] : known) {
    if (count > 1) {
      keep.insert(number);
    }
  }
  return keep.empty() ? std::set<int>{parts.largest} : keep;
}

// Poses with the parts whose relation to the largest is unknown moved beside it.
std::vector<Pose2> SeparateParts(const Parts& parts, const std::vector<RectM>& floors, std::vector<Pose2> poses) {
  std::map<int, Eigen::AlignedBox2d> boxes;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    boxes[parts.of_frame[i]].extend(poses[i] * floors[i].Center());
  }
  const Eigen::AlignedBox2d largest = boxes[parts.largest];
  double right = largest.max().x();
  std::map<int, Eigen::Vector2d> shift{{parts.largest, Eigen::Vector2d::Zero()}};
  for (const auto& [number, box] : boxes) {
    if (number != parts.largest) {
      shift[number] = Eigen::Vector2d(right + kPartGapM - box.min().x(), largest.min().y() - box.min().y());
      right += kPartGapM + box.sizes().x();
    }
  }
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Vector2d& t = shift[parts.of_frame[i]];
    poses[i] = Pose2(t.x(), t.y(), 0.0) * poses[i];
  }
  return poses;
}

std::string DropReason(const BuildFrame& frame, bool single, bool largest_is_kept) {
  if (frame.features.keypoints.empty()) {
    return "no texture";
  }
  if (single) {
    return "matches no other frame";
  }
  return largest_is_kept ? "not connected to the largest part" : "not connected to a part of known pose";
}

void MeasureDrift(const std::vector<BuildFrame>& frames, Placement* placement) {
  // Odometry's frame is the one that fits its first pose: what remains afterwards is drift. Each break starts another.
  std::map<int, Pose2> map_from_odom;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const BuildFrame& frame = frames[i];
    if (frame.odometry_breaks) {
      map_from_odom.erase(frame.survey);
    }
    if (!placement->map_from_base[i] || !frame.odom_from_base) {
      continue;
    }
    const Pose2& pose = *placement->map_from_base[i];
    const auto anchor = map_from_odom.try_emplace(frame.survey, pose * frame.odom_from_base->Inverse()).first;
    const Pose2 error = pose.Between(anchor->second * *frame.odom_from_base);
    placement->drift_m = std::max(placement->drift_m, error.translation().norm());
    placement->drift_rad = std::max(placement->drift_rad, std::abs(error.yaw()));
  }
}

std::vector<int> SizesOf(const Parts& parts) {
  std::vector<int> sizes;
  for (const auto& [number, size] : parts.size) {
    if (size > 1) {
      sizes.push_back(size);
    }
  }
  std::sort(sizes.rbegin(), sizes.rend());
  return sizes;
}

}  // namespace

Placement PlaceConnectedParts(const std::vector<BuildFrame>& frames, const std::vector<RectM>& floors,
                              const PoseGraph& graph, bool keep_all) {
  const Parts parts = FindParts(static_cast<int>(frames.size()), graph.links);
  if (frames.size() > 1 && parts.size.at(parts.largest) == 1) {
    throw InputError(
        "no two frames of the survey show the same floor; survey with at least a third of each image "
        "overlapping the next, and check camera.yaml and floor.yaml; where the images do overlap, try --free-height "
        "(uneven heights), --max-keypoints 3000 (little in common), or a calibration_sigma in camera.yaml that is "
        "true");
  }
  // Odometry says where unconnected parts are.
  const std::vector<Pose2> poses =
      keep_all && graph.odometry.empty() ? SeparateParts(parts, floors, graph.map_from_base) : graph.map_from_base;
  const std::set<int> keep = PartsToKeep(parts, graph);
  Placement placement;
  placement.map_from_base.resize(frames.size());
  placement.drop_reason.resize(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (keep.contains(parts.of_frame[i]) || (keep_all && !parts.IsSingle(i))) {
      placement.map_from_base[i] = poses[i];
    } else {
      placement.drop_reason[i] = DropReason(frames[i], parts.IsSingle(i), keep.contains(parts.largest));
    }
  }
  placement.part_sizes = SizesOf(parts);
  const LinkStatistics statistics = MeasureLinks(graph.links, {poses.begin(), poses.end()});
  placement.rms_m = statistics.rms_m;
  placement.rms_sigma = statistics.rms_sigma;
  placement.links = graph.links;
  MeasureDrift(frames, &placement);
  return placement;
}

}  // namespace floorloc
