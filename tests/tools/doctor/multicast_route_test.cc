// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tools/doctor/doctor_checks.h"

namespace camloc::tools {
namespace {

TEST(MulticastRouteTest, UrlsWithoutANetworkNeedNone) {
  for (const char* url : {"file:///tmp/log?mode=r", "memq://"}) {
    const auto route = find_multicast_route(url);
    ASSERT_TRUE(route.is_ok()) << url;
    EXPECT_EQ(route->group, "");
  }
}

TEST(MulticastRouteTest, ReadsGroupPortAndTtl) {
  const auto route = find_multicast_route("udpm://127.0.0.1:7667?recv_buf_size=100&ttl=3&x=y");  // routed on every machine with lo up
  if (!route) GTEST_SKIP() << "no loopback: " << route.status().message();
  EXPECT_EQ(route->group, "127.0.0.1");
  EXPECT_EQ(route->local_address, "127.0.0.1");
  EXPECT_EQ(route->ttl, 3);
}

TEST(MulticastRouteTest, RefusesWhatIsNoLcmUrl) {
  for (const char* url : {"", "239.255.76.67", "tcp://1.2.3.4", "udpm://1.2.3:7667", "udpm://239.1.1.1:99999", "udpm://239.1.1.1:x",
                          "udpm://239.1.1.1:7667?ttl=256", "udpm://239.1.1.1:7667?ttl=-1", "udpm://host.example:7667"}) {
    const auto route = find_multicast_route(url);
    ASSERT_FALSE(route.is_ok()) << url;
    EXPECT_EQ(route.status().code(), ErrorCode::kInvalid) << url;
  }
}

}  // namespace
}  // namespace camloc::tools
