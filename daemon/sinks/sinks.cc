// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See sinks.h. A new sink adds its line here and nothing else.
#include "daemon/sinks/sinks.h"

#include "core/io/text.h"
#include "daemon/sinks/lcm_sink.h"

namespace camloc {
namespace {

// The schemes of LCM are its own providers.
constexpr SinkEntry kSinks[] = {
    {"udpm", open_lcm_sink, "udpm://239.255.76.67:7667?ttl=0  LCM by multicast; ttl=0 keeps messages on this machine"},
    {"mpudpm", open_lcm_sink, "mpudpm://239.255.76.67:7667?ttl=0  LCM by multicast, channels spread over ports"},
    {"tcpq", open_lcm_sink, "tcpq://localhost:7700  LCM by a relay (lcm-tcpq-server)"},
    {"file", open_lcm_sink, "file:///tmp/poses.lcm?mode=w  a log of LCM"},
    {"memq", open_lcm_sink, "memq://  LCM within this process, which is nowhere"},
};

}  // namespace

SinkTable pose_sinks() { return kSinks; }

Result<const SinkEntry*> find_sink(const std::string& url, SinkTable sinks) {
  const std::size_t end = url.find("://");
  std::string known;
  for (const SinkEntry& sink : sinks) {
    if (end != std::string::npos && url.compare(0, end, sink.scheme) == 0) return &sink;
    known += std::string(known.empty() ? "" : ", ") + sink.scheme + "://";
  }
  const std::string example = sinks.empty() ? "" : std::string(sinks.front().help).substr(0, std::string(sinks.front().help).find("  "));
  return Status(ErrorCode::kInvalid, in_quotes(url) + " has no provider of " + known + "; e.g. " + example);
}

Result<std::unique_ptr<PoseSink>> open_pose_sink(const SinkOptions& options, SinkTable sinks) {
  const Result<const SinkEntry*> sink = find_sink(options.url, sinks);
  return sink ? (*sink)->open(options) : Result<std::unique_ptr<PoseSink>>(sink.status());
}

}  // namespace camloc
