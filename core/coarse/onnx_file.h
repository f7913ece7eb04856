// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Networks as files: the part of ONNX (ModelProto of onnx.proto3, Open Neural Network Exchange) that a feed-forward network of 32-bit
// floats needs, read and written without libprotobuf. Knows no operator: which there are and what they do is between who writes a
// network and who runs it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/base/result.h"

namespace camloc {

/// A tensor of 32-bit floats, row-major; a scalar has no shape and one value.
struct OnnxTensor {
  std::string name;
  std::vector<std::int64_t> shape;
  std::vector<float> values;
};

struct OnnxAttribute {
  std::string name;
  std::variant<float, std::int64_t, std::string, std::vector<std::int64_t>, std::vector<float>> value;
};

/// One operation. Inputs are names of weights, of the graph's inputs and of outputs of earlier nodes; "" leaves one out.
struct OnnxNode {
  std::string op, name;
  std::vector<std::string> inputs, outputs;
  std::vector<OnnxAttribute> attributes;
};

/// An input or output of the graph: a tensor of 32-bit floats. A side that the file leaves open is -1.
struct OnnxValue {
  std::string name;
  std::vector<std::int64_t> shape;
};

struct OnnxModel {
  int opset = 9;
  std::string producer;
  std::vector<OnnxNode> nodes;  ///< in the order in which they can be run
  std::vector<OnnxTensor> weights;
  std::vector<OnnxValue> inputs, outputs;  ///< inputs: without the weights, which old files list among them
  std::map<std::string, std::string> metadata;
};

inline constexpr std::size_t kMaxOnnxBytes = std::size_t{512} << 20;

/// Reads a file of at most 512 MB. Weights of other types than 32-bit floats (the int64 shapes of Reshape, say) are kept out of
/// `weights`, and so is a tensor of 32-bit floats that a Constant node holds put into them; a node that uses one that was kept out
/// still names it, and such a model cannot be written again.
/// Errors: kNotFound, kIo, kInvalid (too large), kCorrupt (no ONNX file, truncated, a tensor whose bytes do not fit its shape, an input
/// that nothing makes), kUnsupported (weights in a second file, subgraphs, operators of another domain).
[[nodiscard]] Result<OnnxModel> read_onnx(const std::string& path);

/// The same from memory; messages do not name a file.
[[nodiscard]] Result<OnnxModel> parse_onnx(std::span<const std::uint8_t> bytes);

/// The bytes of a file. kInvalid for a model that contradicts itself: a tensor whose number of values is not that of its shape, an
/// input of a node or an output of the graph that nothing makes, two things of one name, more than 512 MB.
[[nodiscard]] Result<std::string> encode_onnx(const OnnxModel& model);

/// Replaces `path` as a whole or not at all (replace_file). Errors: those of encode_onnx, and kIo.
[[nodiscard]] Status write_onnx(const std::string& path, const OnnxModel& model);

/// Values of a tensor of this shape, or -1 for a side below 0 or more values than a file can hold.
[[nodiscard]] std::int64_t num_values(std::span<const std::int64_t> shape);

}  // namespace camloc
