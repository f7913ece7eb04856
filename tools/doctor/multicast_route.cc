// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "core/base/unique_fd.h"
#include "core/io/text.h"
#include "tools/doctor/doctor_checks.h"

namespace camloc::tools {
namespace {

bool parse_number(const std::string& text, int max, int* number) {
  const std::optional<std::int64_t> value = parse_int(text);
  if (!value || *value < 0 || *value > max) return false;
  *number = static_cast<int>(*value);
  return true;
}

/// udpm://GROUP:PORT?key=value&... ; LCM's own defaults where a part is left out.
bool parse_udpm(const std::string& url, sockaddr_in* address, MulticastRoute* route) {
  const std::string rest = url.substr(std::strlen("udpm://"));
  const std::string network = rest.substr(0, rest.find('?'));
  const std::string query = rest.find('?') == std::string::npos ? "" : rest.substr(rest.find('?') + 1);
  const std::size_t colon = network.find(':');
  route->group = network.substr(0, colon).empty() ? "239.255.76.67" : network.substr(0, colon);
  int port = 7667;
  if (colon != std::string::npos && !parse_number(network.substr(colon + 1), 65535, &port)) return false;
  const std::size_t ttl = query.find("ttl=");
  if (ttl != std::string::npos) {
    const std::string value = query.substr(ttl + 4);
    if (!parse_number(value.substr(0, value.find('&')), 255, &route->ttl)) return false;
  }
  address->sin_family = AF_INET;
  address->sin_port = htons(static_cast<std::uint16_t>(port));
  return ::inet_pton(AF_INET, route->group.c_str(), &address->sin_addr) == 1;
}

}  // namespace

Result<MulticastRoute> find_multicast_route(const std::string& lcm_url) {
  MulticastRoute route;
  if (lcm_url.rfind("file://", 0) == 0 || lcm_url.rfind("memq://", 0) == 0) return route;
  sockaddr_in group{};
  if (lcm_url.rfind("udpm://", 0) != 0 || !parse_udpm(lcm_url, &group, &route)) {
    return {ErrorCode::kInvalid, "'" + lcm_url + "' is not an LCM URL; an example is " + kDefaultLcmUrl};
  }
  const UniqueFd fd(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (!fd.is_open()) return {ErrorCode::kIo, std::string("cannot make a UDP socket: ") + std::strerror(errno)};
  // Connecting a datagram socket sends nothing: the kernel only looks up the route.
  if (::connect(fd.get(), reinterpret_cast<const sockaddr*>(&group), sizeof(group)) != 0) {
    return {ErrorCode::kUnavailable,
            "no multicast route to " + route.group + " (" + std::strerror(errno) +
                "); add one with 'ip link set lo up; ip link set lo multicast on; ip route add 224.0.0.0/4 dev lo'"};
  }
  sockaddr_in local{};
  socklen_t length = sizeof(local);
  std::array<char, INET_ADDRSTRLEN> text{};
  const bool is_known = ::getsockname(fd.get(), reinterpret_cast<sockaddr*>(&local), &length) == 0;
  if (is_known && ::inet_ntop(AF_INET, &local.sin_addr, text.data(), text.size()) != nullptr) route.local_address = text.data();
  return route;
}

}  // namespace camloc::tools
