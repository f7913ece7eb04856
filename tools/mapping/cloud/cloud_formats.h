// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The readers behind cloud_file.h, one a file format. Each takes the whole input from its first byte and adds the points;
// every count and size of a header is compared with the bytes that are there before it is believed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/result.h"
#include "tools/mapping/cloud/cloud_input.h"
#include "tools/mapping/cloud/point_cloud.h"

namespace camloc::mapping {

/// PLY 1.0, ascii, binary little and big endian: x, y, z of the element "vertex"; other properties and elements are skipped.
[[nodiscard]] Status read_ply(CloudInput* input, CloudAccumulator* cloud);
/// PCD 0.7 (Point Cloud Library): ascii, binary, binary_compressed; fields x, y, z of any type.
[[nodiscard]] Status read_pcd(CloudInput* input, CloudAccumulator* cloud);
/// LAS 1.0 to 1.4, point formats 0 to 10, uncompressed. Points marked as withheld are counted as invalid.
[[nodiscard]] Status read_las(CloudInput* input, CloudAccumulator* cloud);
/// A point a line: x, y, z and what else there is, separated by blanks, commas or semicolons (with semicolons a comma may be the
/// decimal sign). Comments with #, // or %; a header line may name the columns; PTS files start with the number of points.
[[nodiscard]] Status read_text_cloud(CloudInput* input, CloudAccumulator* cloud);

/// A number type of PLY and PCD.
enum class ScalarType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat32, kFloat64 };
[[nodiscard]] std::size_t scalar_bytes(ScalarType type);
/// `bytes` holds scalar_bytes(type) bytes.
[[nodiscard]] double read_scalar(ScalarType type, const std::byte* bytes, bool is_big_endian);

}  // namespace camloc::mapping
