// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/survey_sections.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "core/io/camera_mask.h"
#include "mapbuilder/finished_map/survey_provenance.h"
#include "mapbuilder/plot/svg_plot.h"
#include "mapbuilder/report/charts.h"
#include "mapbuilder/report/data_uri.h"
#include "mapbuilder/report/number_text.h"

namespace floorloc {
namespace {

std::string FieldImage(const FlatField& field) {
  const auto [minimum, maximum] = std::minmax_element(field.gain.begin(), field.gain.end());
  std::ostringstream svg;
  svg << "<svg class='field' viewBox='0 0 " << field.columns << " " << field.rows
      << "' role='img'><title>Brightness over the image</title>";
  for (std::size_t i = 0; i < field.gain.size(); ++i) {
    const auto column = static_cast<int>(i) % field.columns, row = static_cast<int>(i) / field.columns;
    const int grey = static_cast<int>(std::lround(std::clamp(235.0 * *minimum / field.gain[i], 0.0, 255.0)));
    svg << "<rect x='" << column << "' y='" << row << "' width='1.02' height='1.02' fill='rgb(" << grey << "," << grey
        << "," << grey << ")'/>";
  }
  svg << "</svg><p>The darkest part of the image gets " << PercentText(*minimum / *maximum)
      << " of the light of the brightest.</p>";
  return svg.str();
}

}  // namespace

std::string MaskSection(const ReportPage& page) {
  const std::vector<MapCameraMask>& masks = page.evidence.map.info.masks;
  std::ostringstream cards;
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (masks[i].raw.empty()) {
      continue;
    }
    cards << "<div class='card'><h3>"
          << (masks.size() > 1 ? "Survey " + std::to_string(i + 1) + ": masked " : "Masked ")
          << PercentText(MaskedShare(masks[i].raw)) << " of the image</h3><p>"
          << (masks[i].found
                  ? "Moves with the camera; <code>--mask FILE</code> or <code>--no-auto-mask</code> overrules."
                  : "As given with the survey.")
          << "</p>";
    if (!masks[i].picture.empty()) {
      cards << "<img class='mask' alt='An image of the camera; what is masked is red' src='data:image/jpeg;base64,"
            << Base64(masks[i].picture) << "'>";
    }
    cards << "</div>";
  }
  const std::string html = cards.str();
  return html.empty()
             ? ""
             : "<section id='masks'><h2>What is no floor</h2><p>What moves with the camera is not in this map; "
               "vehicles with a camera of a survey's calibration are masked likewise, unless they bring a "
               "mask.</p><div class='two'>" +
                   html + "</div></section>\n";
}

std::string ExposureSection(const ReportPage& page) {
  std::map<int, ChartLine> by_survey;
  for (const MapFrame& frame : page.evidence.frames) {
    ChartLine& line = by_survey[frame.survey];
    line.points.emplace_back(static_cast<double>(line.points.size()), frame.gain);
  }
  std::vector<ChartLine> lines;
  std::vector<double> gains;
  for (auto& [survey, line] : by_survey) {
    line.name = "survey " + std::to_string(survey + 1);
    for (const auto& point : line.points) {
      gains.push_back(point.second);
    }
    lines.push_back(std::move(line));
  }
  std::ostringstream html;
  html << "<section id='exposure'><h2>Exposure</h2><div class='two'><div class='card'><h3>Exposure over "
          "time</h3><p>What "
          "each frame was multiplied with, so that the mosaic is even: "
       << FixedText(Quantile(gains, 0.0), 2) << " to " << FixedText(Quantile(gains, 1.0), 2) << ".</p>"
       << LineChart(lines, {"frame", "gain", "Gain of each frame in the order of the survey"}) << "</div>";
  for (std::size_t i = 0; i < page.evidence.build.flat_fields.size(); ++i) {
    html << "<div class='card'><h3>Brightness over the image"
         << (page.evidence.build.flat_fields.size() > 1 ? ", survey " + std::to_string(i + 1) : "")
         << "</h3><p>Vignetting and lamps mounted on the robot; corrected in the mosaic.</p>"
         << FieldImage(page.evidence.build.flat_fields[i]) << "</div>";
  }
  html << "</div></section>\n";
  return html.str();
}

std::string DroppedSection(const ReportPage& page) {
  constexpr std::size_t kMaxRows = 12;
  const std::vector<DroppedFrame>& dropped = page.evidence.build.dropped;
  if (dropped.empty()) {
    return "";
  }
  std::map<std::string, std::vector<std::string>> by_reason;
  for (const DroppedFrame& frame : dropped) {
    by_reason[frame.reason].push_back(frame.filename);
  }
  std::ostringstream html;
  html << "<section id='dropped'><h2>Frames left out</h2><p>" << NumberText(static_cast<int>(dropped.size())) << " of "
       << NumberText(page.evidence.build.frames) << " frames are not in the map.</p><div class='card scroll'><table>"
       << "<tr><th>Reason</th><th class='number'>Frames</th><th>Files</th></tr>";
  for (const auto& [reason, files] : by_reason) {
    html << "<tr><td>" << EscapeHtml(reason) << "</td><td class='number'>" << files.size() << "</td><td>";
    for (std::size_t i = 0; i < std::min(kMaxRows, files.size()); ++i) {
      html << (i > 0 ? ", " : "") << EscapeHtml(files[i]);
    }
    html << (files.size() > kMaxRows ? ", ... (report.json has all)" : "") << "</td></tr>";
  }
  html << "</table></div></section>\n";
  return html.str();
}

std::string OriginSection(const ReportPage& page) {
  const MapInfo& info = page.evidence.map.info;
  std::ostringstream html;
  html << "<section id='origin'><h2>Where this map comes from</h2><div class='card'><dl class='facts'>";
  const auto fact = [&](const std::string& name, const std::string& value) {
    html << "<dt>" << name << "</dt><dd>" << EscapeHtml(value) << "</dd>";
  };
  fact("Map", info.id);
  fact("Version", info.content_version);
  for (const MapParent& parent : info.parents) {
    fact(EscapeHtml(parent.relation), parent.id + ", version " + parent.content_version);
  }
  fact("Resolution", FixedText(1e3 * info.resolution_m, 2) + " mm per pixel");
  fact("Features", ToString(info.extractor.type));
  for (const SurveyProvenance& survey : ReadProvenance(info)) {
    fact("Survey", survey.folder + ": " + std::to_string(survey.frames) + " frames, camera " + survey.camera +
                       (survey.odometry ? ", with odometry" : "") +
                       (survey.mounting.empty() ? "" : "; mounting by " + survey.mounting));
  }
  html << "</dl></div></section>\n";
  return html.str();
}

}  // namespace floorloc
