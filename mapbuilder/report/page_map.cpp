// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/page_map.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <sstream>

#include "mapbuilder/plot/svg_plot.h"
#include "mapbuilder/report/data_uri.h"
#include "mapbuilder/report/number_text.h"
#include "mapbuilder/report/svg_path.h"

namespace floorloc {
namespace {

std::string ViewBox(const RectM& drawn_in_map, const Eigen::Vector2d& origin_m) {
  const RectM drawn = RelativeTo(origin_m, drawn_in_map);
  return FixedText(drawn.x_min, 4) + " " + FixedText(-drawn.y_max, 4) + " " + FixedText(drawn.width_m(), 4) + " " +
         FixedText(drawn.height_m(), 4);
}

std::string Legend(const PageLayer& layer) {
  std::string html = "<ul class='legend'>";
  for (const auto& [colour, label] : layer.legend) {
    html += "<li><i style='background:" + colour + "'></i>" + EscapeHtml(label) + "</li>";
  }
  return html + "</ul>";
}

// Shared SVG definitions of the interactive map and the images per layer.
std::string Definitions(const ReportPage& page, const std::vector<PageLayer>& layers) {
  std::string svg = "<svg width='0' height='0' style='position:absolute' aria-hidden='true'><defs><g id='mosaic'>" +
                    MosaicSvg(page.mosaic, page.quality) + "</g>";
  for (const PageLayer& layer : layers) {
    svg += "<g id='layer-" + layer.key + "'>" + layer.svg + "</g>";
  }
  return svg + "</defs></svg>\n";
}

std::string Switch(const char* type, const std::string& value, const std::string& title, bool checked) {
  return std::string("<label><input type='") + type + "' name='" + (type == std::string("radio") ? "fill" : value) +
         "' value='" + value + "'" + (checked ? " checked" : "") + "> " + EscapeHtml(title) + "</label>";
}

std::string Switches(const std::vector<PageLayer>& layers) {
  std::string fills = "<fieldset><legend>Colour the floor by</legend>" + Switch("radio", "plain", "nothing", true);
  std::string draws = "<fieldset><legend>Draw</legend>" + Switch("checkbox", "marks", "Numbers", true);
  for (const PageLayer& layer : layers) {
    (layer.fills ? fills : draws) += Switch(layer.fills ? "radio" : "checkbox", layer.key, layer.title, layer.shown);
  }
  return "<div id='layers'>" + draws + "</fieldset>" + fills + "</fieldset></div>\n";
}

// Values per cell shown at the pointer: frames (clamped to 255) and usable keypoints (65535: not assessed).
std::string CellsJson(const MapQuality& quality) {
  std::vector<std::uint8_t> coverage, usable;
  for (std::size_t cell = 0; cell < quality.grid.size(); ++cell) {
    coverage.push_back(static_cast<std::uint8_t>(std::min(quality.coverage[cell], 255)));
    const double count = static_cast<double>(quality.usable_in_view[cell]);
    const int rounded = count < 0.0 ? 65535 : static_cast<int>(std::min(std::round(count), 65534.0));
    usable.push_back(static_cast<std::uint8_t>(rounded & 255));
    usable.push_back(static_cast<std::uint8_t>(rounded >> 8));
  }
  const RectM extent = quality.grid.extent();
  const nlohmann::ordered_json json{{"x_of_0", quality.drawing_origin_m.x()},
                                    {"y_of_0", quality.drawing_origin_m.y()},
                                    {"x_min", extent.x_min},
                                    {"y_min", extent.y_min},
                                    {"cell_m", quality.grid.cell_m()},
                                    {"columns", quality.grid.columns()},
                                    {"rows", quality.grid.rows()},
                                    {"not_judged", 65535},
                                    {"coverage", Base64(coverage)},
                                    {"usable", Base64(usable)}};
  return "<script type='application/json' id='cells'>" + json.dump() + "</script>\n";
}

std::string MainMap(const ReportPage& page, const std::vector<PageLayer>& layers) {
  const RectM drawn = DrawnRect(page.evidence);
  std::ostringstream html;
  html << "<section id='map-section'><h2>The floor</h2>\n<p>Switch layers on and off. Drag to move; click the map, "
          "then the wheel zooms (or + and -, or two fingers). Point at a place for its coordinates.</p>\n"
       << Switches(layers) << "<div class='map-frame'><svg id='map' tabindex='0' role='application' aria-label='Mosaic "
       << "of the floor with layers' viewBox='" << ViewBox(drawn, page.quality.drawing_origin_m)
       << "' style='aspect-ratio:" << FixedText(drawn.width_m() / drawn.height_m(), 4) << "'><use href='#mosaic'/>";
  for (const bool fills : {true, false}) {
    for (const PageLayer& layer : layers) {
      if (layer.fills == fills) {
        html << "<use id='on-map-" << layer.key << "' href='#layer-" << layer.key << "'"
             << (layer.shown ? "" : " style='display:none'") << "/>";
      }
    }
  }
  html << "<g id='on-map-marks'>" << MarksSvg(page.quality, drawn) << "</g></svg>\n"
       << "<div class='map-tools'><button id='zoom-in' title='closer' aria-label='closer'>+</button><button "
          "id='zoom-out' title='farther' aria-label='farther'>&minus;</button><button id='zoom-all' title='all' "
          "aria-label='show all'>all</button></div><div id='readout'></div></div>\n"
       << "<p class='map-legend'>The image is " << LengthText(drawn.width_m()) << " wide; x grows to the right, y "
       << "up.</p>\n";
  for (const PageLayer& layer : layers) {
    if (!layer.legend.empty()) {
      html << "<div class='map-legend' id='legend-" << layer.key << "'" << (layer.shown ? "" : " hidden") << "><b>"
           << EscapeHtml(layer.title) << ".</b> " << EscapeHtml(layer.meaning) << Legend(layer) << "</div>\n";
    }
  }
  html << CellsJson(page.quality) << "</section>\n";
  return html.str();
}

std::string Gallery(const ReportPage& page, const std::vector<PageLayer>& layers) {
  const std::string view_box = ViewBox(DrawnRect(page.evidence), page.quality.drawing_origin_m);
  std::ostringstream html;
  html << "<section id='layers-section'><h2>Layer by layer</h2><p class='screen-only'>Click an image to see it large "
          "above.</p><div class='gallery'>\n";
  for (const PageLayer& layer : layers) {
    html << "<figure><button data-show='" << layer.key << "' aria-label='Show " << EscapeHtml(layer.title)
         << " on the map'><svg viewBox='" << view_box << "' role='img' aria-label='" << EscapeHtml(layer.title)
         << "'><use href='#mosaic' opacity='0.55'/><use href='#layer-" << layer.key
         << "'/></svg></button><figcaption><b>" << EscapeHtml(layer.title) << "</b>" << EscapeHtml(layer.meaning)
         << Legend(layer) << "</figcaption></figure>\n";
  }
  html << "</div></section>\n";
  return html.str();
}

}  // namespace

std::string MapSections(const ReportPage& page) {
  const std::vector<PageLayer> layers = MakePageLayers(page.evidence, page.quality, page.options);
  return Definitions(page, layers) + MainMap(page, layers) + Gallery(page, layers);
}

}  // namespace floorloc
