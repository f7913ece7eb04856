// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bytes of .oni files, record by record (see drivers/openni2/oni_file.h), right or wrong as a test wants them.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace camloc {

class OniWriter {
 public:
  explicit OniWriter(std::uint16_t maintenance = 1, std::uint32_t build = 0) : is_old_(maintenance == 0) {
    bytes_ = "NI10";
    put<std::uint8_t>(1);
    put<std::uint8_t>(0);
    put(maintenance);
    put(build);
    put<std::uint64_t>(~0ULL);
    put<std::uint32_t>(2);
  }

  template <typename T>
  static std::string bytes_of(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof(value)};
  }
  static std::string text(const std::string& value) { return bytes_of(static_cast<std::uint32_t>(value.size() + 1)) + value + '\0'; }

  OniWriter& record(std::uint32_t type, std::uint32_t node, const std::string& fields, const std::string& payload = "") {
    put<std::uint32_t>(0x0052494E);
    put(type);
    put(node);
    put(static_cast<std::uint32_t>((is_old_ ? 24 : 28) + fields.size()));
    put(static_cast<std::uint32_t>(payload.size()));
    is_old_ ? put<std::uint32_t>(0) : put<std::uint64_t>(0);
    bytes_ += fields + payload;
    return *this;
  }
  OniWriter& node(std::uint32_t id, const std::string& name, std::uint32_t type, const std::string& codec) {
    return record(13, id, text(name) + bytes_of(type) + codec + bytes_of(~0U) + bytes_of(0ULL) + bytes_of(~0ULL) + bytes_of(0ULL));
  }
  OniWriter& number(std::uint32_t id, const std::string& name, std::uint64_t value) { return property(3, id, name, bytes_of(value)); }
  OniWriter& mode(std::uint32_t id, std::uint32_t width, std::uint32_t height) {
    return property(6, id, "xnMapOutputMode", bytes_of(width) + bytes_of(height) + bytes_of(30U));
  }
  OniWriter& field_of_view(std::uint32_t id, double horizontal_rad, double vertical_rad) {
    return property(6, id, "xnFOV", bytes_of(horizontal_rad) + bytes_of(vertical_rad));
  }
  OniWriter& property(std::uint32_t type, std::uint32_t id, const std::string& name, const std::string& data) {
    return record(type, id, text(name) + bytes_of(static_cast<std::uint32_t>(data.size())) + data);
  }
  OniWriter& frame(std::uint32_t id, std::uint64_t stamp_us, std::uint32_t index, const std::string& payload) {
    return record(10, id, bytes_of(stamp_us) + bytes_of(index), payload);
  }
  OniWriter& end() { return record(11, 0, ""); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  template <typename T>
  void put(T value) {
    bytes_ += bytes_of(value);
  }
  bool is_old_;
  std::string bytes_;
};

/// Two tiny streams: depth (node 1) and colour (node 2) of 4x2 pixels, uncompressed, `count` frames 33 ms apart; depth 1 ms late.
inline OniWriter small_recording(int count, int oni_color_format = 200, int oni_depth_format = 100, std::uint16_t maintenance = 1,
                                 std::uint32_t build = 0) {
  const std::size_t bytes_per_pixel = oni_color_format == 200 ? 3 : oni_color_format == 202 ? 1 : 2;
  OniWriter writer(maintenance, build);
  writer.node(1, "Depth", 2, "NONE")
      .mode(1, 4, 2)
      .number(1, "oniPixelFormat", static_cast<std::uint64_t>(oni_depth_format))
      .field_of_view(1, 1.0, 0.8);
  writer.node(2, "Image", 3, "NONE")
      .mode(2, 4, 2)
      .number(2, "oniPixelFormat", static_cast<std::uint64_t>(oni_color_format))
      .field_of_view(2, 1.0, 0.8);
  for (int i = 0; i < count; ++i) {
    std::string depth, color;
    for (int p = 0; p < 8; ++p) depth += OniWriter::bytes_of(static_cast<std::uint16_t>(1000 + 10 * i + p));
    for (std::size_t b = 0; b < 8 * bytes_per_pixel; ++b) color += static_cast<char>(16 + i + 3 * static_cast<int>(b));
    const auto stamp_us = static_cast<std::uint64_t>(i) * 33'000;
    writer.frame(2, stamp_us, static_cast<std::uint32_t>(i + 1), color).frame(1, stamp_us + 1000, static_cast<std::uint32_t>(i + 1), depth);
  }
  return writer;
}

}  // namespace camloc
