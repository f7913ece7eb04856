// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See kinect_protocol.h.
#include "drivers/kinect/kinect_protocol.h"

#include <cassert>

namespace camloc::kinect {

ControlRequest encode_request(Command command, std::uint16_t tag, std::span<const std::uint16_t> body) {
  assert(body.size() <= kMaxRequestWords);
  ControlRequest request;
  const auto put = [&request](std::size_t word) {
    request.bytes[request.size++] = static_cast<std::uint8_t>(word & 0xff);
    request.bytes[request.size++] = static_cast<std::uint8_t>(word >> 8 & 0xff);
  };
  put('G' | 'M' << 8);
  put(body.size());
  put(static_cast<std::uint16_t>(command));
  put(tag);
  for (const std::uint16_t word : body) put(word);
  return request;
}

ControlReply parse_reply(std::span<const std::uint8_t> bytes, Command command, std::uint16_t tag) {
  if (bytes.empty() || bytes.size() >= kMaxControlBytes) return {ReplyState::kNone, {}};
  if (bytes.size() < kControlHeaderBytes || bytes[0] != 'R' || bytes[1] != 'B') return {ReplyState::kCorrupt, {}};
  const std::size_t body_bytes = 2U * word_at(bytes, 2);
  if (word_at(bytes, 6) != tag) return {ReplyState::kStale, {}};
  if (word_at(bytes, 4) != static_cast<std::uint16_t>(command)) return {ReplyState::kCorrupt, {}};
  if (kControlHeaderBytes + body_bytes > bytes.size()) return {ReplyState::kCorrupt, {}};
  return {ReplyState::kOk, bytes.subspan(kControlHeaderBytes, body_bytes)};
}

}  // namespace camloc::kinect
