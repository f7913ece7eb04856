// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A small map to damage, and how opening it must answer.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/map/map_view.h"
#include "core/map/map_writer.h"
#include "tests/map/synthetic_map.h"

namespace camloc::testing {

inline std::vector<std::byte> small_map(const testing::SyntheticMapOptions& options = {}) {
  const auto bytes = serialize_map(make_synthetic_map(options));
  EXPECT_TRUE(bytes.is_ok()) << bytes.status().message();
  return *bytes;
}

inline Status open_status(const std::string& path) {
  const Result<MapView> view = MapView::open(path);
  return view.is_ok() ? Status::ok() : view.status();
}

/// With the path, the reason and an advice, in one line.
inline void expect_refused(const std::string& path, ErrorCode code, const std::string& reason) {
  const Status status = open_status(path);
  EXPECT_EQ(status.code(), code) << status.message();
  EXPECT_NE(status.message().find(path), std::string::npos) << status.message();
  EXPECT_NE(status.message().find(reason), std::string::npos) << status.message() << " does not say: " << reason;
  EXPECT_EQ(status.message().find('\n'), std::string::npos) << status.message();
  EXPECT_NE(status.message().find(';'), std::string::npos) << status.message() << " gives no advice";
}

}  // namespace camloc::testing
