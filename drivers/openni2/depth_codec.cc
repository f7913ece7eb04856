// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// See depth_codec.h.
#include "drivers/openni2/depth_codec.h"

#include <cstddef>
#include <string>

namespace camloc::openni2 {

namespace {

/// Reads codes and writes numbers; the first thing that does not fit stops it for good.
class Decoder {
 public:
  Decoder(std::span<const std::uint8_t> bytes, std::span<std::uint16_t> depth) : bytes_(bytes), depth_(depth) {}

  [[nodiscard]] bool read_table() {
    const std::size_t count = read_u16();
    if (failed_ || bytes_.size() - position_ < 2 * count) return false;
    table_ = bytes_.subspan(position_, 2 * count);
    has_table_ = true;
    position_ += 2 * count;
    return true;
  }

  [[nodiscard]] bool run() {
    last_ = read_u16();
    if (!failed_) put();
    while (!failed_ && position_ < bytes_.size()) read_code();
    return !failed_ && num_written_ == depth_.size();
  }

 private:
  void read_code() {
    const int code = read_byte();
    if (code == 0xFF) return read_full();
    if (code >= 0xE0) {
      for (int i = 0; i < 2 * (code - 0xE0); ++i) put();
      return;
    }
    step((code >> 4) - 6);
    const int low = code & 0xF;
    if (low == 0xF) {
      read_full();
    } else if (low != 0xD) {
      step(low - 6);
    }
  }

  void read_full() {
    const int first = read_byte();
    if (first >= 0x80) return step(first - 192);
    last_ = static_cast<std::uint16_t>(first << 8 | read_byte());
    put();
  }

  void step(int difference) {
    last_ = static_cast<std::uint16_t>(last_ - difference);
    put();
  }

  void put() {
    std::uint16_t value = last_;
    if (has_table_) {
      if (2 * static_cast<std::size_t>(last_) >= table_.size()) {
        failed_ = true;
        return;
      }
      value = static_cast<std::uint16_t>(table_[2U * last_] | table_[2U * last_ + 1] << 8);
    }
    if (failed_ || num_written_ == depth_.size()) {
      failed_ = true;
      return;
    }
    depth_[num_written_++] = value;
  }

  int read_byte() {
    if (position_ < bytes_.size()) return bytes_[position_++];
    failed_ = true;
    return 0;
  }
  std::uint16_t read_u16() {
    const int low = read_byte();
    return static_cast<std::uint16_t>(low | read_byte() << 8);
  }

  std::span<const std::uint8_t> bytes_;
  std::span<std::uint16_t> depth_;
  std::span<const std::uint8_t> table_;
  bool has_table_ = false;
  bool failed_ = false;
  std::uint16_t last_ = 0;
  std::size_t position_ = 0;
  std::size_t num_written_ = 0;
};

}  // namespace

Status decode_depth_codec(DepthCodec codec, std::span<const std::uint8_t> bytes, std::span<std::uint16_t> depth) {
  Decoder decoder(bytes, depth);
  if ((codec != DepthCodec::k16zTable || decoder.read_table()) && decoder.run()) return Status::ok();
  return {ErrorCode::kCorrupt, "compressed depth does not give " + std::to_string(depth.size()) + " pixels"};
}

}  // namespace camloc::openni2
