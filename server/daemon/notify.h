// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace floorloc {

/// Tells the service manager what the process does, as systemd's Type=notify wants it: lines such as READY=1,
/// RELOADING=1, STOPPING=1, STATUS=one line of text, in one datagram to the socket that the environment variable
/// NOTIFY_SOCKET names (sd_notify(3)). Returns false when there is none, or it does not take the message; the server
/// runs without it as well.
bool NotifyManager(const std::string& lines);

/// The lines that begin a reload; READY=1 ends it.
std::string ReloadingLines();

}  // namespace floorloc
