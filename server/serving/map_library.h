// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "server/serving/map_catalog.h"
#include "server/serving/map_changes.h"
#include "server/store/upload_gate.h"
#include "server/store/version_store.h"

namespace floorloc {

struct MapLibraryOptions {
  LocalizerOptions localizer;
  std::size_t max_versions = 16;                         ///< kept of one map
  std::uint64_t max_map_bytes = std::uint64_t{8} << 30;  ///< of one file: 8 GiB are some 10,000 m2
  int max_uploads = 2;                                   ///< at the same time

  /// Throws std::invalid_argument that names the first bad field and what it may be.
  void Check() const;
};

/// How many vehicles of a map keep their pose when another version is served, and how many do not.
struct MoveCounts {
  int kept = 0;
  int lost = 0;
};

/// Why the file NAME.floormap of the maps folder is not served.
struct RefusedFile {
  std::string identity;  ///< FileIdentity
  std::string code;
  std::string error;
};

/// Decides which version of each map is served. Versions are uploaded, or taken from the maps folder: what is put there
/// as NAME.floormap is served as soon as it is whole. Served is the server's own copy, into which nobody writes, and
/// every version is verified as a whole before it is visible. Thread-safe.
class MapLibrary {
 public:
  using OnServed = std::function<MoveCounts(const std::shared_ptr<const LoadedMap>&)>;

  /// Refers to catalog and store, which must outlive it. A store that is not writable: the folder's files are served as
  /// they are. Call LoadAll() next.
  MapLibrary(const std::filesystem::path& folder, const MapLibraryOptions& options, MapCatalog& catalog,
             VersionStore& store);

  /// Loads what is to be served. Throws InputError when the folder can't be read.
  void LoadAll();
  /// Called whenever another version is served from now on. Only before serving: not thread-safe.
  void SetOnServed(OnServed on_served) { on_served_ = std::move(on_served); }
  /// Takes what is new in the folder.
  void TakeFolder();

  std::optional<MapVersions> Versions(const std::string& map) const { return store_.Find(map); }
  std::optional<RefusedFile> Refused(const std::string& map) const;
  const MapChanges& changes() const { return changes_; }

  // All below throw Problem: 400 invalid_parameter; 404 unknown_map, unknown_version; 409 read_only; what VersionStore
  // says; and what stands beside them.

  /// Where the bytes of an upload go. announced_bytes: 0: unknown. 413 map_too_large, 503 upload_busy, 507 disk_full.
  BodyStream Receive(const std::string& map, std::uint64_t announced_bytes);
  struct Added {
    MapVersion version;
    bool created = false;  ///< false: it was there already
  };
  /// Verifies and keeps an upload, and serves it when activate is set, or when no version of the map is served. 409
  /// too_many_versions, 422 map_damaged, map_unsupported.
  Added Add(const std::string& map, IncomingFile& file, bool activate);
  /// version: a content version or "previous". Serves it; requests that have begun finish with the version before. 409
  /// no_previous_version, 500 map_damaged.
  MapChange Activate(const std::string& map, const std::string& version);
  /// 409 version_active.
  void Delete(const std::string& map, const std::string& version);
  /// The map with all its versions. 409 map_in_folder.
  void DeleteMap(const std::string& map);

 private:
  void RequireWritable() const;
  std::filesystem::path FileOf(const std::string& map) const { return folder_ / (map + ".floormap"); }
  void ForgetRefused(const std::string& map);
  bool IsServed(const std::string& map) const;
  void LoadActive(const std::string& map);
  void Take(const std::filesystem::path& file);
  void TakeCopy(const std::filesystem::path& file, const std::string& identity);
  void TakeDirectly(const std::filesystem::path& file, const std::string& identity);
  void Refuse(std::shared_ptr<LoadedMap> map, const std::filesystem::path& file, const std::string& identity);
  MapChange ActivateLoaded(const std::shared_ptr<const LoadedMap>& map, MapVersions versions);
  MapChange Serve(const std::shared_ptr<const LoadedMap>& map, const std::string& previous);

  const std::filesystem::path folder_;
  const MapLibraryOptions options_;
  MapCatalog& catalog_;
  VersionStore& store_;
  OnServed on_served_;
  MapChanges changes_;
  UploadGate gate_;
  std::mutex change_mutex_;  // held while versions are changed; locked before mutex_
  mutable std::mutex mutex_;
  std::map<std::string, RefusedFile> refused_;  // guarded by mutex_
};

}  // namespace floorloc
