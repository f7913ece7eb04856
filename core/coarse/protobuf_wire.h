// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The wire format of protocol buffers, version 3: fields of a message one after the other, each with a number and one of four kinds.
// What the numbers mean is up to the caller. Every length is held against what is left; nothing is copied and nothing recurses.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace camloc {

/// One field of a message. `bytes` looks into the message.
struct ProtobufField {
  enum class Kind : std::uint8_t { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };
  std::uint32_t number = 0;
  Kind kind = Kind::kVarint;
  std::uint64_t value = 0;                ///< of the first, second and fourth kind
  std::span<const std::uint8_t> bytes{};  ///< of the third: text, a message, or packed numbers

  [[nodiscard]] std::int64_t as_int() const { return static_cast<std::int64_t>(value); }
  [[nodiscard]] std::string_view as_text() const { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
};

/// Walks through the fields of one message.
class ProtobufReader {
 public:
  explicit ProtobufReader(std::span<const std::uint8_t> message) : rest_(message) {}
  /// The next field, or nothing at the end or where the bytes are no message; then `is_good` says which.
  [[nodiscard]] std::optional<ProtobufField> next();
  [[nodiscard]] bool is_good() const { return is_good_; }
  /// A number of a packed list: as `next`, without a field number in front.
  [[nodiscard]] std::optional<std::uint64_t> next_varint();

 private:
  [[nodiscard]] std::optional<std::uint64_t> take_fixed(std::size_t num_bytes);
  std::span<const std::uint8_t> rest_;
  bool is_good_ = true;
};

/// Puts fields of a message one after the other.
class ProtobufWriter {
 public:
  void add_int(std::uint32_t number, std::int64_t value);
  void add_float(std::uint32_t number, float value);
  void add_text(std::uint32_t number, std::string_view text);
  void add_message(std::uint32_t number, const ProtobufWriter& message) { add_text(number, message.bytes_); }
  void add_floats(std::uint32_t number, std::span<const float> values);  ///< as packed or raw little-endian bytes
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void add_varint(std::uint64_t value);
  void add_tag(std::uint32_t number, ProtobufField::Kind kind);
  std::string bytes_;
};

/// Little-endian 32-bit floats; the number of bytes is a multiple of four.
[[nodiscard]] std::vector<float> floats_of(std::span<const std::uint8_t> bytes);

}  // namespace camloc
