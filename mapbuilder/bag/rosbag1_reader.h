// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "mapbuilder/bag/bag_reader.h"
#include "mapbuilder/bag/byte_source.h"

namespace floorloc {

/// Reads bags of ROS 1, version 2.0 (wiki.ros.org/Bags/Format/2.0), by their chunks alone: unindexed ones (.bag.active)
/// too. Throws InputError.
std::unique_ptr<BagReader> ReadRosbag1(std::unique_ptr<ByteSource> source);

}  // namespace floorloc
