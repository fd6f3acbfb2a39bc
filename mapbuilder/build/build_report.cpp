// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build/build_report.h"

#include <cstdio>
#include <map>
#include <numbers>
#include <sstream>

#include "mapbuilder/finished_map/map_lattices.h"
#include "mapbuilder/self_calibration/calibration_summary.h"

namespace floorloc {
namespace {

template <typename... Args>
std::string Format(const char* format, Args... args) {
  char buffer[256];
  std::snprintf(buffer, sizeof(buffer), format, args...);
  return buffer;
}

std::string DroppedText(const BuildReport& report) {
  std::map<std::string, std::vector<std::string>> by_reason;
  for (const DroppedFrame& frame : report.dropped) {
    by_reason[frame.reason].push_back(frame.filename);
  }
  constexpr std::size_t kShown = 3;
  std::string text;
  for (const auto& [reason, files] : by_reason) {
    text += Format("  dropped      %zu: ", files.size()) + reason + " (";
    for (std::size_t i = 0; i < std::min(files.size(), kShown); ++i) {
      text += (i > 0 ? ", " : "") + files[i];
    }
    text += files.size() > kShown ? ", ...)\n" : ")\n";
  }
  return text;
}

// Without links there are no residuals, and no rest that one of them could contradict.
std::string LinksText(const BuildReport& r) {
  if (r.links > 0) {
    return Format("  links        %d (%d contradicted the rest), residual %.2f mm per keypoint, %.2f sigma\n", r.links,
                  r.rejected_links, 1e3 * r.link_rms_m, r.link_rms_sigma);
  }
  return r.rejected_links == 0
             ? "  links        none: no images show the same floor\n"
             : Format("  links        none: all %d that the images gave contradict the poses\n", r.rejected_links);
}

std::string OfSurvey(const BuildReport& r, std::size_t survey) {
  return r.masks.size() > 1 ? " of survey " + std::to_string(survey + 1) : "";
}

// What a build without the mask has to warn of; empty: nothing.
std::string MaskWarning(const BuildReport& r, std::size_t survey) {
  const CameraMaskFinding& mask = r.masks[survey];
  return mask.status == CameraMaskStatus::kFound && !mask.applied
             ? Format("%.1f %% of the images", 100.0 * mask.share) + OfSurvey(r, survey) +
                   " moves with the camera, and is in the map as if it were floor: build again without --no-auto-mask, "
                   "or with --mask FILE"
             : "";
}

std::string MaskText(const BuildReport& r) {
  std::string text;
  for (std::size_t i = 0; i < r.masks.size(); ++i) {
    const CameraMaskFinding& mask = r.masks[i];
    const std::string share = Format("  masked       %.1f %% of the images", 100.0 * mask.share) + OfSurvey(r, i);
    if (mask.status == CameraMaskStatus::kFound && mask.applied) {
      text += share + ": moves with the camera; --mask FILE or --no-auto-mask overrules\n";
    } else if (mask.status == CameraMaskStatus::kGiven) {
      text += share + ", as given\n";
    } else if (mask.status == CameraMaskStatus::kUndecided) {
      text += "  masked       nothing" + OfSurvey(r, i) + ": not enough structure to tell what moves with the camera\n";
    }
  }
  return text;
}

std::string LatticesText(const std::vector<MapLattice>& lattices) {
  std::string text;
  for (const MapLattice& lattice : lattices) {
    text += "  lattice      " + LatticeSentence(lattice) + "\n";
  }
  return text;
}

std::string GapCure(const BuildReport& r) {
  return std::string("; survey the floor between them") + (r.kept_all ? "" : ", or keep all with --keep-all") +
         ", or where images do overlap, try --max-keypoints 3000";
}

}  // namespace

std::vector<std::string> MaskWarnings(const BuildReport& r) {
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < r.masks.size(); ++i) {
    if (const std::string warning = MaskWarning(r, i); !warning.empty()) {
      warnings.push_back(warning);
    }
  }
  return warnings;
}

