// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace floorloc {

/// What limits per client address count as one client: an IPv4 address, also one that is mapped into IPv6, or the first
/// 64 bits of an IPv6 address, of which one machine has all the others.
std::string AddressGroup(const std::string& address);

}  // namespace floorloc
