// SPDX-License-Identifier: Apache-2.0
#include "server/bridge/bridge.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "server/bridge/server_reports.h"
#include "server/wire/strict_json.h"
#include "server/wire/unix_time.h"

namespace floorloc {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kMaxInbox = 10'000;  // jobs; what the broker sends beyond is dropped
constexpr std::size_t kMaxTasks = 50;      // of each worker
constexpr milliseconds kTick{100};
constexpr double kRefreshPeriodS = 30.0;  // of maps and vehicles, beyond what events tell
constexpr double kRefusalWaitS = 5.0;     // before a server that refused events is asked again

client::EventOptions MakeEventOptions() {
  client::EventOptions options;
  options.types = {"pose", "status", "fix", "vehicle", "map"};
  options.patience = milliseconds(0);
  return options;
}

bool IsQuick(const ServerTask& task) { return std::holds_alternative<InitPosition>(task.command); }

}  // namespace

client::ClientOptions ServerOptions(const BridgeConfig& config, const BridgeSecrets& secrets) {
  client::ClientOptions options;
  options.url = config.server_url;
  options.token = secrets.server_token;
  return options;
}

Bridge::Bridge(const BridgeConfig& config, const BridgeSecrets& secrets)
    : config_((config.Check(), config)),
      inbox_(kMaxInbox),
      events_(ServerOptions(config, secrets), MakeEventOptions()),
      quick_client_(ServerOptions(config, secrets)),
      slow_client_(ServerOptions(config, secrets)),
      quick_(std::make_unique<Worker>(kMaxTasks)),
      slow_(std::make_unique<Worker>(kMaxTasks)) {
  for (const BridgedVehicle& vehicle : config.vehicles) {
    lines_.push_back(MakeLine(vehicle, secrets.broker_password));
  }
}

Bridge::~Bridge() {
  Stop();
  quick_.reset();
  slow_.reset();
  if (listener_.joinable()) {
    listener_.join();
  }
}

Bridge::Line Bridge::MakeLine(const BridgedVehicle& vehicle, const std::string& password) {
  const std::size_t index = lines_.size();
  Line line;
  line.vehicle = std::make_unique<VehicleBridge>(
      vehicle, config_.version, config_.behaviour,
      VehicleBridge::Outputs{
          [this, index](const OutgoingMessage& message) { lines_[index].connection->Publish(message); },
          [this](const ServerTask& task) { return RunTask(task); }, UnixTimeNow});
  MqttHandlers handlers;
  // In the thread of the connection, so the counters of the vehicle's headers are out of reach.
  handlers.last_will = [format = &FormatOf(config_.version), identity = vehicle.identity] {
    const std::string topic = format->TopicRoot(identity) + "/connection";
    return OutgoingMessage{
        topic, ToText(format->FormatConnection({0, UnixTimeNow(), identity}, ConnectionState::kBroken)), 1, true};
  };
  handlers.on_connected = [this, index] {
    inbox_.TryPush([this, index] { lines_[index].vehicle->OnBrokerConnected(Now()); });
  };
  handlers.on_message = [this, index](const std::string& topic, std::string payload) {
    const bool taken = inbox_.TryPush([this, index, topic, payload = std::move(payload)] {
      lines_[index].vehicle->OnMessage(topic, payload, Now());
    });
    if (!taken) {
      spdlog::warn("a message of {} was dropped: too many wait", topic);
    }
  };
  line.connection = std::make_unique<MqttConnection>(config_.broker, password, "floorloc-bridge-" + vehicle.id,
                                                     line.vehicle->Subscriptions(), std::move(handlers));
  return line;
}

double Bridge::Now() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

template <typename Visit>
void Bridge::ForVehicle(const std::string& id, Visit visit) {
  for (Line& line : lines_) {
    if (line.vehicle->vehicle().id == id) {
      visit(*line.vehicle);
    }
  }
}

bool Bridge::RunTask(const ServerTask& task) {
  const auto run = [this, task](client::Client& client) {
    TaskResult result = floorloc::RunTask(task, config_.downloads, stopping_, client);
    spdlog::info("{}: action {}: {}", task.vehicle, task.action_id,
                 result.succeeded ? "done" : "failed: " + result.sentence);
    inbox_.Push([this, vehicle = task.vehicle, result = std::move(result)] {
      ForVehicle(vehicle, [&](VehicleBridge& bridge) { bridge.OnTaskResult(result, Now()); });
    });
  };
  return IsQuick(task) ? quick_->TryPush([this, run] { run(quick_client_); })
                       : slow_->TryPush([this, run] { run(slow_client_); });
}

