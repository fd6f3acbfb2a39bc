// SPDX-License-Identifier: Apache-2.0
#include "server/serving/success_keeper.h"

#include "server/wire/problem.h"

namespace floorloc {
namespace {

void Try(StateFile& state, const std::function<void(const SqliteConnection&)>& change) {
  try {
    state.Write(StateFile::Durability::kProcess, change);
  } catch (const Problem&) {  // logged
  }
}

}  // namespace

std::map<std::string, MapSuccess> RecallSuccess(StateFile& state, const MapCatalog& catalog) {
  std::map<std::string, MapSuccess> remembered;
  state.Read([&](const SqliteConnection& connection) { remembered = ReadSuccess(connection); });
  Try(state, [&](const SqliteConnection& connection) {
    for (const auto& [name, success] : remembered) {
      if (catalog.Find(name) == nullptr) {
        DeleteSuccess(connection, name);
      }
    }
  });
  return remembered;
}

SuccessKeeper::SuccessKeeper(SuccessMap& success, StateFile& state, std::chrono::duration<double> interval)
    : success_(success), state_(state), periodic_(std::make_unique<Periodic>(interval, [this] { Write(); })) {}

SuccessKeeper::~SuccessKeeper() {
  periodic_.reset();
  Write();
}

// One commit for all maps.
void SuccessKeeper::Write() {
  const std::map<std::string, MapSuccess> changes = success_.TakeChanges();
  if (changes.empty()) {
    return;
  }
  Try(state_, [&](const SqliteConnection& connection) {
    for (const auto& [name, success] : changes) {
      WriteSuccess(connection, name, success);
      for (const SuccessSquare& square : success.squares) {
        WriteSuccessSquare(connection, name, square);
      }
    }
  });
}

}  // namespace floorloc