std::vector<std::string> AllWarnings(const BuildReport& r) {
  std::vector<std::string> warnings = MaskWarnings(r);
  warnings.insert(warnings.end(), r.warnings.begin(), r.warnings.end());
  if (const std::string uneven = HeightWarning(r.heights); !uneven.empty()) {
    warnings.push_back(uneven);
  }
  if (r.part_sizes.size() > 1) {
    std::string gap = Format("The images form %zu parts that do not connect (", r.part_sizes.size());
    for (std::size_t i = 0; i < r.part_sizes.size(); ++i) {
      gap += (i > 0 ? ", " : "") + std::to_string(r.part_sizes[i]);
    }
    gap +=
        r.kept_all ? " frames); all are kept, but their relative poses are uncertain" : " frames); the largest is kept";
    warnings.push_back(gap + (r.repeats_unaided
                                  ? "; the floor repeats itself: survey it with odometry.tum, or give --poses"
                                  : GapCure(r)));
  }
  if (10 * r.unmatched_pairs > r.overlapping_pairs) {
    warnings.push_back(
        Format("%d of %d pairs of frames that should show the same floor do not match: check the mosaic before you "
               "trust this map",
               r.unmatched_pairs, r.overlapping_pairs));
  }
  return warnings;
}

std::string ToText(const BuildReport& r) {
  std::ostringstream text;
  text << Format("  frames       %d of %d used\n", r.frames_used, r.frames) << DroppedText(r);
  if (!r.extends.empty()) {
    text << "  extends      " << r.extends << Format(": %d of the new frames show floor of it\n", r.frames_found);
  }
  if (r.resumed_frames > 0) {
    text << Format("  resumed      %d frames already processed\n", r.resumed_frames);
  }
  text << MaskText(r) << LinksText(r);
  for (const std::string& warning : AllWarnings(r)) {
    text << "  WARNING      " << warning << "\n";
  }
  for (const MarkerFit& marker : r.markers) {
    text << Format("  marker %-5d seen by %d frames", marker.id, marker.frames)
         << (marker.known ? Format(", %.1f mm from its position", 1e3 * marker.error_m) : ", of unknown position")
         << (marker.known && !marker.used ? ", not used\n" : "\n");
  }
  if (r.drift_m > 0.0) {
    text << Format("  drift        odometry drifted by up to %.1f cm and %.1f degrees; corrected\n", 1e2 * r.drift_m,
                   r.drift_rad * 180.0 / std::numbers::pi);
  }
  if (r.heights.free) {
    text << Format("  heights      %.2f to %.2f of the calibrated one; scale by %s\n", r.heights.lowest,
                   r.heights.highest, r.heights.scale_by.c_str());
  }
  text << ToText(r.self_calibration);
  if (r.camera_doubt.pose_rms_m > 0.0) {
    text << Format(
        "  camera       by its images it would see the floor %.1f px elsewhere, and poses would move by %.2f mm\n",
        r.camera_doubt.camera_px, 1e3 * r.camera_doubt.pose_rms_m);
  }
  if (const std::string scale = ScaleText(r.scale); !scale.empty()) {
    text << "  scale        " << scale << "\n";
  }
  text << Format("  floor        %.2f m2, %.2f x %.2f m\n", r.area_m2, r.extent.width_m(), r.extent.height_m())
       << Format("  keypoints    %d (%.0f per m2), seen %.1f times on average\n", r.keypoints,
                 r.area_m2 > 0 ? r.keypoints / r.area_m2 : 0.0, r.mean_observations)
       << LatticesText(r.lattices)
       << Format("  time         %.1f s, %.1f frames/s:", r.total_s, r.total_s > 0 ? r.frames / r.total_s : 0.0);
  for (const auto& [stage, seconds] : r.stage_s) {
    text << " " << stage << Format(" %.1f", seconds);
  }
  text << "\n  version      " << r.content_version.substr(0, 16) << "\n";
  return text.str();
}

}  // namespace floorloc
