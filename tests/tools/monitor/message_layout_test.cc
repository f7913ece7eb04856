// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the daemon sends passes; what has a length that is not true does not, and is not decoded.
#include "tools/monitor/message_layout.h"

#include <gtest/gtest.h>

#include <vector>

namespace camloc::tools {
namespace {

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

pose_t some_pose() {
  pose_t pose{};
  pose.parent_frame = "map";
  pose.child_frame = "camera";
  pose.reason_text = "too few inliers";
  return pose;
}

TEST(MessageLayout, WhatTheDaemonSendsPasses) {
  pose_t pose;
  ASSERT_TRUE(decode_message(encoded(some_pose()), kPoseLayout, &pose));
  EXPECT_EQ(pose.reason_text, "too few inliers");
  status_t sent{};
  sent.state_text = "fine";
  sent.camera_state = "streaming";
  status_t status;
  ASSERT_TRUE(decode_message(encoded(sent), kStatusLayout, &status));
  EXPECT_EQ(status.camera_state, "streaming");
  EXPECT_FALSE(decode_message(encoded(sent), kPoseLayout, &pose)) << "another type";
}

TEST(MessageLayout, AnyCutAndAnythingMoreIsRefused) {
  const std::vector<std::uint8_t> bytes = encoded(some_pose());
  for (std::size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(has_layout(std::span(bytes).first(size), kPoseLayout)) << size;
  std::vector<std::uint8_t> longer = bytes;
  longer.push_back(0);
  EXPECT_FALSE(has_layout(longer, kPoseLayout));
}

TEST(MessageLayout, NoLengthOfAStringIsBelieved) {
  const std::vector<std::uint8_t> good = encoded(some_pose());
  for (const std::size_t first_string : {std::size_t{32}, std::size_t{32 + 4 + 4}}) {  // parent_frame, child_frame
    for (const std::uint32_t length : {0U, 0x80000000U, 0xffffffffU, 0x7fffffffU, 5000U}) {
      std::vector<std::uint8_t> bytes = good;
      for (std::size_t k = 0; k < 4; ++k) bytes[first_string + k] = static_cast<std::uint8_t>(length >> (24 - 8 * k));
      pose_t pose;
      EXPECT_FALSE(decode_message(bytes, kPoseLayout, &pose)) << length;
    }
  }
}

}  // namespace
}  // namespace camloc::tools
