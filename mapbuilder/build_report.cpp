// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/build_report.h"

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "mapbuilder/calibration_summary.h"

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
  for (const auto& [file, reason] : report.dropped) {
    by_reason[reason].push_back(file);
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

}  // namespace

std::string ToJson(const BuildReport& report, bool with_times) {
  nlohmann::ordered_json json{{"frames", report.frames},
                              {"frames_used", report.frames_used},
                              {"dropped", nlohmann::json::array()},
                              {"warnings", report.warnings},
                              {"parts", report.part_sizes},
                              {"links", report.links},
                              {"rejected_links", report.rejected_links},
                              {"overlapping_pairs", report.overlapping_pairs},
                              {"unmatched_pairs", report.unmatched_pairs},
                              {"link_rms_m", report.link_rms_m},
                              {"link_rms_sigma", report.link_rms_sigma},
                              {"drift_m", report.drift_m},
                              {"drift_rad", report.drift_rad},
                              {"self_calibration", nlohmann::ordered_json::parse(ToJson(report.self_calibration))},
                              {"area_m2", report.area_m2},
                              {"extent",
                               {{"x_min", report.extent.x_min},
                                {"x_max", report.extent.x_max},
                                {"y_min", report.extent.y_min},
                                {"y_max", report.extent.y_max}}},
                              {"keypoints", report.keypoints},
                              {"mean_observations", report.mean_observations}};
  for (const auto& [file, reason] : report.dropped) {
    json["dropped"].push_back({{"filename", file}, {"reason", reason}});
  }
  for (const MarkerFit& marker : report.markers) {
    json["markers"].push_back({{"id", marker.id},
                               {"known", marker.known},
                               {"used", marker.used},
                               {"frames", marker.frames},
                               {"error_m", marker.known ? nlohmann::ordered_json(marker.error_m) : nullptr}});
  }
  if (!report.extends.empty()) {
    json["extends"] = report.extends;
    json["frames_found"] = report.frames_found;
  }
  if (with_times) {
    json["content_version"] = report.content_version;
    for (const auto& [stage, seconds] : report.stage_s) {
      json["stage_s"][stage] = seconds;
    }
    json["total_s"] = report.total_s;
    json["resumed_frames"] = report.resumed_frames;
    json["frames_per_s"] = report.total_s > 0.0 ? report.frames / report.total_s : 0.0;
  }
  return json.dump(2);
}

std::string ToText(const BuildReport& r) {
  std::ostringstream text;
  text << Format("  frames       %d of %d used\n", r.frames_used, r.frames) << DroppedText(r);
  if (!r.extends.empty()) {
    text << "  extends      " << r.extends << Format(": %d of the new frames show floor of it\n", r.frames_found);
  }
  if (r.resumed_frames > 0) {
    text << Format("  resumed      %d frames need not be looked at again\n", r.resumed_frames);
  }
  if (r.part_sizes.size() > 1) {
    text << "  gap          the pictures form " << r.part_sizes.size() << " parts that do not connect:";
    for (const int size : r.part_sizes) {
      text << " " << size;
    }
    text << " frames; "
         << (r.kept_all ? "all are kept, but how they lie to each other is not sure" : "the largest is kept")
         << "; survey the floor between them" << (r.kept_all ? "" : ", or keep all with --keep-all") << "\n";
  }
  text << Format("  links        %d (%d contradicted the rest), residual %.2f mm per keypoint, %.2f sigma\n", r.links,
                 r.rejected_links, 1e3 * r.link_rms_m, r.link_rms_sigma);
  if (10 * r.unmatched_pairs > r.overlapping_pairs) {
    text << Format(
        "  WARNING      %d of %d pairs of frames that should show the same floor do not match: look at the "
        "mosaic before you trust this map\n",
        r.unmatched_pairs, r.overlapping_pairs);
  }
  for (const std::string& warning : r.warnings) {
    text << "  WARNING      " << warning << "\n";
  }
  for (const MarkerFit& marker : r.markers) {
    text << Format("  marker %-5d seen by %d frames", marker.id, marker.frames)
         << (marker.known ? Format(", %.1f mm from its place", 1e3 * marker.error_m) : ", of unknown place")
         << (marker.known && !marker.used ? ", not used\n" : "\n");
  }
  if (r.drift_m > 0.0) {
    text << Format("  drift        odometry strayed by up to %.1f cm and %.1f degrees; removed\n", 1e2 * r.drift_m,
                   r.drift_rad * 180.0 / std::numbers::pi);
  }
  text << ToText(r.self_calibration)
       << Format("  floor        %.2f m2, %.2f x %.2f m\n", r.area_m2, r.extent.width_m(), r.extent.height_m())
       << Format("  keypoints    %d (%.0f per m2), seen %.1f times on average\n", r.keypoints,
                 r.area_m2 > 0 ? r.keypoints / r.area_m2 : 0.0, r.mean_observations)
       << Format("  time         %.1f s, %.1f frames/s:", r.total_s, r.total_s > 0 ? r.frames / r.total_s : 0.0);
  for (const auto& [stage, seconds] : r.stage_s) {
    text << " " << stage << Format(" %.1f", seconds);
  }
  text << "\n  version      " << r.content_version.substr(0, 16) << "\n";
  return text.str();
}

}  // namespace floorloc
