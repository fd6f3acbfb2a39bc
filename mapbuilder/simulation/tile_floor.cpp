// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/simulation/tile_floor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <set>
#include <stdexcept>

#include "mapbuilder/simulation/floor_paint.h"
#include "mapbuilder/simulation/simulated_noise.h"

namespace floorloc {
namespace {

constexpr double kJointM = 0.004;
constexpr double kTurn = 2.0 * std::numbers::pi;

enum SeedStream : std::uint64_t {
  kTones = 1,
  kPrintTone = 2,
  kPrintTint = 3,
  kPrintSpecks = 4,
  kGrout = 5,
  kGlaze = 6,
  kLaying = 7,
  kChoice = 8,
  kSingularity = 100,
};

int PitchPx(double resolution_m) { return std::max(2, static_cast<int>(std::lround(kTilePitchM / resolution_m))); }

// What all tiles have in common, without the joints.
cv::Mat PaintPrint(double resolution_m, std::uint64_t seed) {
  const int side_px = static_cast<int>((kTilePitchM - kJointM) / resolution_m);
  const PixelGrid grid{{side_px, side_px}, resolution_m};
  cv::Mat print = Colorize(MetricNoise(grid, 0.06, 5, DeriveSeed(seed, kPrintTone)) * 9.0,
                           MetricNoise(grid, 0.04, 3, DeriveSeed(seed, kPrintTint)), {172, 182, 190}, 4.0);
  ScatterSpecks(print, grid, {5000, 0.0004, 0.002, 110, 150}, DeriveSeed(seed, kPrintSpecks));
  return print;
}

cv::Mat PaintGrout(const PixelGrid& grid, std::uint64_t seed) {
  return Colorize(MetricNoise(grid, 0.004, 3, DeriveSeed(seed, kGrout)) * 14.0, cv::Mat::zeros(grid.size_px, CV_32FC1),
                  {120, 122, 124}, 0.0);
}

// Only a slight tone, wear of the glaze and the joints distinguish the tiles.
cv::Mat PaintNearlyAlikeTiles(const PixelGrid& grid, std::uint64_t seed) {
  cv::RNG rng(DeriveSeed(seed, kTones));
  const cv::Mat print = PaintPrint(grid.resolution_m, seed);
  cv::Mat floor = PaintGrout(grid, seed);
  const int pitch_px = PitchPx(grid.resolution_m);
  for (int v = 0; v < floor.rows; v += pitch_px) {
    for (int u = 0; u < floor.cols; u += pitch_px) {
      const cv::Rect tile = cv::Rect({u, v}, print.size()) & cv::Rect({0, 0}, floor.size());
      cv::Mat(print(cv::Rect({0, 0}, tile.size())) + cv::Scalar::all(rng.uniform(-3.0, 3.0))).copyTo(floor(tile));
    }
  }
  ScatterSpecks(floor, grid, {900, 0.0004, 0.0015, 95, 215}, DeriveSeed(seed, kGlaze));
  return floor;
}

cv::Point2d RandomPoint(const cv::Mat& image, cv::RNG& rng) {
  const double x = rng.uniform(0.0, static_cast<double>(image.cols));
  return {x, rng.uniform(0.0, static_cast<double>(image.rows))};
}

void DrawCrack(cv::Mat& print, double px_per_m, cv::RNG& rng) {
  cv::Point2d p = RandomPoint(print, rng);
  double heading = rng.uniform(0.0, kTurn);
  const double step_px = 0.004 * px_per_m;
  const int thickness = std::max(1, static_cast<int>(std::lround(rng.uniform(0.0005, 0.001) * px_per_m)));
  const int steps = rng.uniform(20, 50);
  for (int i = 0; i < steps; ++i) {
    heading += rng.gaussian(0.25);
    const cv::Point2d q(p.x + step_px * std::cos(heading), p.y + step_px * std::sin(heading));
    cv::line(print, p, q, cv::Scalar(84, 86, 88), thickness, cv::LINE_AA);
    p = q;
  }
}

std::vector<cv::Point> RoughOutline(const cv::Point2d& center, double radius_px, cv::RNG& rng) {
  constexpr int kCorners = 9;
  std::vector<cv::Point> outline;
  for (int i = 0; i < kCorners; ++i) {
    const double a = kTurn * i / kCorners;
    const double r = radius_px * rng.uniform(0.6, 1.0);
    outline.emplace_back(center + r * cv::Point2d(std::cos(a), std::sin(a)));
  }
  return outline;
}

// At an edge, down to the lighter body of the tile.
void DrawChip(cv::Mat& print, double px_per_m, cv::RNG& rng) {
  cv::Point2d center = RandomPoint(print, rng);
  const int edge = rng.uniform(0, 4);
  (edge < 2 ? center.x : center.y) = edge % 2 == 0 ? 0.0 : print.rows - 1.0;
  const std::vector<cv::Point> outline = RoughOutline(center, rng.uniform(0.006, 0.016) * px_per_m, rng);
  cv::fillPoly(print, std::vector{outline}, cv::Scalar(206, 214, 218), cv::LINE_AA);
}

void DrawStain(cv::Mat& print, double px_per_m, cv::RNG& rng) {
  cv::Mat darker = cv::Mat::zeros(print.size(), CV_8UC3);
  const cv::Scalar tone = cv::Scalar::all(rng.uniform(25.0, 45.0));
  const cv::Point2d center = RandomPoint(print, rng);
  const std::vector<cv::Point> outline = RoughOutline(center, rng.uniform(0.015, 0.05) * px_per_m, rng);
  cv::fillPoly(darker, std::vector{outline}, tone, cv::LINE_AA);
  cv::GaussianBlur(darker, darker, {}, 0.001 * px_per_m);
  print -= darker;
}

void DrawSingularity(cv::Mat& print, double px_per_m, std::uint64_t seed) {
  cv::RNG rng(seed);
  switch (rng.uniform(0, 3)) {
    case 0:
      DrawCrack(print, px_per_m, rng);
      break;
    case 1:
      DrawChip(print, px_per_m, rng);
      break;
    default:
      DrawStain(print, px_per_m, rng);
  }
}

// Which of so many tiles are singular.
std::set<int> ChooseTiles(int tiles, double share, std::uint64_t seed) {
  const int wanted = share > 0.0 ? std::max(1, static_cast<int>(std::lround(share * tiles))) : 0;
  cv::RNG rng(seed);
  std::set<int> chosen;
  while (static_cast<int>(chosen.size()) < std::min(wanted, tiles)) {
    chosen.insert(rng.uniform(0, tiles));
  }
  return chosen;
}

// How a tile lies in its place.
struct Laying {
  cv::Point2d offset_px;
  double turn_rad = 0.0;
  int quarter_turns = 0;
};

Laying DrawLaying(const TileVariation& variation, double px_per_m, cv::RNG& rng) {
  Laying laying;
  const double offset_px = rng.uniform(0.0, 1.0) * variation.max_offset_m * px_per_m;
  const double direction = rng.uniform(0.0, kTurn);
  laying.offset_px = {offset_px * std::cos(direction), offset_px * std::sin(direction)};
  laying.turn_rad = rng.uniform(-1.0, 1.0) * variation.max_turn_rad;
  const int quarters = rng.uniform(0, 4);
  laying.quarter_turns = variation.quarter_turns ? quarters : 0;
  return laying;
}

cv::Mat TurnByQuarters(const cv::Mat& print, int quarter_turns) {
  cv::Mat turned = print.clone();
  for (int i = 0; i < quarter_turns; ++i) {
    cv::Mat next;
    cv::rotate(turned, next, cv::ROTATE_90_CLOCKWISE);
    turned = next;
  }
  return turned;
}

// Lays a print onto the grout of the place whose upper left corner is given; it may stick out of it.
void LayTile(const cv::Mat& print, const Laying& laying, cv::Point place, cv::Mat* floor) {
  const int margin_px = 2 + print.cols / 50;  // 6 mm: more than offset and turn
  const double middle_px = 0.5 * (print.cols - 1);
  const double c = std::cos(laying.turn_rad);
  const double s = std::sin(laying.turn_rad);
  const double shift = margin_px + middle_px;
  const cv::Matx23d patch_from_print(c, -s, shift + laying.offset_px.x - c * middle_px + s * middle_px,  //
                                     s, c, shift + laying.offset_px.y - s * middle_px - c * middle_px);
  const cv::Size size(print.cols + 2 * margin_px, print.rows + 2 * margin_px);
  cv::Mat patch;
  cv::Mat covered;
  cv::warpAffine(print, patch, patch_from_print, size, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  cv::warpAffine(cv::Mat(print.size(), CV_8UC1, cv::Scalar(255)), covered, patch_from_print, size);
  const cv::Rect whole(place - cv::Point(margin_px, margin_px), size);
  const cv::Rect seen = whole & cv::Rect({0, 0}, floor->size());
  const cv::Rect in_patch(seen.tl() - whole.tl(), seen.size());
  patch(in_patch).copyTo((*floor)(seen), covered(in_patch) > 127);
}

const std::map<std::string, TileVariation>& VariationsByName() {
  static const std::map<std::string, TileVariation> kVariations = {
      {"tiles-identical", {}},
      {"tiles-grout", {.max_offset_m = 0.0015, .max_turn_rad = 0.5 * std::numbers::pi / 180.0}},
      {"tiles-turned", {.quarter_turns = true}},
      {"tiles-singular-1", {.singular_share = 0.01}},
      {"tiles-singular-5", {.singular_share = 0.05}},
  };
  return kVariations;
}

}  // namespace

std::vector<std::string> TileFloorNames() {
  return {"tiles", "tiles-identical", "tiles-grout", "tiles-turned", "tiles-singular-1", "tiles-singular-5"};
}

cv::Mat PaintTileFloor(const std::string& name, const PixelGrid& grid, std::uint64_t seed) {
  if (name == "tiles") {
    return PaintNearlyAlikeTiles(grid, seed);
  }
  const auto variation = VariationsByName().find(name);
  if (variation == VariationsByName().end()) {
    throw std::invalid_argument("no tiled floor named '" + name + "'");
  }
  return PaintTiles(variation->second, grid, seed);
}

cv::Mat PaintTiles(const TileVariation& variation, const PixelGrid& grid, std::uint64_t seed) {
  const double px_per_m = 1.0 / grid.resolution_m;
  const cv::Mat print = PaintPrint(grid.resolution_m, seed);
  const int pitch_px = PitchPx(grid.resolution_m);
  const int joint_px = (pitch_px - print.cols) / 2;
  const int columns = (grid.size_px.width + pitch_px - 1) / pitch_px;
  const int rows = (grid.size_px.height + pitch_px - 1) / pitch_px;
  const std::set<int> singular = ChooseTiles(columns * rows, variation.singular_share, DeriveSeed(seed, kChoice));
  cv::Mat floor;
  cv::repeat(PaintGrout({{pitch_px, pitch_px}, grid.resolution_m}, seed), rows, columns, floor);
  floor = floor(cv::Rect({0, 0}, grid.size_px)).clone();
  cv::RNG rng(DeriveSeed(seed, kLaying));
  for (int tile = 0; tile < columns * rows; ++tile) {
    const Laying laying = DrawLaying(variation, px_per_m, rng);
    cv::Mat own = TurnByQuarters(print, laying.quarter_turns);
    if (singular.contains(tile)) {
      DrawSingularity(own, px_per_m, DeriveSeed(seed, kSingularity + static_cast<std::uint64_t>(tile)));
    }
    const cv::Point place(tile % columns * pitch_px + joint_px, tile / columns * pitch_px + joint_px);
    LayTile(own, laying, place, &floor);
  }
  return floor;
}

}  // namespace floorloc
