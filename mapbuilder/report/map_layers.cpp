// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/report/map_layers.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "mapbuilder/report/colour_scale.h"
#include "mapbuilder/report/data_uri.h"
#include "mapbuilder/report/number_text.h"
#include "mapbuilder/report/odometry_drift.h"
#include "mapbuilder/report/svg_path.h"
#include "mapbuilder/report/weakness_text.h"

namespace floorloc {
namespace {

constexpr std::size_t kMaxLinks = 20'000;
constexpr const char* kGood = "#1d8a5a";
constexpr const char* kBad = "#c4252d";
constexpr const char* kUnsure = "#d98a00";

cv::Vec4b Bgra(const std::string& colour) {
  const auto rgb = static_cast<std::uint32_t>(std::stoul(colour.substr(1), nullptr, 16));
  return {static_cast<std::uint8_t>(rgb & 255), static_cast<std::uint8_t>(rgb >> 8 & 255),
          static_cast<std::uint8_t>(rgb >> 16 & 255), 255};
}

std::vector<std::pair<std::string, std::string>> LegendOf(const ColourScale& scale) {
  std::vector<std::pair<std::string, std::string>> legend;
  for (std::size_t i = 0; i < scale.colours.size(); ++i) {
    legend.emplace_back(scale.colours[i], scale.labels[i]);
  }
  return legend;
}

std::string ImageSvg(const RectM& rect_in_map, const Eigen::Vector2d& origin_m, const std::string& uri,
                     const std::string& css_class) {
  const RectM rect = RelativeTo(origin_m, rect_in_map);
  return "<image class='" + css_class + "' x='" + FixedText(rect.x_min, 4) + "' y='" + FixedText(-rect.y_max, 4) +
         "' width='" + FixedText(rect.width_m(), 4) + "' height='" + FixedText(rect.height_m(), 4) +
         "' preserveAspectRatio='none' href='" + uri + "'/>";
}

// Cells coloured by value; negative values and cells without frames are not drawn.
template <typename T>
std::string CellsSvg(const MapQuality& quality, const std::vector<T>& values, const ColourScale& scale) {
  const FloorGrid& grid = quality.grid;
  cv::Mat image = cv::Mat::zeros(grid.rows(), grid.columns(), CV_8UC4);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    if (quality.coverage[cell] > 0 && values[cell] >= T(0)) {
      const std::string& colour = scale.colours[scale.ClassOf(static_cast<double>(values[cell]))];
      image.at<cv::Vec4b>(grid.rows() - 1 - grid.Row(cell), grid.Column(cell)) = Bgra(colour);
    }
  }
  return ImageSvg(grid.extent(), quality.drawing_origin_m, PngUri(image), "cells");
}

Eigen::Vector2d ViewCenter(const MapEvidence& evidence, std::size_t frame) {
  return evidence.frames[frame].map_from_base * evidence.RoiOf(evidence.frames[frame]).Center();
}

// One path per error class, the worst drawn last, i.e. on top.
std::string PathsByError(const std::vector<SvgPath>& paths, const ColourScale& scale, const std::string& css_class) {
  std::string svg;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    if (!paths[i].empty()) {
      svg += paths[i].Element(css_class, "stroke:" + scale.colours[i]);
    }
  }
  return svg;
}

PageLayer LinksLayer(const MapEvidence& evidence, const MapQuality& quality) {
  const ColourScale scale = ErrorScale();
  std::vector<SvgPath> paths(scale.colours.size(), SvgPath(quality.drawing_origin_m));
  const std::size_t step = 1 + evidence.links.size() / kMaxLinks;
  for (std::size_t i = 0; i < evidence.links.size(); ++i) {
    const std::size_t error_class = scale.ClassOf(quality.link_strain[i].error_m);
    if (i % step != 0 && error_class + 1 < scale.colours.size()) {
      continue;  // draws a sample of many links, but all of the worst
    }
    paths[error_class].MoveTo(ViewCenter(evidence, static_cast<std::size_t>(evidence.links[i].first)));
    paths[error_class].LineTo(ViewCenter(evidence, static_cast<std::size_t>(evidence.links[i].second)));
  }
  std::string meaning =
      "Each line is an overlap of two frames, measured from their images. Its colour says by how much the frames' "
      "places in the map disagree with that measurement.";
  if (step > 1) {
    meaning += " One line of " + std::to_string(step) + " is drawn, and all of the worst.";
  }
  return {"links", "Links", meaning, LegendOf(scale), PathsByError(paths, scale, "link"), false, false};
}

PageLayer PosesLayer(const MapEvidence& evidence, const MapQuality& quality) {
  const ColourScale scale = ErrorScale();
  std::vector<SvgPath> paths(scale.colours.size(), SvgPath(quality.drawing_origin_m));
  for (std::size_t i = 0; i < evidence.frames.size(); ++i) {
    paths[scale.ClassOf(quality.frame_error_m[i])].Dot(ViewCenter(evidence, i));
  }
  return {"poses",
          "Frames",
          "Each dot is a survey frame, at the middle of what it saw, coloured by how well it agrees with its "
          "neighbours (RMS over its links).",
          LegendOf(scale),
          PathsByError(paths, scale, "pose"),
          false,
          false};
}

