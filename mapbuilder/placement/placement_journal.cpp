// SPDX-License-Identifier: Apache-2.0
#include "mapbuilder/placement/placement_journal.h"

#include <algorithm>

#include "mapbuilder/batch/journal_bytes.h"
#include "mapbuilder/survey/frame_journal.h"

namespace floorloc {
namespace {

void AddPose(const std::optional<Pose2>& pose, ByteWriter* writer) {
  writer->Add(pose.has_value());
  const Pose2 value = pose.value_or(Pose2());
  writer->Add(value.x()).Add(value.y()).Add(value.yaw());
}

std::optional<Pose2> ReadPose(ByteReader* reader) {
  bool has_value = false;
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  reader->Read(&has_value);
  reader->Read(&x);
  reader->Read(&y);
  reader->Read(&yaw);
  return has_value ? std::optional(Pose2(x, y, yaw)) : std::nullopt;
}

void AddMatrix(const Eigen::Matrix3d& matrix, ByteWriter* writer) {
  for (int i = 0; i < 9; ++i) {
    writer->Add(matrix(i / 3, i % 3));
  }
}

void ReadMatrix(ByteReader* reader, Eigen::Matrix3d* matrix) {
  for (int i = 0; i < 9; ++i) {
    reader->Read(&(*matrix)(i / 3, i % 3));
  }
}

void AddLink(const Link& link, ByteWriter* writer) {
  writer->Add(link.first).Add(link.second).Add(link.inliers).Add(link.rms_m);
  AddPose(link.first_from_second, writer);
  AddMatrix(link.covariance, writer);
}

Link ReadLink(ByteReader* reader) {
  Link link;
  reader->Read(&link.first);
  reader->Read(&link.second);
  reader->Read(&link.inliers);
  reader->Read(&link.rms_m);
  link.first_from_second = ReadPose(reader).value_or(Pose2());
  ReadMatrix(reader, &link.covariance);
  return link;
}

bool IsFrame(int index, std::size_t frames) { return index >= 0 && static_cast<std::size_t>(index) < frames; }

bool FitsFrames(const Placement& p, std::size_t frames) {
  return p.map_from_base.size() == frames && p.drop_reason.size() == frames &&
         std::all_of(p.links.begin(), p.links.end(), [frames](const Link& link) {
           return IsFrame(link.first, frames) && IsFrame(link.second, frames);
         });
}

// Hashes the files directly in the folder: camera, odometry, control points, ...
void AddFilesOf(const Survey& survey, ContentHash* hash) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(survey.folder)) {
    if (entry.is_regular_file()) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    AddFile(file, hash);
  }
}

}  // namespace

std::string PlacementKey(const std::vector<LoadedSurvey>& surveys, const std::string& fingerprint,
                         const Trajectory& poses) {
  ContentHash hash;
  AddProgram(&hash).Add(fingerprint);
  for (const LoadedSurvey& loaded : surveys) {
    AddFilesOf(loaded.survey, &hash);
    for (const SurveyFrame& frame : loaded.survey.frames) {
      AddFile(loaded.survey.ImagePath(frame), &hash).Add(frame.stamp_ns);
    }
  }
  for (const StampedPose3& row : poses) {
    const Pose2 pose = row.ToPose2();
    hash.Add(row.stamp_ns).Add(pose.x()).Add(pose.y()).Add(pose.yaw());
  }
  return hash.Hex();
}

std::optional<Placement> RestorePlacement(const std::string& key, std::size_t frames, BuildJournal* journal) {
  const auto piece = journal->Get(key);
  if (!piece) {
    return std::nullopt;
  }
  Placement p;
  ByteReader reader(*piece);
  std::uint64_t count = 0;
  std::uint64_t links = 0;
  reader.Read(&count);
  for (std::uint64_t i = 0; i < count && !reader.failed(); ++i) {
    p.map_from_base.push_back(ReadPose(&reader));
    reader.Read(&p.drop_reason.emplace_back());
  }
  reader.Read(&links);
  for (std::uint64_t i = 0; i < links && !reader.failed(); ++i) {
    p.links.push_back(ReadLink(&reader));
  }
  reader.Read(&p.part_sizes);
  reader.Read(&p.repeats_unaided);
  for (int* number : {&p.rejected_links, &p.overlapping_pairs, &p.unmatched_pairs}) {
    reader.Read(number);
  }
  for (double* number : {&p.rms_sigma, &p.rms_m, &p.drift_m, &p.drift_rad}) {
    reader.Read(number);
  }
  reader.Read(&p.control_points.left_out);
  reader.Read(&p.control_points.scale);
  return reader.Complete() && FitsFrames(p, frames) ? std::optional(std::move(p)) : std::nullopt;
}

std::optional<std::vector<PosePriorFactor>> RestoreFixes(const std::string& key, std::size_t frames,
                                                         BuildJournal* journal) {
  const auto piece = journal->Get(key);
  if (!piece) {
    return std::nullopt;
  }
  std::vector<PosePriorFactor> fixes;
  ByteReader reader(*piece);
  std::uint64_t count = 0;
  reader.Read(&count);
  for (std::uint64_t i = 0; i < count && !reader.failed(); ++i) {
    PosePriorFactor fix;
    reader.Read(&fix.frame);
    fix.map_from_base = ReadPose(&reader).value_or(Pose2());
    ReadMatrix(&reader, &fix.covariance);
    fixes.push_back(fix);
  }
  const bool fit = std::all_of(fixes.begin(), fixes.end(),
                               [frames](const PosePriorFactor& fix) { return IsFrame(fix.frame, frames); });
  return reader.Complete() && fit ? std::optional(std::move(fixes)) : std::nullopt;
}

void StoreFixes(const std::vector<PosePriorFactor>& fixes, const std::string& key, BuildJournal* journal) {
  ByteWriter writer;
  writer.Add(static_cast<std::uint64_t>(fixes.size()));
  for (const PosePriorFactor& fix : fixes) {
    writer.Add(fix.frame);
    AddPose(fix.map_from_base, &writer);
    AddMatrix(fix.covariance, &writer);
  }
  journal->Put(key, writer.Take());
  journal->Flush();
}

void StorePlacement(const Placement& p, const std::string& key, BuildJournal* journal) {
  ByteWriter writer;
  writer.Add(static_cast<std::uint64_t>(p.map_from_base.size()));
  for (std::size_t i = 0; i < p.map_from_base.size(); ++i) {
    AddPose(p.map_from_base[i], &writer);
    writer.Add(p.drop_reason[i]);
  }
  writer.Add(static_cast<std::uint64_t>(p.links.size()));
  for (const Link& link : p.links) {
    AddLink(link, &writer);
  }
  writer.Add(p.part_sizes).Add(p.repeats_unaided).Add(p.rejected_links).Add(p.overlapping_pairs).Add(p.unmatched_pairs);
  writer.Add(p.rms_sigma).Add(p.rms_m).Add(p.drift_m).Add(p.drift_rad);
  writer.Add(p.control_points.left_out).Add(p.control_points.scale);
  journal->Put(key, writer.Take());
  journal->Flush();
}

}  // namespace floorloc
