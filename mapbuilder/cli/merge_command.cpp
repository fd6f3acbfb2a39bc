// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "mapbuilder/cli/command.h"
#include "mapbuilder/finished_map/map_lattices.h"
#include "mapbuilder/merge/merge_maps.h"

namespace floorloc {
namespace {

struct Arguments {
  MergeOptions options;
  bool json = false;
};

void Print(const MergeReport& r, const MergeOptions& options, bool json) {
  if (json) {
    const nlohmann::ordered_json report{{"frames", r.frames},
                                        {"shared_frames", r.shared_frames},
                                        {"bent_m", r.deformation_m},
                                        {"keypoints", r.keypoints},
                                        {"shared_keypoints", r.shared_keypoints},
                                        {"area_m2", r.area_m2},
                                        {"lattices", LatticesJson(r.lattices)},
                                        {"content_version", r.content_version},
                                        {"warnings", r.warnings}};
    std::cout << report.dump(2) << "\n";
    return;
  }
  std::printf("%s\n  frames       %d, %d of the second map's show floor of the first\n", options.out.c_str(), r.frames,
              r.shared_frames);
  std::printf("  deformed     by up to %.2f mm to align with the first\n", 1e3 * r.deformation_m);
  std::printf("  floor        %.2f m2\n  keypoints    %d, %d of them in both\n", r.area_m2, r.keypoints,
              r.shared_keypoints);
  for (const MapLattice& lattice : r.lattices) {
    std::printf("  lattice      %s\n", LatticeSentence(lattice).c_str());
  }
  std::printf("  version      %s\n", r.content_version.substr(0, 16).c_str());
  for (const std::string& warning : r.warnings) {
    std::printf("  WARNING      %s\n", warning.c_str());
  }
}

void Run(Arguments& a) {
  a.options.alignment.run.progress = ProgressOutput::Stderr();
  Print(MergeMaps(a.options), a.options, a.json);
}

}  // namespace

void AddMergeCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("merge", "Makes one map of two that overlap");
  const auto a = std::make_shared<Arguments>();
  command->add_option("first", a->options.first, "Map file; gives the frame")->required();
  command->add_option("second", a->options.second, "Map file")->required();
  command->add_option("--out", a->options.out, "Map file to write (NAME.floormap)")->required();
  command->add_flag("--same-frame", a->options.alignment.same_frame,
                    "Both have one frame already (control points, poses of one system); they need not overlap");
  command->add_option("--threads", a->options.alignment.run.threads, "Number of threads; 0: one per core")
      ->capture_default_str();
  command->add_option("--seed", a->options.alignment.seed, "Seed of all random choices")->capture_default_str();
  command->add_flag("--json", a->json, "Print the report as JSON");
  command->callback([a] { Run(*a); });
}

}  // namespace floorloc
