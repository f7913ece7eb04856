// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/protobuf_wire.h"

#include <gtest/gtest.h>

#include <limits>

namespace camloc {
namespace {

using Kind = ProtobufField::Kind;

std::span<const std::uint8_t> bytes_of(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

TEST(ProtobufWire, ReadsTheExamplesOfTheFormatsDescription) {
  ProtobufReader number(bytes_of("\x08\x96\x01"));  // field 1 is 150
  const auto field = number.next();
  ASSERT_TRUE(field);
  EXPECT_EQ(field->number, 1U);
  EXPECT_EQ(field->value, 150U);
  EXPECT_FALSE(number.next());
  EXPECT_TRUE(number.is_good());

  ProtobufReader text(bytes_of("\x12\x07testing"));
  EXPECT_EQ(text.next()->as_text(), "testing");
}

TEST(ProtobufWire, ReadsWhatItWrote) {
  ProtobufWriter inner, writer;
  inner.add_float(3, 0.5F);
  writer.add_int(1, -1);
  writer.add_int(2, std::numeric_limits<std::int64_t>::min());
  writer.add_message(300000, inner);
  writer.add_floats(4, std::vector<float>{1, -2.25F});
  ProtobufReader reader(bytes_of(writer.bytes()));
  EXPECT_EQ(reader.next()->as_int(), -1);
  EXPECT_EQ(reader.next()->as_int(), std::numeric_limits<std::int64_t>::min());
  const auto message = reader.next();
  EXPECT_EQ(message->number, 300000U);
  const auto number = ProtobufReader(message->bytes).next();
  EXPECT_EQ(number->kind, Kind::kFixed32);
  EXPECT_EQ(number->value, 0x3F000000U);
  EXPECT_EQ(floats_of(reader.next()->bytes), (std::vector<float>{1, -2.25F}));
  EXPECT_FALSE(reader.next());
  EXPECT_TRUE(reader.is_good());
}

TEST(ProtobufWire, DamageEndsTheMessageAndIsSaid) {
  using namespace std::string_view_literals;
  for (const std::string_view bad : {"\x08"sv, "\x08\x80"sv,
                                     "\x12\x05"
                                     "ab"sv,
                                     "\x0d\x01\x02\x03"sv, "\x09\x01"sv, "\x00\x01"sv, "\x0b"sv,
                                     "\x08\xff\xff\xff\xff\xff\xff\xff\xff\xff\x02"sv, "\x12\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01"sv}) {
    ProtobufReader reader(bytes_of(bad));
    EXPECT_FALSE(reader.next()) << ::testing::PrintToString(bad);
    EXPECT_FALSE(reader.is_good()) << ::testing::PrintToString(bad);
    EXPECT_FALSE(reader.next());
  }
}

}  // namespace
}  // namespace camloc
