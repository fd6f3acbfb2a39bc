// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace floorloc {

/// What Check() says of options; empty when they pass.
template <typename Options>
std::string Diagnostic(const Options& options) {
  try {
    options.Check();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

/// A table of one Options struct's bad fields: the defaults pass, and each bad value, NaN among them, is refused by the
/// field's name.
template <typename Options>
class OptionTable {
 public:
  OptionTable() { EXPECT_EQ(Diagnostic(Options()), ""); }
  explicit OptionTable(const Options& good) : good_(good) { EXPECT_EQ(Diagnostic(good), ""); }

  template <typename Number>
  OptionTable& Refuses(const std::string& name, Number Options::*field,
                       std::initializer_list<std::type_identity_t<Number>> bad) {
    for (const Number value : bad) {
      ExpectRefused(name, field, value);
    }
    if constexpr (std::is_floating_point_v<Number>) {
      ExpectRefused(name, field, std::numeric_limits<Number>::quiet_NaN());
    }
    return *this;
  }

  /// For options that embed RunOptions.
  OptionTable& RefusesBadRun() {
    Options options = good_;
    options.run.threads = -1;
    EXPECT_THAT(Diagnostic(options), testing::HasSubstr("threads"));
    return *this;
  }

 private:
  template <typename Number>
  void ExpectRefused(const std::string& name, Number Options::*field, Number value) {
    Options options = good_;
    options.*field = value;
    EXPECT_THAT(Diagnostic(options), testing::HasSubstr(name)) << value;
  }

  Options good_;
};

}  // namespace floorloc
