// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bytes of a cloud file one after the other through a buffer: a scan may be larger than the memory. And the readers behind
// cloud_file.h, one a file format.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/base/work_observer.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {

class CloudInput {
 public:
  /// `stream` stands at its first byte; it and `observer`, who is told of every megabyte, outlive this. `name` is for messages.
  CloudInput(std::istream& stream, std::string name, WorkObserver& observer = WorkObserver::nobody());

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t total() const { return total_; }
  [[nodiscard]] std::uint64_t position() const { return consumed_ + next_; }
  [[nodiscard]] std::uint64_t remaining() const { return total_ - std::min(total_, position()); }
  /// Up to `size` bytes at the front without taking them; fewer at the end.
  [[nodiscard]] std::span<const std::byte> peek(std::size_t size);
  /// The next `size` bytes, at most kMaxRead, valid until the next call; empty where the file ends before.
  [[nodiscard]] std::span<const std::byte> read(std::size_t size);
  /// False where the file ends before.
  [[nodiscard]] bool skip(std::uint64_t size);
  /// The next line without its end ("\n", "\r\n" or "\r" alone), valid until the next call; nothing at the end of the file. A
  /// line longer than kMaxLine is cut there, its rest is the next line.
  [[nodiscard]] std::optional<std::string_view> read_line();
  /// True when the observer said stop.
  [[nodiscard]] bool is_stopped() const { return is_stopped_; }
  /// kCorrupt "name: is truncated: what", or kIo when reading was stopped.
  [[nodiscard]] Status truncated(const std::string& what) const;
  /// `code` "name: what".
  [[nodiscard]] Status error(ErrorCode code, const std::string& what) const { return {code, name_ + ": " + what}; }

  static constexpr std::size_t kMaxRead = std::size_t{1} << 16;
  static constexpr std::size_t kMaxLine = std::size_t{1} << 12;

 private:
  /// At least `size` bytes in the buffer, if the file has them.
  void fill(std::size_t size);

  std::istream& stream_;
  std::string name_;
  WorkObserver& observer_;
  std::uint64_t total_ = 0, consumed_ = 0;  ///< consumed_: bytes of the file before the buffer
  std::vector<std::byte> buffer_;
  std::size_t next_ = 0, end_ = 0;
  bool is_stopped_ = false;
};

/// A number type of PLY and PCD.
enum class ScalarType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };
[[nodiscard]] std::size_t scalar_bytes(ScalarType type);
/// `bytes` holds scalar_bytes(type) bytes.
[[nodiscard]] double read_scalar(ScalarType type, const std::byte* bytes, bool is_big_endian = false);

/// Where x, y and z are in a binary record.
struct RecordAxes {
  std::array<ScalarType, 3> type{};
  std::array<std::size_t, 3> byte{};
  bool is_big_endian = false;
  [[nodiscard]] Eigen::Vector3d point(const std::byte* record) const {
    const auto at = [&](std::size_t axis) { return read_scalar(type[axis], record + byte[axis], is_big_endian); };
    return {at(0), at(1), at(2)};
  }
};
/// What a LAS file says of its unit; 0: not said. Horizontal and vertical may differ.
struct LasUnit {
  double horizontal_m = 0, vertical_m = 0;
  bool is_geographic = false;  ///< x and y are degrees
  std::string source;          ///< "US survey feet (GeoKey 3076)", of the horizontal one
};
/// From the variable length records between header and points, each with its head; what makes no sense is passed over.
[[nodiscard]] LasUnit las_unit(std::span<const std::byte> records, std::uint32_t num_records);

/// x, y and z from these columns of a line; nothing where one is missing or no number.
[[nodiscard]] std::optional<Eigen::Vector3d> parse_point(const std::vector<std::string_view>& fields,
                                                         const std::array<std::size_t, 3>& columns);

// Each reader takes the whole input from its first byte and adds the points; every count and size of a header is compared with the
// bytes that are there before it is believed.

/// PLY 1.0, ascii, binary little and big endian: x, y, z of the element "vertex"; other properties and elements are skipped.
[[nodiscard]] Status read_ply(CloudInput* input, CloudAccumulator* cloud);
/// PCD 0.7 (Point Cloud Library): ascii, binary, binary_compressed; fields x, y, z of any type.
[[nodiscard]] Status read_pcd(CloudInput* input, CloudAccumulator* cloud);
/// LAS 1.0 to 1.4, point formats 0 to 10, uncompressed. Points marked as withheld are counted as invalid. The unit is that of its
/// GeoKeys or WKT (las_unit.cc); longitude and latitude are refused.
[[nodiscard]] Status read_las(CloudInput* input, CloudAccumulator* cloud);
/// Leica PTX: one scan or several, each with a matrix that takes its points to the site. "0 0 0" is a ray without return: invalid.
[[nodiscard]] Status read_ptx(CloudInput* input, CloudAccumulator* cloud);
/// True where a file that begins so is a PTX: two lines with a whole number each, then three numbers.
[[nodiscard]] bool is_ptx(std::string_view start);
/// A point a line: x, y, z and what else there is, separated by blanks, commas or semicolons. Where semicolons, or blanks and tabs
/// alone, separate, a comma between digits is the decimal sign. Comments with #, // or %; a header line may name the columns; PTS
/// files start every scan with the number of its points.
[[nodiscard]] Status read_text_cloud(CloudInput* input, CloudAccumulator* cloud);

}  // namespace camloc::mapping