PageLayer DriftLayer(const MapEvidence& evidence) {
  PageLayer layer{"drift",
                  "Drift",
                  "Where odometry alone would have put the frames (orange), and where they are in the map (blue).",
                  {{"#2f6fb0", "in the map"}, {"#d9782d", "by odometry"}},
                  "",
                  false,
                  false};
  for (const OdometryDrift& drift : FollowOdometry(evidence)) {
    SvgPath by_odometry(DrawingOrigin(evidence));
    SvgPath in_map(DrawingOrigin(evidence));
    for (std::size_t i = 0; i < drift.samples.size(); ++i) {
      const DriftSample& sample = drift.samples[i];
      i == 0 ? by_odometry.MoveTo(sample.by_odometry) : by_odometry.LineTo(sample.by_odometry);
      i == 0 ? in_map.MoveTo(sample.in_map) : in_map.LineTo(sample.in_map);
    }
    layer.svg += by_odometry.Element("path odometry") + in_map.Element("path optimised");
  }
  return layer;
}

PageLayer HeldOutLayer(const MapEvidence& evidence, double arm_m) {
  SvgPath right(DrawingOrigin(evidence));
  SvgPath unsure(DrawingOrigin(evidence));
  SvgPath wrong(DrawingOrigin(evidence));
  for (const HeldOutFrame& frame : evidence.build.held_out) {
    const Eigen::Vector2d at = frame.map_from_base * evidence.map.info.camera().floor.roi.Center();
    if (frame.status == "localized") {
      right.Dot(at);
    } else {
      (frame.status == "wrong" ? wrong : unsure).Cross(at, arm_m);
    }
  }
  return {"held_out",
          "Held-out frames",
          "These frames were localized in a map made without them, without a prior: the test of what "
          "robots will meet.",
          {{kGood, "found, at the right place"}, {kUnsure, "not found"}, {kBad, "found at a wrong place"}},
          right.Element("found") + unsure.Element("missed") + wrong.Element("wrong"),
          false,
          false};
}

PageLayer LostLayer(const MapEvidence& evidence, double arm_m) {
  SvgPath lost(DrawingOrigin(evidence));
  for (const DroppedFrame& frame : evidence.build.dropped) {
    if (frame.near) {
      lost.Cross(*frame.near * evidence.map.info.camera().floor.roi.Center(), arm_m);
    }
  }
  return {"lost",
          "Frames left out",
          "About where frames were taken that are not in the map, by odometry.",
          {{"#444444", "frame left out"}},
          lost.empty() ? "" : lost.Element("lost"),
          false,
          false};
}

PageLayer ControlPointsLayer(const MapEvidence& evidence, double arm_m) {
  constexpr double kExaggerated = 50.0;
  SvgPath places(DrawingOrigin(evidence));
  SvgPath errors(DrawingOrigin(evidence));
  for (const ControlPointError& point : evidence.build.control_points) {
    places.Triangle(point.surveyed_m, arm_m);
    errors.MoveTo(point.surveyed_m);
    errors.LineTo(point.surveyed_m + kExaggerated * (point.observed_m - point.surveyed_m));
  }
  return {"control",
          "Control points",
          "Surveyed points, each with a line to where the map has it, 50 times as long as the error.",
          {{"#14323f", "control point"}, {kBad, "error, 50 x"}},
          places.empty() ? "" : places.Element("control") + errors.Element("control-error"),
          false,
          false};
}

PageLayer ZonesLayer(const MapQuality& quality) {
  PageLayer layer{"zones", "Weak zones", "Floor where a robot may fail to localize. The list above has the numbers.",
                  {},      "",           false,
                  true};
  for (const Weakness weakness : {Weakness::kNotSurveyed, Weakness::kFewKeypoints, Weakness::kObservedOnce,
                                  Weakness::kSelfSimilar, Weakness::kStrained, Weakness::kNotFound}) {
    SvgPath path(quality.drawing_origin_m);
    for (const Zone& zone : quality.zones) {
      if (zone.weakness == weakness) {
        path.Cells(quality.grid, zone.cells);
      }
    }
    if (!path.empty()) {
      layer.svg += path.Element("zone", std::string("fill:") + ColourOf(weakness));
      layer.legend.emplace_back(ColourOf(weakness), Name(weakness));
    }
  }
  return layer;
}

