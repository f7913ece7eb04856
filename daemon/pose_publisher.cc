// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Filling, encoding and sending of messages.
#include "daemon/pose_publisher.h"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "core/base/unique_fd.h"

namespace camloc {
namespace {

constexpr double kUnknownVariance = 1e6;
constexpr std::int64_t kMaxAge_ns = 10'000'000'000;  // older than that is not this machine's clock

template <typename Integer>
std::int32_t clip(Integer value) {
  if (std::cmp_greater(value, std::numeric_limits<std::int32_t>::max())) return std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(value);
}

std::int32_t age_us(std::int64_t epoch_ns, const PoseContext& context) {
  const std::int64_t age_ns = context.now_epoch_ns - epoch_ns;
  const bool is_known = context.is_capture_clock_ours && age_ns >= 0 && age_ns < kMaxAge_ns;
  return is_known ? clip(age_ns / 1000) : -1;
}

void fill_geometry(const PoseWithCovariance& pose, pose_t* message) {
  Eigen::Map<Eigen::Vector3d>(message->pos) = pose.pose.translation;
  const Eigen::Quaterniond& q = pose.pose.rotation;
  const std::array<double, 4> wxyz = {q.w(), q.x(), q.y(), q.z()};
  std::copy(wxyz.begin(), wxyz.end(), message->orientation);
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message->covariance) = pose.covariance;
}

// lcm_create() explains a missing route in twenty lines on stderr, every time. Ask the kernel the same question first.
Status probe_route(const std::string& url) {
  constexpr const char* kScheme = "udpm://";
  if (url.rfind(kScheme, 0) != 0) return Status::ok();
  const std::string host = url.substr(std::strlen(kScheme), url.find_first_of(":?", std::strlen(kScheme)) - std::strlen(kScheme));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(7667);
  if (::inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) return Status::ok();  // LCM's business
  const UniqueFd probe(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return Status::ok();
  return {ErrorCode::kUnavailable,
          "no route for " + url + " (" + std::strerror(errno) + "); on a machine without network: ip route add 224.0.0.0/4 dev lo"};
}

}  // namespace

void fill_pose(const Localization& localization, const PoseContext& context, pose_t* message) {
  const std::int64_t epoch_ns = localization.stamp_ns + context.stamp_to_epoch_ns;
  message->utime = epoch_ns / 1000;
  message->sequence = static_cast<std::int64_t>(localization.sequence);
  message->map_id = static_cast<std::int64_t>(context.map_id);
  message->parent_frame = context.datum != nullptr ? "wcs" : "map";
  message->child_frame = "camera";
  message->state = static_cast<std::int8_t>(localization.state);
  message->reason = static_cast<std::int8_t>(localization.reason);
  message->reason_text = to_string(localization.reason);
  message->quality = static_cast<std::int8_t>(localization.has_pose ? std::clamp(localization.quality, 0, 100) : -1);
  message->num_features = clip(localization.num_features);
  message->num_matches = clip(localization.evidence.num_matches);
  message->num_inliers = clip(localization.evidence.num_inliers);
  message->reset_counter = clip(std::uint64_t{localization.reset_counter} + context.reset_offset);
  message->jump_m = localization.jump_m;
  for (std::size_t i = 0; i < localization.stage_ns.size(); ++i) message->latency_us[i] = clip(localization.stage_ns[i] / 1000);
  message->age_us = age_us(epoch_ns, context);

  PoseWithCovariance pose{Rigid3(), Matrix6d::Identity() * kUnknownVariance};
  if (localization.has_pose) pose = {localization.T_map_camera, localization.covariance};
  if (localization.has_pose && context.datum != nullptr) pose = to_wcs(*context.datum, pose);
  fill_geometry(pose, message);
}

void fill_bot_core(const pose_t& pose, bot_core::pose_t* message) {
  *message = bot_core::pose_t{};
  message->utime = pose.utime;
  std::copy_n(pose.pos, 3, message->pos);
  std::copy_n(pose.orientation, 4, message->orientation);
}

PosePublisher::PosePublisher(const PublishOptions& options) : options_(options), pose_(), bot_core_pose_(), buffer_() {
  constexpr std::size_t kLongestReason = 128;
  pose_.reason_text.reserve(kLongestReason);
}

Status PosePublisher::connect() {
  if (lcm_) return Status::ok();
  if (const Status status = probe_route(options_.lcm_url); !status) return status;
  lcm_.reset(lcm_create(options_.lcm_url.c_str()));
  if (lcm_) return Status::ok();
  return {ErrorCode::kUnavailable, "LCM does not open " + options_.lcm_url + "; see publish.lcm_url"};
}

bool PosePublisher::publish(const Localization& localization, const PoseContext& context) {
  fill_pose(localization, context, &pose_);
  if (!send(options_.pose_channel, pose_)) return false;
  ++num_poses_;
  if (localization.state != State::kLocalized || options_.bot_core_channel.empty()) return true;
  fill_bot_core(pose_, &bot_core_pose_);
  return send(options_.bot_core_channel, bot_core_pose_);
}

bool PosePublisher::publish(const status_t& status) { return send(options_.status_channel, status); }

template <typename Message>
bool PosePublisher::send(const std::string& channel, const Message& message) {
  if (!lcm_) return false;
  const int size = message.encode(buffer_.data(), 0, static_cast<int>(buffer_.size()));
  if (size < 0) return false;
  return lcm_publish(lcm_.get(), channel.c_str(), buffer_.data(), static_cast<unsigned int>(size)) == 0;
}

}  // namespace camloc
