// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Hints over LCM: what is believed of a datagram, and one that is really sent.
#include "daemon/hint_listener.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <limits>
#include <thread>
#include <vector>

#include "camloc/pose_hint_t.hpp"
#include "camloc/pose_t.hpp"
#include "tests/daemon/private_network.h"

namespace camloc {
namespace {

constexpr std::int64_t kNow_us = 1'800'000'000'000'000;

pose_hint_t good_message() {
  pose_hint_t message{};
  message.utime = kNow_us - 1'000'000;
  message.pos[0] = 1;
  message.pos[1] = -2;
  message.pos[2] = 0.5;
  message.yaw_rad = 1.5;
  message.radius_m = 2;
  return message;
}

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

Result<PoseHint> parse(const pose_hint_t& message) { return parse_hint_message(encoded(message), kNow_us * 1000); }

TEST(HintMessage, IsAHint) {
  const Result<PoseHint> hint = parse(good_message());
  ASSERT_TRUE(hint) << hint.status().message();
  EXPECT_EQ(hint->position_m, Eigen::Vector3d(1, -2, 0.5));
  EXPECT_EQ(hint->yaw_rad, 1.5);
  EXPECT_EQ(hint->radius_m, 2);
}

TEST(HintMessage, WhatMeansNothingIsRefused) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (double pose_hint_t::*field : {&pose_hint_t::yaw_rad, &pose_hint_t::radius_m}) {
      pose_hint_t message = good_message();
      message.*field = bad;
      EXPECT_EQ(parse(message).status().code(), ErrorCode::kInvalid);
    }
    for (int axis = 0; axis < 3; ++axis) {
      pose_hint_t message = good_message();
      message.pos[axis] = bad;
      EXPECT_EQ(parse(message).status().code(), ErrorCode::kInvalid);
    }
  }
  for (const double radius_m : {0.0, -1.0, 20.1}) {
    pose_hint_t message = good_message();
    message.radius_m = radius_m;
    EXPECT_NE(parse(message).status().message().find("at most 20 m"), std::string::npos);
  }
}

TEST(HintMessage, OldOnesAndThoseOfAnotherClockAreRefused) {
  for (const std::int64_t utime : {std::int64_t{0}, kNow_us - 3'000'001, std::numeric_limits<std::int64_t>::min()}) {
    pose_hint_t message = good_message();
    message.utime = utime;
    EXPECT_NE(parse(message).status().message().find("too old"), std::string::npos) << utime;
  }
  for (const std::int64_t utime : {kNow_us + 1'000'001, std::numeric_limits<std::int64_t>::max()}) {
    pose_hint_t message = good_message();
    message.utime = utime;
    EXPECT_NE(parse(message).status().message().find("future"), std::string::npos) << utime;
  }
  pose_hint_t message = good_message();
  message.utime = kNow_us - 3'000'000;
  EXPECT_TRUE(parse(message));
}

TEST(HintMessage, OtherBytesAreRefused) {
  std::vector<std::uint8_t> bytes = encoded(good_message());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(parse_hint_message(std::span(bytes).first(size), kNow_us * 1000)) << size;
  bytes.push_back(0);
  EXPECT_FALSE(parse_hint_message(bytes, kNow_us * 1000)) << "too long";
  pose_t pose{};
  EXPECT_FALSE(parse_hint_message(encoded(pose), kNow_us * 1000)) << "another type";
}

TEST(HintListener, WithoutAProviderItIsUnavailable) {
  HintListener listener("nonsense://", "CAMLOC_HINT", [](const Result<PoseHint>&) {});
  EXPECT_EQ(listener.connect().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(listener.fd(), -1);
}

/// Sends to a listener, in a network that nobody else is in; what it was handed.
std::vector<Result<PoseHint>> hear(const std::vector<std::pair<std::string, std::vector<std::uint8_t>>>& messages) {
  constexpr const char* kUrl = "udpm://239.255.76.67:7667?ttl=0";
  std::vector<Result<PoseHint>> heard;
  HintListener listener(kUrl, "HINT.", [&heard](const Result<PoseHint>& hint) { heard.push_back(hint); });
  EXPECT_TRUE(listener.connect());
  EXPECT_TRUE(listener.connect()) << "a second time is nothing";
  const Lcm sender(lcm_create(kUrl));
  for (const auto& [channel, bytes] : messages) {
    lcm_publish(sender.get(), channel.c_str(), bytes.data(), static_cast<unsigned int>(bytes.size()));
    pollfd waiting{listener.fd(), POLLIN, 0};
    if (::poll(&waiting, 1, 5000) == 1) listener.handle(kNow_us * 1000);
  }
  return heard;
}

TEST(HintListener, HearsItsChannelOnly) {
  std::vector<Result<PoseHint>> heard;
  bool has_network = false;
  std::thread([&] {
    has_network = testing::enter_private_network();
    // "HINT." as a regular expression matches the second, too.
    if (has_network) heard = hear({{"HINT.", encoded(good_message())}, {"HINT2", encoded(good_message())}, {"HINT.", {1, 2, 3}}});
  }).join();
  if (!has_network) GTEST_SKIP() << "needs a network namespace of its own";
  ASSERT_EQ(heard.size(), 2U);
  ASSERT_TRUE(heard[0]) << heard[0].status().message();
  EXPECT_EQ(heard[0]->radius_m, 2);
  EXPECT_NE(heard[1].status().message().find("no camloc.pose_hint_t"), std::string::npos);
}

}  // namespace
}  // namespace camloc