std::vector<PageLayer> FillingLayers(const MapQuality& quality, const QualityOptions& options) {
  std::vector<PageLayer> layers;
  const ColourScale usable = UsableScale(options.needed_keypoints), density = DensityScale();
  const ColourScale coverage = CoverageScale(), distinct = DistinctivenessScale();
  layers.push_back({"usable", "Usable keypoints",
                    "Usable keypoints that a robot's camera would see with its view centred here. Keypoints that one "
                    "frame alone saw, or that have duplicates elsewhere, count less. Below " +
                        FixedText(options.needed_keypoints, 0) + ", frames in bad light are lost.",
                    LegendOf(usable), CellsSvg(quality, quality.usable_in_view, usable), true, false});
  layers.push_back({"coverage", "Coverage", "How many survey frames cover each place.", LegendOf(coverage),
                    CellsSvg(quality, quality.coverage, coverage), true, false});
  layers.push_back({"density", "Keypoint density", "Keypoints per square metre in the map.", LegendOf(density),
                    CellsSvg(quality, quality.keypoints_m2, density), true, false});
  layers.push_back({"distinct", "Self-similarity",
                    "How distinctive the keypoints in view are. Where the value is low, the floor resembles other "
                    "places of this map.",
                    LegendOf(distinct), CellsSvg(quality, quality.distinctiveness, distinct), true, false});
  return layers;
}

}  // namespace

RectM DrawnRect(const MapEvidence& evidence) {
  const RectM extent = ExtentWithLostFrames(evidence);
  const double room_m = 0.04 * std::max(extent.width_m(), extent.height_m());
  return {extent.x_min - room_m, extent.x_max + room_m, extent.y_min - room_m, extent.y_max + room_m};
}

std::string MosaicSvg(const MosaicImage& mosaic, const MapQuality& quality) {
  constexpr int kQuality = 72;
  const FloorGrid& grid = quality.grid;
  cv::Mat uncovered(grid.rows(), grid.columns(), CV_8U);
  for (std::size_t cell = 0; cell < grid.size(); ++cell) {
    uncovered.at<std::uint8_t>(grid.rows() - 1 - grid.Row(cell), grid.Column(cell)) =
        quality.coverage[cell] > 0 ? 0 : 255;
  }
  // The mosaic is black where it has no floor; dark floor inside the surveyed cells must not be taken for that.
  cv::dilate(uncovered, uncovered, cv::Mat());
  const RectM rect = grid.extent();
  const double to_cells = mosaic.resolution_m / grid.cell_m();
  const cv::Mat cells_from_image =
      (cv::Mat_<double>(2, 3) << to_cells, 0.0, (mosaic.extent.x_min - rect.x_min) / grid.cell_m() - 0.5, 0.0, to_cells,
       (rect.y_max - mosaic.extent.y_max) / grid.cell_m() - 0.5);
  cv::Mat mask;
  cv::warpAffine(uncovered, mask, cells_from_image, mosaic.bgr.size(), cv::INTER_NEAREST | cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT, cv::Scalar(255));
  cv::Mat dark;
  cv::inRange(mosaic.bgr, cv::Scalar(0, 0, 0), cv::Scalar(12, 12, 12), dark);
  cv::Mat image = mosaic.bgr.clone();
  image.setTo(cv::Scalar(255, 255, 255), mask & dark);
  return ImageSvg(mosaic.extent, quality.drawing_origin_m, JpegUri(image, kQuality), "mosaic");
}

std::vector<PageLayer> MakePageLayers(const MapEvidence& evidence, const MapQuality& quality,
                                      const QualityOptions& options) {
  const RectM drawn = DrawnRect(evidence);
  const double arm_m = 0.008 * std::max(drawn.width_m(), drawn.height_m());
  std::vector<PageLayer> layers{ZonesLayer(quality)};
  for (PageLayer& layer : FillingLayers(quality, options)) {
    layers.push_back(std::move(layer));
  }
  for (PageLayer layer : {LinksLayer(evidence, quality), PosesLayer(evidence, quality), DriftLayer(evidence),
                          LostLayer(evidence, arm_m), ControlPointsLayer(evidence, arm_m)}) {
    if (!layer.svg.empty()) {
      layers.push_back(std::move(layer));
    }
  }
  if (!evidence.build.held_out.empty()) {
    layers.push_back(HeldOutLayer(evidence, arm_m));
  }
  return layers;
}

std::string MarksSvg(const MapQuality& quality, const RectM& drawn) {
  const std::string size = FixedText(0.016 * std::max(drawn.width_m(), drawn.height_m()), 4);
  std::ostringstream svg;
  for (std::size_t i = 0; i < quality.zones.size(); ++i) {
    const Zone& zone = quality.zones[i];
    const std::string number = std::to_string(i + 1);
    const Eigen::Vector2d mark = zone.mark - quality.drawing_origin_m;
    svg << "<g class='mark' data-zone='" << number << "' transform='translate(" << FixedText(mark.x(), 3) << " "
        << FixedText(-mark.y(), 3) << ")'><g class='pin' transform='scale(" << size
        << ")'><circle r='1' style='fill:" << ColourOf(zone.weakness) << "'/><text y='0.38'>" << number
        << "</text></g></g>";
  }
  return svg.str();
}

}  // namespace floorloc
