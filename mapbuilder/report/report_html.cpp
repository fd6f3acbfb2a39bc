// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/report_html.h"

#include <sstream>

#include "mapbuilder/plot/svg_plot.h"
#include "mapbuilder/report/page_assets.h"
#include "mapbuilder/report/page_map.h"
#include "mapbuilder/report/page_sections.h"
#include "mapbuilder/report/survey_sections.h"

namespace floorloc {

std::string ReportHtml(const ReportPage& page) {
  const MapInfo& info = page.evidence.map.info;
  const std::string name = EscapeHtml(info.name);
  std::ostringstream html;
  html << "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
          "content='width=device-width, initial-scale=1'><link rel='icon' href='data:,'><title>"
       << name << ": how good is this map?</title><style>" << ReportStyle() << "</style></head><body>\n"
       << "<header><div><h1>" << name << ": how good is this map?</h1><p>Made " << EscapeHtml(info.created)
       << " by floorloc " << EscapeHtml(info.builder_version) << " · version "
       << EscapeHtml(info.content_version.substr(0, 16)) << "</p></div></header>\n<main>\n"
       << VerdictSection(page) << ResurveySection(page) << MapSections(page) << HeldOutSection(page)
       << GeometrySection(page) << MaskSection(page) << ExposureSection(page) << DroppedSection(page)
       << OriginSection(page)
       << "</main>\n<footer>Everything on this page was computed from the map file; report.json beside it has the same "
          "numbers. Positions are metres in the map frame.</footer>\n<script>"
       << ReportScript() << "</script>\n</body></html>\n";
  return html.str();
}

}  // namespace floorloc
