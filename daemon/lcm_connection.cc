// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// lcm_create() explains a missing route in twenty lines on stderr, every time. The kernel is asked the same question first.
#include "daemon/lcm_connection.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "core/base/unique_fd.h"

namespace camloc {
namespace {

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

/// LCM opens a log as it is, and a named pipe would wait for its reader.
Status probe_log_file(const std::string& url) {
  constexpr std::string_view kScheme = "file://";
  if (!url.starts_with(kScheme)) return Status::ok();
  const std::string path = url.substr(kScheme.size(), url.find('?') - kScheme.size());
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || S_ISREG(info.st_mode)) return Status::ok();
  return {ErrorCode::kUnavailable, url + ": is not a regular file; see publish.lcm_url"};
}

}  // namespace

Result<Lcm> connect_lcm(const std::string& url) {
  if (const Status status = probe_route(url); !status) return status;
  if (const Status status = probe_log_file(url); !status) return status;
  Lcm lcm(lcm_create(url.c_str()));
  if (!lcm) return Status(ErrorCode::kUnavailable, "LCM does not open " + url + "; see publish.lcm_url");
  return lcm;
}

}  // namespace camloc