void Bridge::ListenToServer() {
  const client::EventStream::Handler handler = {
      [this](const client::Event& event) { OnEvent(event); },
      [this](bool connected) {
        inbox_.Push([this, connected] {
          spdlog::info("floorloc-server {}", connected ? "tells its events" : "tells no events any more");
          server_connected_ = connected;
          if (connected) {
            Refresh();
            return;
          }
          for (Line& line : lines_) {
            line.vehicle->OnServer(false, Now());
          }
        });
      }};
  while (!stopping_) {
    try {
      events_.Run(handler);
    } catch (const client::CallError& error) {
      spdlog::error("floorloc-server tells no events: {}", error.what());
    }
    const double end_s = Now() + kRefusalWaitS;
    while (!stopping_ && Now() < end_s) {
      std::this_thread::sleep_for(kTick);
    }
  }
}

void Bridge::OnEvent(const client::Event& event) {
  inbox_.Push([this, event] {
    try {
      Dispatch(event);
    } catch (const JsonError& error) {
      spdlog::warn("an event '{}' of floorloc-server is not as documented: {}", event.type, error.what());
    }
  });
}

void Bridge::Dispatch(const client::Event& event) {
  if (event.type == "pose") {
    const PoseReport report = ParsePoseEvent(event.data);
    ForVehicle(report.vehicle, [&](VehicleBridge& vehicle) { vehicle.OnPose(report, Now()); });
  } else if (event.type == "status") {
    const StatusReport report = ParseStatusEvent(event.data);
    ForVehicle(report.vehicle, [&](VehicleBridge& vehicle) { vehicle.OnStatus(report, Now()); });
  } else if (event.type == "fix") {
    const FixReport fix = ParseFix(event.data);
    ForVehicle(fix.vehicle, [&](VehicleBridge& vehicle) { vehicle.OnFix(fix, Now()); });
  } else {
    Refresh();  // of vehicles and maps, or of all after a gap
  }
}

// In the worker, since it asks the server; one at a time.
void Bridge::Refresh() {
  next_refresh_s_ = Now() + kRefreshPeriodS;
  if (refreshing_) {
    next_refresh_s_ = Now();
    return;
  }
  refreshing_ = quick_->TryPush([this] {
    try {
      auto vehicles = ParseVehicleList(quick_client_.ListVehicles());
      auto maps = ListMapEntries(quick_client_);
      inbox_.Push([this, vehicles = std::move(vehicles), maps = std::move(maps)] { Apply(vehicles, maps); });
    } catch (const std::exception& error) {
      spdlog::warn("vehicles and maps of floorloc-server are unknown: {}", error.what());
      inbox_.Push([this] {
        refreshing_ = false;
        next_refresh_s_ = Now() + kRefusalWaitS;
      });
    }
  });
}

void Bridge::Apply(const std::vector<VehicleReport>& vehicles, const std::vector<MapEntry>& maps) {
  refreshing_ = false;
  for (Line& line : lines_) {
    const auto report = std::find_if(vehicles.begin(), vehicles.end(), [&](const VehicleReport& one) {
      return one.pose.vehicle == line.vehicle->vehicle().id;
    });
    line.vehicle->OnServer(server_connected_, Now());
    line.vehicle->OnSnapshot(report != vehicles.end() ? std::optional(*report) : std::nullopt, Now());
    line.vehicle->OnMaps(maps, Now());
  }
}

void Bridge::OnTime() {
  if (server_connected_ && Now() >= next_refresh_s_) {
    Refresh();
  }
  for (Line& line : lines_) {
    line.vehicle->OnTime(Now());
  }
}

void Bridge::Run() {
  for (Line& line : lines_) {
    line.connection->Start();
  }
  listener_ = std::thread([this] { ListenToServer(); });
  double next_tick_s = 0.0;
  const auto step = [&] {
    const bool open = inbox_.RunNext(kTick);
    if (open && Now() >= next_tick_s) {
      next_tick_s = Now() + 1e-3 * static_cast<double>(kTick.count());
      OnTime();
    }
    return open;
  };
  for (bool open = true; open && !stopping_;) {
    try {
      open = step();
    } catch (const std::exception& error) {
      spdlog::error("something was not done: {}", error.what());  // the other vehicles go on
    }
  }
  for (Line& line : lines_) {
    line.connection->Close(line.vehicle->ConnectionMessage(ConnectionState::kOffline));
  }
}

void Bridge::Stop() {
  stopping_ = true;
  inbox_.Close();
  events_.Stop();
}

}  // namespace floorloc
