// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace floorloc {

/// Invalid external input. what() is one sentence: "FILE[:LINE]: what is wrong; what to do".
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  InputError(const std::filesystem::path& file, const std::string& reason)
      : std::runtime_error(file.string() + ": " + reason) {}
  InputError(const std::filesystem::path& file, int line, const std::string& reason)
      : std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + reason) {}
};

}  // namespace floorloc
