// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/ambiguity/ambiguity_table.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <ostream>
#include <sstream>

namespace floorloc {
namespace {

using Json = nlohmann::ordered_json;

std::string Fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

std::string OrNever(const std::optional<double>& value, int digits) { return value ? Fixed(*value, digits) : "never"; }

std::string Percent(int part, int all) { return all == 0 ? "-" : Fixed(100.0 * part / all, 1); }

std::string OfAll(int part, int all) { return std::to_string(part) + " of " + std::to_string(all); }

// On other floors tiles differ, and an answer is founded on that.
std::string Unfounded(const AmbiguityRow& row, const StartScore& score) {
  return row.floor == "tiles-identical" ? std::to_string(score.first_unfounded) : "-";
}

void PrintStarts(std::ostream& out, const std::vector<std::string>& methods, const std::vector<AmbiguityRow>& rows) {
  out << "| floor | frames | method | localized | metres: median | 90 % | frames: median | 90 % | first wrong | wrong "
         "of all answers | unfounded |\n|---|---|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const AmbiguityRow& row : rows) {
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const StartScore& s = row.starts[i];
      out << "| " << row.floor << " | " << row.condition << " | " << methods[i] << " | " << OfAll(s.localized, s.starts)
          << " | " << OrNever(s.median_m, 1) << " | " << OrNever(s.ninety_m, 1) << " | " << OrNever(s.median_frames, 0)
          << " | " << OrNever(s.ninety_frames, 0) << " | " << s.first_wrong << " | "
          << OfAll(s.wrong_answers, s.answers) << " | " << Unfounded(row, s) << " |\n";
    }
  }
}

void PrintFrames(std::ostream& out, const std::vector<AmbiguityRow>& rows) {
  out << "\n| floor | frames | bits: mean | median | compared | alone: right, wrong | ms | while tracking: frames | % "
         "answered | wrong | ms | ms of the tracker |\n"
         "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const AmbiguityRow& row : rows) {
    const FrameScore& s = row.frames;
    out << "| " << row.floor << " | " << row.condition << " | " << (s.compared ? Fixed(s.mean_bits, 2) : "-") << " | "
        << (s.compared ? Fixed(s.median_bits, 2) : "-") << " | " << OfAll(s.compared, s.frames) << " | "
        << s.right_alone << ", " << s.wrong_alone << " | " << Fixed(s.median_alone_ms, 1) << " | " << s.expected
        << " | " << Percent(s.localized, s.expected) << " | " << s.wrong << " | "
        << (s.expected ? Fixed(s.median_ms, 1) : "-") << " | " << Fixed(s.median_tracker_ms, 3) << " |\n";
  }
}

Json ToJson(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json ToJson(const std::string& method, const StartScore& s) {
  return {{"method", method},
          {"starts", s.starts},
          {"localized", s.localized},
          {"median_m", ToJson(s.median_m)},
          {"ninety_m", ToJson(s.ninety_m)},
          {"median_frames", ToJson(s.median_frames)},
          {"ninety_frames", ToJson(s.ninety_frames)},
          {"first_wrong", s.first_wrong},
          {"first_unfounded", s.first_unfounded},
          {"answers", s.answers},
          {"wrong_answers", s.wrong_answers}};
}

Json ToJson(const FrameScore& s) {
  return {{"frames", s.frames},
          {"compared", s.compared},
          {"mean_bits", s.mean_bits},
          {"median_bits", s.median_bits},
          {"right_alone", s.right_alone},
          {"wrong_alone", s.wrong_alone},
          {"median_alone_ms", s.median_alone_ms},
          {"tracking", s.expected},
          {"answered_while_tracking", s.localized},
          {"wrong_while_tracking", s.wrong},
          {"median_ms_while_tracking", s.median_ms},
          {"median_tracker_ms", s.median_tracker_ms}};
}

}  // namespace

void PrintAmbiguity(std::ostream& out, const std::vector<std::string>& methods, const std::vector<AmbiguityRow>& rows) {
  PrintStarts(out, methods, rows);
  PrintFrames(out, rows);
  out << "\nlocalized: starts at which the method ever claimed a pose; never: so many did not within the distance that "
         "was followed.\nwrong: more than 20 mm off; first: the first pose that was claimed; unfounded: claimed "
         "although "
         "the same motion a tile beside\nstays in the hall, which only a floor of differing tiles excludes.\n"
         "bits: log2 of the likelihood of the true place over the mean of the others, of frames that were compared "
         "with "
         "the places of\nthe lattice; alone: without a prior; while tracking: with the prior of a tracker that started "
         "lost.\n";
}

std::string ToJson(const std::vector<std::string>& methods, const std::vector<AmbiguityRow>& rows) {
  Json json = Json::array();
  for (const AmbiguityRow& row : rows) {
    Json starts = Json::array();
    for (std::size_t i = 0; i < methods.size(); ++i) {
      starts.push_back(ToJson(methods[i], row.starts[i]));
    }
    json.push_back({{"floor", row.floor},
                    {"condition", row.condition},
                    {"tiles", row.tiles},
                    {"map_rms_m", row.map_rms_m},
                    {"frames", ToJson(row.frames)},
                    {"starts", starts}});
  }
  return json.dump(2) + "\n";
}

}  // namespace floorloc
