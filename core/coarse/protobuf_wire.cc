// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/protobuf_wire.h"

#include <bit>
#include <cassert>
#include <cstring>

namespace camloc {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");

std::optional<std::uint64_t> ProtobufReader::next_varint() {
  std::uint64_t value = 0;
  for (std::size_t i = 0; is_good_ && i < 10 && i < rest_.size(); ++i) {
    const std::uint64_t part = rest_[i] & 0x7FU;
    if (i == 9 && part > 1) break;  // more than 64 bits
    value |= part << (7 * i);
    if ((rest_[i] & 0x80U) != 0) continue;
    rest_ = rest_.subspan(i + 1);
    return value;
  }
  if (!rest_.empty()) is_good_ = false;
  return std::nullopt;
}

std::optional<std::uint64_t> ProtobufReader::take_fixed(std::size_t num_bytes) {
  std::uint64_t value = 0;
  if (rest_.size() < num_bytes) return std::nullopt;
  std::memcpy(&value, rest_.data(), num_bytes);
  rest_ = rest_.subspan(num_bytes);
  return value;
}

std::optional<ProtobufField> ProtobufReader::next() {
  const std::optional<std::uint64_t> tag = next_varint();
  if (!tag) return std::nullopt;
  const std::uint64_t number = *tag >> 3;
  ProtobufField field;
  field.kind = static_cast<ProtobufField::Kind>(*tag & 7U);
  field.number = static_cast<std::uint32_t>(number);
  is_good_ = number >= 1 && number < (1U << 29);
  std::optional<std::uint64_t> value;
  if (field.kind == ProtobufField::Kind::kVarint || field.kind == ProtobufField::Kind::kBytes) value = next_varint();
  if (field.kind == ProtobufField::Kind::kFixed32) value = take_fixed(4);
  if (field.kind == ProtobufField::Kind::kFixed64) value = take_fixed(8);
  // Without a value: the message ends early, or has one of the groups that no version 3 has.
  is_good_ = is_good_ && value && (field.kind != ProtobufField::Kind::kBytes || *value <= rest_.size());
  if (!is_good_) return std::nullopt;
  field.value = *value;
  if (field.kind == ProtobufField::Kind::kBytes) {
    field.bytes = rest_.first(static_cast<std::size_t>(*value));
    rest_ = rest_.subspan(static_cast<std::size_t>(*value));
  }
  return field;
}

void ProtobufWriter::add_varint(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<char>((value & 0x7FU) | 0x80U));
  bytes_.push_back(static_cast<char>(value));
}

void ProtobufWriter::add_tag(std::uint32_t number, ProtobufField::Kind kind) {
  add_varint((std::uint64_t{number} << 3) | static_cast<std::uint64_t>(kind));
}

void ProtobufWriter::add_int(std::uint32_t number, std::int64_t value) {
  add_tag(number, ProtobufField::Kind::kVarint);
  add_varint(static_cast<std::uint64_t>(value));
}

void ProtobufWriter::add_float(std::uint32_t number, float value) {
  add_tag(number, ProtobufField::Kind::kFixed32);
  bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void ProtobufWriter::add_text(std::uint32_t number, std::string_view text) {
  add_tag(number, ProtobufField::Kind::kBytes);
  add_varint(text.size());
  bytes_.append(text);
}

void ProtobufWriter::add_floats(std::uint32_t number, std::span<const float> values) {
  add_text(number, {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

std::vector<float> floats_of(std::span<const std::uint8_t> bytes) {
  assert(bytes.size() % sizeof(float) == 0);
  std::vector<float> values(bytes.size() / sizeof(float));
  if (!bytes.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

}  // namespace camloc
