// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Prints what arrives over LCM, one line of "key=value" words a message, for the scenario tests.
// Usage: lcm_tap SECONDS [MAX_POSES]              ends after that time, or that many poses
//        lcm_tap hint X Y Z YAW_RAD RADIUS AGE_S   sends a hint that was true some seconds ago
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <lcm/lcm-cpp.hpp>

#include "bot_core/pose_t.hpp"
#include "camloc/pose_hint_t.hpp"
#include "camloc/pose_t.hpp"
#include "camloc/status_t.hpp"

namespace {

struct Tap {
  long num_poses = 0;

  void on_pose(const lcm::ReceiveBuffer* buffer, const std::string&, const camloc::pose_t* m) {
    ++num_poses;
    std::printf(
        "pose seq=%lld utime=%lld received=%lld state=%d reason=%d map=%016llx parent=%s reset=%d inliers=%d x=%.6f y=%.6f z=%.6f\n",
        static_cast<long long>(m->sequence), static_cast<long long>(m->utime), static_cast<long long>(buffer->recv_utime), m->state,
        m->reason, static_cast<unsigned long long>(m->map_id), m->parent_frame.c_str(), m->reset_counter, m->num_inliers, m->pos[0],
        m->pos[1], m->pos[2]);
  }
  void on_status(const lcm::ReceiveBuffer*, const std::string&, const camloc::status_t* m) {
    std::printf(
        "status state=%d received=%lld dropped=%lld published=%lld rss=%lld reloads=%lld failures=%lld camera=%s stalls=%lld "
        "restarts=%lld reopens=%lld resets=%lld recovery_ms=%.1f packets_lost=%lld incomplete=%lld unpaired=%lld text=%s\n",
        m->state, static_cast<long long>(m->frames_received), static_cast<long long>(m->frames_dropped),
        static_cast<long long>(m->poses_published), static_cast<long long>(m->rss_bytes), static_cast<long long>(m->map_reloads),
        static_cast<long long>(m->map_reload_failures), m->camera_state.c_str(), static_cast<long long>(m->camera_stalls),
        static_cast<long long>(m->stream_restarts), static_cast<long long>(m->device_reopens), static_cast<long long>(m->device_resets),
        m->last_recovery_ms, static_cast<long long>(m->packets_lost), static_cast<long long>(m->frames_incomplete),
        static_cast<long long>(m->frames_unpaired), m->state_text.c_str());
  }
  void on_bot_core(const lcm::ReceiveBuffer*, const std::string&, const bot_core::pose_t* m) {
    std::printf("bot_core utime=%lld x=%.6f\n", static_cast<long long>(m->utime), m->pos[0]);
  }
};

int send_hint(char** numbers) {
  lcm::LCM lcm("udpm://239.255.76.67:7667?ttl=0");
  const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
  camloc::pose_hint_t hint{};
  for (int axis = 0; axis < 3; ++axis) hint.pos[axis] = std::atof(numbers[axis]);
  hint.yaw_rad = std::atof(numbers[3]);
  hint.radius_m = std::atof(numbers[4]);
  hint.utime = std::chrono::duration_cast<std::chrono::microseconds>(since_epoch).count() - std::llround(1e6 * std::atof(numbers[5]));
  return lcm.good() && lcm.publish("CAMLOC_HINT", &hint) == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  if (std::strcmp(argv[1], "hint") == 0) return argc == 8 ? send_hint(argv + 2) : 2;
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const double seconds = std::atof(argv[1]);
  const long max_poses = argc > 2 ? std::atol(argv[2]) : 0;
  lcm::LCM lcm("udpm://239.255.76.67:7667?ttl=0");
  if (!lcm.good()) return 1;
  Tap tap;
  lcm.subscribe("CAMLOC_POSE", &Tap::on_pose, &tap)->setQueueCapacity(1000);
  lcm.subscribe("CAMLOC_STATUS", &Tap::on_status, &tap);
  lcm.subscribe("POSE", &Tap::on_bot_core, &tap)->setQueueCapacity(1000);
  std::printf("ready\n");
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (std::chrono::steady_clock::now() < end && (max_poses == 0 || tap.num_poses < max_poses)) lcm.handleTimeout(50);
  return 0;
}
