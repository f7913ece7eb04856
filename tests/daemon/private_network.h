// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A network namespace for one thread, with a route for multicast and nobody else in it.
#pragma once

#include <net/if.h>
#include <net/route.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <cstdint>
#include <cstring>

#include "core/base/unique_fd.h"

namespace camloc::testing {

/// Multicast on a loop-back of our own, so that messages are really sent and reach nobody. False where not permitted.
inline bool enter_private_network() {
  if (::unshare(CLONE_NEWNET) != 0) return false;
  const UniqueFd control(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq interface {};
  std::strcpy(interface.ifr_name, "lo");
  interface.ifr_flags = IFF_UP | IFF_RUNNING;
  if (::ioctl(control.get(), SIOCSIFFLAGS, &interface) != 0) return false;
  const auto address = [](std::uint32_t value) {
    sockaddr_in ipv4{};
    ipv4.sin_family = AF_INET;
    ipv4.sin_addr.s_addr = htonl(value);
    sockaddr generic{};
    std::memcpy(&generic, &ipv4, sizeof(generic));
    return generic;
  };
  rtentry route{};
  route.rt_dst = address(0xe0000000);
  route.rt_genmask = address(0xf0000000);
  route.rt_flags = RTF_UP;
  char device[] = "lo";
  route.rt_dev = device;
  return ::ioctl(control.get(), SIOCADDRT, &route) == 0;
}

}  // namespace camloc::testing
