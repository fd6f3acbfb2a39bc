// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/page_sections.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "mapbuilder/plot/svg_plot.h"
#include "mapbuilder/report/charts.h"
#include "mapbuilder/report/colour_scale.h"
#include "mapbuilder/report/number_text.h"
#include "mapbuilder/report/odometry_drift.h"
#include "mapbuilder/report/weakness_text.h"

namespace floorloc {
namespace {

constexpr double kDegrees = 57.29577951308232;

// "too_few_inliers" -> "too few inliers"
std::string Words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string List(const std::vector<std::string>& sentences, const char* css_class) {
  std::string html;
  for (const std::string& sentence : sentences) {
    html += "<li>" + EscapeHtml(sentence) + "</li>";
  }
  return html.empty() ? "" : std::string("<ul class='") + css_class + "'>" + html + "</ul>";
}

std::string Tile(const std::string& key, const std::string& title, const std::string& value, const std::string& note) {
  return "<div class='tile'><dt>" + title + "</dt><dd data-number='" + key + "'>" + value + "<small>" +
         EscapeHtml(note) + "</small></dd></div>";
}

std::string Tiles(const ReportPage& page) {
  const BuildReport& build = page.evidence.build;
  const HeldOutScore score = ScoreHeldOut(build.held_out);
  std::vector<double> errors;
  for (const LinkStrain& strain : page.quality.link_strain) {
    errors.push_back(strain.error_m);
  }
  const double surveyed_m2 = page.quality.surveyed_m2;
  const auto keypoints = static_cast<int>(page.evidence.map.keypoints.size());
  std::string html = "<dl class='tiles'>";
  html += Tile("area", "Floor", AreaText(surveyed_m2),
               LengthText(page.evidence.map.info.extent.width_m()) + " x " +
                   LengthText(page.evidence.map.info.extent.height_m()));
  html += Tile("frames", "Frames in the map", NumberText(static_cast<int>(page.evidence.frames.size())),
               !build.extends.empty() ? NumberText(build.frames_used) + " of " + NumberText(build.frames) + " new ones"
               : build.frames > 0     ? "of " + NumberText(build.frames)
                                      : "");
  html += score.frames > 0 ? Tile("held-out", "Held-out frames found",
                                  PercentText(static_cast<double>(score.localized) / score.frames),
                                  NumberText(score.localized) + " of " + NumberText(score.frames) + ", " +
                                      NumberText(score.wrong) + " wrong")
                           : Tile("held-out", "Held-out frames found", "-", "not tried");
  html += Tile("agreement", "Neighbouring frames agree within", LengthText(Quantile(errors, 0.5)),
               "95 %: " + LengthText(Quantile(errors, 0.95)));
  html += Tile("weak", "Weak floor", PercentText(surveyed_m2 > 0.0 ? page.quality.weak_m2 / surveyed_m2 : 0.0),
               AreaText(page.quality.weak_m2));
  html += Tile("keypoints", "Keypoints", NumberText(keypoints),
               NumberText(static_cast<int>(surveyed_m2 > 0.0 ? keypoints / surveyed_m2 : 0.0)) + " per m², seen " +
                   FixedText(build.mean_observations, 1) + " times");
  if (build.drift_m > 0.0) {
    html += Tile("drift", "Drift removed", LengthText(build.drift_m),
                 FixedText(build.drift_rad * kDegrees, 1) + " degrees");
  }
  return html + "</dl>";
}

std::string DistanceChart(const std::vector<OdometryDrift>& drifts) {
  std::vector<ChartLine> lines;
  for (const OdometryDrift& drift : drifts) {
    ChartLine line{"survey " + std::to_string(drift.survey + 1), {}};
    for (const DriftSample& sample : drift.samples) {
      line.points.emplace_back(sample.travelled_m, 1e2 * sample.error_m);
    }
    lines.push_back(std::move(line));
  }
  return LineChart(lines, {"metres travelled", "drift, cm", "Drift of odometry from the map along the path"});
}

std::string ControlPointsTable(const std::vector<ControlPointError>& points) {
  constexpr std::size_t kMaxRows = 50;
  std::ostringstream html;
  html << "<div class='card'><h3>Control points</h3><p>" << points.size() << " observations, off by "
       << LengthText(ControlPointRms(points)) << " RMS.</p><div class='scroll'><table><tr><th>Frame</th><th "
       << "class='number'>x, m</th><th class='number'>y, m</th><th class='number'>Error</th></tr>";
  for (std::size_t i = 0; i < std::min(kMaxRows, points.size()); ++i) {
    const ControlPointError& point = points[i];
    html << "<tr><td>" << EscapeHtml(point.filename) << "</td><td class='number'>" << FixedText(point.surveyed_m.x(), 3)
         << "</td><td class='number'>" << FixedText(point.surveyed_m.y(), 3) << "</td><td class='number'>"
         << LengthText((point.observed_m - point.surveyed_m).norm()) << "</td></tr>";
  }
  html << "</table></div>" << (points.size() > kMaxRows ? "<p>report.json has all of them.</p>" : "") << "</div>";
  return html.str();
}

std::string MarkersTable(const std::vector<MarkerFit>& markers) {
  std::ostringstream html;
  html << "<div class='card'><h3>Markers</h3><div class='scroll'><table><tr><th class='number'>Marker</th><th "
          "class='number'>Frames</th><th class='number'>Error</th><th></th></tr>";
  for (const MarkerFit& marker : markers) {
    html << "<tr><td class='number'>" << marker.id << "</td><td class='number'>" << marker.frames
         << "</td><td class='number'>" << (marker.known ? LengthText(marker.error_m) : "-") << "</td><td>"
         << (!marker.known  ? "of unknown place"
             : !marker.used ? "contradicts the others, not used"
                            : "")
         << "</td></tr>";
  }
  html << "</table></div></div>";
  return html.str();
}

std::string FailuresTable(const MapEvidence& evidence) {
  std::ostringstream html;
  html << "<div class='card'><h3>Frames that were not localized</h3><div class='scroll'><table><tr><th>Frame</th><th "
          "class='number'>x, m</th><th class='number'>y, m</th><th>Outcome</th><th class='number'>Inliers</th></tr>";
  for (const HeldOutFrame& frame : evidence.build.held_out) {
    if (frame.status == "localized") {
      continue;
    }
    const Eigen::Vector2d at = frame.map_from_base * evidence.map.info.camera().floor.roi.Center();
    const std::string& why = frame.reason.empty() ? frame.status : frame.reason;
    html << "<tr><td>" << EscapeHtml(frame.filename) << "</td><td class='number'>" << FixedText(at.x(), 2)
         << "</td><td class='number'>" << FixedText(at.y(), 2) << "</td><td>"
         << EscapeHtml(frame.status == "wrong" ? "wrong by " + LengthText(frame.error_m) : Words(why))
         << "</td><td class='number'>" << frame.inliers << " of " << frame.keypoints << "</td></tr>";
  }
  html << "</table></div></div>";
  return html.str();
}

}  // namespace

std::string VerdictSection(const ReportPage& page) {
  const std::string trust = ToString(page.verdict.trust);
  return "<section id='verdict'><div class='card verdict " + trust + "' data-verdict='" + trust + "'><h2>" +
         EscapeHtml(page.verdict.headline) + "</h2>" + List(page.verdict.reasons, "reasons") +
         List(page.verdict.facts, "facts") + "</div>" + Tiles(page) + "</section>\n";
}

std::string ResurveySection(const ReportPage& page) {
  constexpr std::size_t kMaxRows = 40;
  const std::vector<Zone>& zones = page.quality.zones;
  std::ostringstream html;
  html << "<section id='resurvey'><h2>Re-survey here</h2>";
  if (zones.empty()) {
    html << "<p>Nowhere: no hole and no weak place was found.</p></section>\n";
    return html.str();
  }
  html << "<p>The most important place first. The numbers are those on the map below; click one to go there.</p><div "
          "class='card scroll'><table><tr><th>No.</th><th class='number'>x, m</th><th class='number'>y, m</th><th "
          "class='number'>Size</th><th>What is wrong</th><th>What to do</th></tr>\n";
  for (std::size_t i = 0; i < std::min(kMaxRows, zones.size()); ++i) {
    const Zone& zone = zones[i];
    html << "<tr data-zone-row='" << i + 1 << "' data-x='" << FixedText(zone.mark.x(), 3) << "' data-y='"
         << FixedText(zone.mark.y(), 3) << "' data-size='"
         << FixedText(std::max(zone.box.width_m(), zone.box.height_m()), 3)
         << "'><td><button class='badge' style='background:" << ColourOf(zone.weakness) << "' aria-label='Go to place "
         << i + 1 << "'>" << i + 1 << "</button></td><td class='number'>" << FixedText(zone.mark.x(), 2)
         << "</td><td class='number'>" << FixedText(zone.mark.y(), 2) << "</td><td class='number'>"
         << AreaText(zone.area_m2) << "<br><small>" << LengthText(zone.box.width_m()) << " x "
         << LengthText(zone.box.height_m()) << "</small></td><td><b>" << EscapeHtml(Name(zone.weakness)) << "</b><br>"
         << EscapeHtml(Describe(zone)) << "</td><td>" << EscapeHtml(Advice(zone)) << "</td></tr>\n";
  }
  html << "</table></div>"
       << (zones.size() > kMaxRows ? "<p>" + NumberText(static_cast<int>(zones.size() - kMaxRows)) +
                                         " smaller places are on the map and in report.json.</p>"
                                   : "")
       << "</section>\n";
  return html.str();
}

std::string LinksSentence(const BuildReport& build) {
  if (build.links > 0) {
    return NumberText(build.links) + " overlaps were measured; " + NumberText(build.rejected_links) +
           " more contradicted the rest and were rejected";
  }
  return build.rejected_links == 0
             ? "No images show the same floor"
             : "None of the " + NumberText(build.rejected_links) + " overlaps that were measured agrees with the poses";
}

std::string GeometrySection(const ReportPage& page) {
  std::vector<double> errors_mm;
  for (const LinkStrain& strain : page.quality.link_strain) {
    errors_mm.push_back(1e3 * strain.error_m);
  }
  const BuildReport& build = page.evidence.build;
  const std::vector<OdometryDrift> drifts = FollowOdometry(page.evidence);
  std::ostringstream html;
  html << "<section id='geometry'><h2>Geometry</h2><p>" << LinksSentence(build) << "; of "
       << NumberText(build.overlapping_pairs) << " pairs of frames that share most of their floor, "
       << NumberText(build.unmatched_pairs) << " do not match.</p><div class='two'>";
  if (!errors_mm.empty()) {
    html << "<div class='card'><h3>How well overlaps agree with the map</h3><p>Distance between where a frame is and "
            "where its neighbour's image says it is.</p>"
         << Histogram(errors_mm, {"mm", "links", "Histogram of the links' errors"}) << "</div>";
  }
  if (!drifts.empty()) {
    html << "<div class='card'><h3>Drift found and removed</h3><p>";
    for (const OdometryDrift& drift : drifts) {
      html << "Over " << LengthText(drift.travelled_m) << " odometry drifted by up to " << LengthText(drift.largest_m)
           << " and " << FixedText(drift.largest_rad * kDegrees, 1) << " degrees. ";
    }
    html << "</p>" << DistanceChart(drifts) << "</div>";
  }
  if (!build.control_points.empty()) {
    html << ControlPointsTable(build.control_points);
  }
  if (!build.markers.empty()) {
    html << MarkersTable(build.markers);
  }
  html << "</div></section>\n";
  return html.str();
}

std::string HeldOutSection(const ReportPage& page) {
  const std::vector<HeldOutFrame>& frames = page.evidence.build.held_out;
  if (frames.empty()) {
    return "";
  }
  const HeldOutScore score = ScoreHeldOut(frames);
  std::vector<double> errors_mm;
  for (const HeldOutFrame& frame : frames) {
    if (frame.status == "localized") {
      errors_mm.push_back(1e3 * frame.error_m);
    }
  }
  std::ostringstream html;
  html << "<section id='held-out'><h2>Would a robot localize?</h2><p>" << score.frames
       << " frames, spread over the floor, were held out; each was then localized in the map of the others, on the "
          "whole "
          "floor and without any hint. "
       << score.localized << " were found at the right place, " << score.wrong << " at a wrong one; "
       << score.frames - score.localized - score.wrong << " were not found"
       << (score.ambiguous > 0 ? " (" + NumberText(score.ambiguous) + " of them fit several places)" : "")
       << ".</p><div class='two'>";
  if (!errors_mm.empty()) {
    html << "<div class='card'><h3>Error of the localized frames</h3><p>Median " << LengthText(score.median_m)
         << " and " << FixedText(score.median_rad * kDegrees, 3) << " degrees, 95 %: " << LengthText(score.p95_m)
         << ". Compared with where the build put them, so errors of the calibration do not show.</p>"
         << Histogram(errors_mm, {"mm", "frames", "Histogram of the errors of held-out frames"}) << "</div>";
  }
  if (score.localized < score.frames) {
    html << FailuresTable(page.evidence);
  }
  html << "</div></section>\n";
  return html.str();
}

}  // namespace floorloc
