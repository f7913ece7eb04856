// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Numbers of fields are those of onnx.proto3; each reader below has one function a message, with the fields that it uses.
#include "core/coarse/onnx_file.h"

#include <algorithm>
#include <cstring>
#include <set>
#include <utility>

#include "core/coarse/protobuf_wire.h"
#include "core/io/file_bytes.h"
#include "core/io/text.h"

namespace camloc {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Kind = ProtobufField::Kind;

constexpr std::int64_t kFloat = 1;  // TensorProto.DataType
constexpr std::int64_t kIrVersion = 6;
constexpr std::size_t kMaxParts = 1 << 20;  // nodes with their inputs, outputs and attributes: a crafted file may hold 200 million
enum AttributeType : std::int64_t { kTypeFloat = 1, kTypeInt = 2, kTypeText = 3, kTypeFloats = 6, kTypeInts = 7 };

Status corrupt(const std::string& what) { return {ErrorCode::kCorrupt, "damaged, or no ONNX file: " + what}; }

/// Calls on_field(field) for each field of a message until it returns an error.
template <typename OnField>
Status for_each_field(Bytes message, const char* name, OnField&& on_field) {
  ProtobufReader reader(message);
  while (const auto field = reader.next()) {
    if (Status status = on_field(*field); !status) return status;
  }
  return reader.is_good() ? Status::ok() : corrupt(std::string(name) + " ends early");
}

/// A repeated number: one a field, or all of them packed.
template <typename Add>
bool add_numbers(const ProtobufField& field, Add&& add) {
  if (field.kind == Kind::kVarint) return add(field.as_int()), true;
  if (field.kind != Kind::kBytes) return false;
  ProtobufReader reader(field.bytes);
  while (const auto value = reader.next_varint()) add(static_cast<std::int64_t>(*value));
  return reader.is_good();
}

float float_of(const ProtobufField& field) {
  const auto bits = static_cast<std::uint32_t>(field.value);
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

bool add_floats(const ProtobufField& field, std::vector<float>* values) {
  if (field.kind == Kind::kFixed32) return values->push_back(float_of(field)), true;
  if (field.kind != Kind::kBytes || field.bytes.size() % sizeof(float) != 0) return false;
  const std::vector<float> packed = floats_of(field.bytes);
  values->insert(values->end(), packed.begin(), packed.end());
  return true;
}

/// A TensorProto; without values where it is of another type than float.
struct Tensor {
  OnnxTensor tensor;
  std::int64_t type = 0;
};

Status read_tensor(Bytes message, Tensor* out) {
  OnnxTensor& tensor = out->tensor;
  bool is_elsewhere = false, is_good = true;
  std::optional<Bytes> raw;
  const Status status = for_each_field(message, "a tensor", [&](const ProtobufField& field) {
    if (field.number == 1) is_good = is_good && add_numbers(field, [&](std::int64_t side) { tensor.shape.push_back(side); });
    if (field.number == 2) out->type = field.as_int();
    if (field.number == 4) is_good = is_good && add_floats(field, &tensor.values);
    if (field.number == 8) tensor.name = field.as_text();
    if (field.number == 9) raw = field.bytes;
    if (field.number == 13 || (field.number == 14 && field.value != 0)) is_elsewhere = true;
    return Status::ok();
  });
  if (!status) return status;
  const std::string name = "tensor " + in_quotes(tensor.name);
  if (is_elsewhere) return {ErrorCode::kUnsupported, name + " has its values in a second file; write the model as one file"};
  if (!is_good) return corrupt(name + " has numbers that are none");
  if (out->type != kFloat) return Status::ok();
  if (raw && raw->size() % sizeof(float) != 0) return corrupt(name + " has a part of a number");
  if (raw && tensor.values.empty()) tensor.values = floats_of(*raw);
  const std::int64_t count = num_values(tensor.shape);
  if (count < 0 || static_cast<std::uint64_t>(count) != tensor.values.size())
    return corrupt(name + " has " + std::to_string(tensor.values.size()) + " values, which is not what its shape says");
  return Status::ok();
}

/// The values of an AttributeProto as they stand in the file, before its type says which of them counts.
struct AttributeFields {
  std::string name;
  std::int64_t type = 0, integer = 0;
  float number = 0;
  std::string text;
  std::vector<std::int64_t> integers;
  std::vector<float> numbers;
  std::optional<Bytes> tensor;
};

Status read_attribute_fields(Bytes message, AttributeFields* out) {
  bool is_good = true;
  const Status status = for_each_field(message, "an attribute", [&](const ProtobufField& field) {
    const auto found = [&](std::int64_t type) { out->type = out->type == 0 ? type : out->type; };
    if (field.number == 1) out->name = field.as_text();
    if (field.number == 2) found(kTypeFloat), out->number = float_of(field);
    if (field.number == 3) found(kTypeInt), out->integer = field.as_int();
    if (field.number == 4) found(kTypeText), out->text = field.as_text();
    if (field.number == 5) found(4), out->tensor = field.bytes;
    if (field.number == 6 || field.number >= 9) found(-1);
    if (field.number == 7) found(kTypeFloats), is_good = is_good && add_floats(field, &out->numbers);
    if (field.number == 8)
      found(kTypeInts), is_good = is_good && add_numbers(field, [&](std::int64_t value) { out->integers.push_back(value); });
    if (field.number == 20) out->type = field.as_int();  // the last word, where it stands
    return Status::ok();
  });
  return !status || is_good ? status : corrupt("attribute " + in_quotes(out->name) + " has numbers that are none");
}

Result<OnnxAttribute> to_attribute(AttributeFields fields) {
  OnnxAttribute out{std::move(fields.name), {}};
  switch (fields.type) {
    case kTypeFloat: out.value = fields.number; break;
    case kTypeInt: out.value = fields.integer; break;
    case kTypeText: out.value = std::move(fields.text); break;
    case kTypeFloats: out.value = std::move(fields.numbers); break;
    case kTypeInts: out.value = std::move(fields.integers); break;
    default: return Status(ErrorCode::kUnsupported, "attribute " + in_quotes(out.name) + " is a tensor, a graph or a list of texts");
  }
  return out;
}

/// The graph while it is read: also what was kept out of it.
struct Graph {
  OnnxModel* model;
  std::set<std::string> kept_out;  ///< tensors of other types
  std::size_t num_parts = 0;
};

Status add_weight(Tensor tensor, Graph* graph) {
  if (tensor.type == kFloat) graph->model->weights.push_back(std::move(tensor.tensor));
  if (tensor.type != kFloat) graph->kept_out.insert(std::move(tensor.tensor.name));
  return Status::ok();
}

Status read_constant(const OnnxNode& node, Bytes value, Graph* graph) {
  Tensor tensor;
  if (Status status = read_tensor(value, &tensor); !status) return status;
  if (node.outputs.size() != 1) return corrupt("a constant with " + std::to_string(node.outputs.size()) + " outputs");
  tensor.tensor.name = node.outputs[0];
  return add_weight(std::move(tensor), graph);
}

Status read_node(Bytes message, Graph* graph) {
  OnnxNode node;
  std::optional<Bytes> constant;
  Status status = for_each_field(message, "a node", [&](const ProtobufField& field) -> Status {
    if (++graph->num_parts > kMaxParts) return {ErrorCode::kUnsupported, "the network has more than a million parts"};
    if (field.number == 1) node.inputs.emplace_back(field.as_text());
    if (field.number == 2) node.outputs.emplace_back(field.as_text());
    if (field.number == 3) node.name = field.as_text();
    if (field.number == 4) node.op = field.as_text();
    if (field.number == 7 && !field.bytes.empty() && field.as_text() != "ai.onnx")
      return {ErrorCode::kUnsupported, "an operator of " + in_quotes(field.as_text()) + "; only those of ONNX itself are read"};
    if (field.number != 5) return Status::ok();
    AttributeFields fields;
    if (Status read = read_attribute_fields(field.bytes, &fields); !read) return read;
    // The operator may stand behind its attributes.
    if (fields.tensor && fields.name == "value") return constant = fields.tensor, Status::ok();
    Result<OnnxAttribute> attribute = to_attribute(std::move(fields));
    if (attribute) node.attributes.push_back(std::move(*attribute));
    return attribute.status();
  });
  if (!status) return status;
  if (node.op.empty() || node.outputs.empty()) return corrupt("a node without operator or output");
  if (constant && node.op != "Constant") return {ErrorCode::kUnsupported, "operator " + in_quotes(node.op) + " has a tensor as attribute"};
  if (constant) return read_constant(node, *constant, graph);
  graph->model->nodes.push_back(std::move(node));
  return Status::ok();
}

/// TypeProto.Tensor.shape: sides that are no number are -1.
Status read_shape(Bytes message, std::vector<std::int64_t>* shape) {
  return for_each_field(message, "a shape", [&](const ProtobufField& dimension) {
    if (dimension.number != 1) return Status::ok();
    shape->push_back(-1);
    return for_each_field(dimension.bytes, "a side of a shape", [&](const ProtobufField& field) {
      if (field.number == 1) shape->back() = field.as_int() < 0 ? -1 : field.as_int();
      return Status::ok();
    });
  });
}

/// A ValueInfoProto: name, and of its type (1: a tensor) the shape.
Status read_value(Bytes message, OnnxValue* value) {
  return for_each_field(message, "an input or output", [&](const ProtobufField& field) {
    if (field.number == 1) value->name = field.as_text();
    if (field.number != 2) return Status::ok();
    return for_each_field(field.bytes, "a type", [&](const ProtobufField& type) {
      if (type.number != 1) return Status::ok();
      return for_each_field(type.bytes, "a tensor's type", [&](const ProtobufField& tensor) {
        return tensor.number == 2 ? read_shape(tensor.bytes, &value->shape) : Status::ok();
      });
    });
  });
}

Status read_graph(Bytes message, Graph* graph) {
  return for_each_field(message, "the graph", [&](const ProtobufField& field) -> Status {
    if (field.number == 1) return read_node(field.bytes, graph);
    if (field.number == 5) {
      Tensor tensor;
      Status status = read_tensor(field.bytes, &tensor);
      return status ? add_weight(std::move(tensor), graph) : status;
    }
    if (field.number == 15) return {ErrorCode::kUnsupported, "sparse weights are not read"};
    if (field.number != 11 && field.number != 12) return Status::ok();
    std::vector<OnnxValue>& values = field.number == 11 ? graph->model->inputs : graph->model->outputs;
    return read_value(field.bytes, &values.emplace_back());
  });
}

Status read_pair(Bytes message, std::map<std::string, std::string>* pairs) {
  std::string key, value;
  Status status = for_each_field(message, "metadata", [&](const ProtobufField& field) {
    if (field.number == 1) key = field.as_text();
    if (field.number == 2) value = field.as_text();
    return Status::ok();
  });
  if (status) (*pairs)[key] = value;
  return status;
}

Status read_opset(Bytes message, int* opset) {
  std::string domain;
  std::int64_t version = 0;
  Status status = for_each_field(message, "the operator set", [&](const ProtobufField& field) {
    if (field.number == 1) domain = field.as_text();
    if (field.number == 2) version = field.as_int();
    return Status::ok();
  });
  if (status && (domain.empty() || domain == "ai.onnx")) *opset = static_cast<int>(std::clamp<std::int64_t>(version, 0, 1000));
  return status;
}

/// Whatever a node or an output of the graph takes must be there before; no two things have one name.
Status check_names(const OnnxModel& model, const std::set<std::string>& kept_out, ErrorCode code) {
  std::set<std::string> made = kept_out;
  std::string twice;
  const auto make = [&](const std::string& name) {
    if (!name.empty() && !made.insert(name).second && twice.empty()) twice = name;
  };
  for (const OnnxTensor& tensor : model.weights) make(tensor.name);
  for (const OnnxValue& value : model.inputs) make(value.name);
  for (const OnnxNode& node : model.nodes) {
    for (const std::string& input : node.inputs) {
      if (!input.empty() && !made.contains(input))
        return {code, "operator " + in_quotes(node.op) + " takes " + in_quotes(input) + ", which nothing before it makes"};
    }
    for (const std::string& output : node.outputs) make(output);
  }
  for (const OnnxValue& value : model.outputs) {
    if (!made.contains(value.name)) return {code, "the graph's output " + in_quotes(value.name) + " is made by nothing"};
  }
  return twice.empty() ? Status::ok() : Status(code, in_quotes(twice) + " is made twice");
}

ProtobufWriter encode(const OnnxTensor& tensor) {
  ProtobufWriter out;
  for (const std::int64_t side : tensor.shape) out.add_int(1, side);
  out.add_int(2, kFloat);
  out.add_text(8, tensor.name);
  out.add_floats(9, tensor.values);
  return out;
}

ProtobufWriter encode(const OnnxAttribute& attribute) {
  ProtobufWriter out;
  out.add_text(1, attribute.name);
  std::int64_t type = 0;
  if (const auto* number = std::get_if<float>(&attribute.value)) type = kTypeFloat, out.add_float(2, *number);
  if (const auto* integer = std::get_if<std::int64_t>(&attribute.value)) type = kTypeInt, out.add_int(3, *integer);
  if (const auto* text = std::get_if<std::string>(&attribute.value)) type = kTypeText, out.add_text(4, *text);
  if (const auto* numbers = std::get_if<std::vector<float>>(&attribute.value)) {
    type = kTypeFloats;
    for (const float number : *numbers) out.add_float(7, number);  // onnx.proto is of version 2, which does not pack them
  }
  if (const auto* integers = std::get_if<std::vector<std::int64_t>>(&attribute.value)) {
    type = kTypeInts;
    for (const std::int64_t integer : *integers) out.add_int(8, integer);
  }
  out.add_int(20, type);
  return out;
}

ProtobufWriter encode(const OnnxNode& node) {
  ProtobufWriter out;
  for (const std::string& input : node.inputs) out.add_text(1, input);
  for (const std::string& output : node.outputs) out.add_text(2, output);
  if (!node.name.empty()) out.add_text(3, node.name);
  out.add_text(4, node.op);
  for (const OnnxAttribute& attribute : node.attributes) out.add_message(5, encode(attribute));
  return out;
}

ProtobufWriter encode(const std::string& name, std::span<const std::int64_t> sides) {
  ProtobufWriter shape, tensor, type, out;
  for (const std::int64_t side : sides) {
    ProtobufWriter dimension;
    if (side >= 0) dimension.add_int(1, side);
    shape.add_message(1, dimension);
  }
  tensor.add_int(1, kFloat);
  tensor.add_message(2, shape);
  type.add_message(1, tensor);
  out.add_text(1, name);
  out.add_message(2, type);
  return out;
}

ProtobufWriter encode_graph(const OnnxModel& model) {
  ProtobufWriter out;
  for (const OnnxNode& node : model.nodes) out.add_message(1, encode(node));
  out.add_text(2, "camloc");
  for (const OnnxTensor& tensor : model.weights) out.add_message(5, encode(tensor));
  for (const OnnxValue& input : model.inputs) out.add_message(11, encode(input.name, input.shape));
  for (const OnnxValue& output : model.outputs) out.add_message(12, encode(output.name, output.shape));
  return out;
}

}  // namespace

std::int64_t num_values(std::span<const std::int64_t> shape) {
  std::int64_t count = 1;
  for (const std::int64_t side : shape) {
    if (side < 0 || __builtin_mul_overflow(count, side, &count) || count > static_cast<std::int64_t>(kMaxOnnxBytes)) return -1;
  }
  return count;
}

Result<OnnxModel> parse_onnx(std::span<const std::uint8_t> bytes) {
  OnnxModel model;
  model.opset = 0;
  Graph graph{&model, {}};
  bool has_graph = false;
  const Status status = for_each_field(bytes, "the file", [&](const ProtobufField& field) {
    if (field.number == 2) model.producer = field.as_text();
    if (field.number == 7) return has_graph = true, read_graph(field.bytes, &graph);
    if (field.number == 8) return read_opset(field.bytes, &model.opset);
    return field.number == 14 ? read_pair(field.bytes, &model.metadata) : Status::ok();
  });
  if (!status) return status;
  if (!has_graph || model.nodes.empty() || model.outputs.empty()) return corrupt("it holds no network");
  if (model.opset < 1) return corrupt("it does not say which operator set it uses");
  std::set<std::string> not_inputs = graph.kept_out;
  for (const OnnxTensor& tensor : model.weights) not_inputs.insert(tensor.name);
  std::erase_if(model.inputs, [&](const OnnxValue& value) { return not_inputs.contains(value.name); });
  if (Status names = check_names(model, graph.kept_out, ErrorCode::kCorrupt); !names) return names;
  return model;
}

Result<OnnxModel> read_onnx(const std::string& path) {
  std::vector<std::uint8_t> bytes;
  if (Status status = read_file_bytes(path, kMaxOnnxBytes, &bytes); !status) return status;
  Result<OnnxModel> model = parse_onnx(bytes);
  if (!model) return model.status().with_context(path);
  return model;
}

Result<std::string> encode_onnx(const OnnxModel& model) {
  std::uint64_t num_bytes = 0;
  for (const OnnxTensor& tensor : model.weights) {
    const std::int64_t count = num_values(tensor.shape);
    num_bytes += tensor.values.size() * sizeof(float);
    if (count < 0 || static_cast<std::uint64_t>(count) != tensor.values.size())
      return Status(ErrorCode::kInvalid, "weight " + in_quotes(tensor.name) + " has another number of values than its shape says");
  }
  if (num_bytes > kMaxOnnxBytes * 15 / 16) return Status(ErrorCode::kInvalid, "the network is larger than 480 MB; make it smaller");
  if (Status names = check_names(model, {}, ErrorCode::kInvalid); !names) return names;
  ProtobufWriter out, opset;
  out.add_int(1, kIrVersion);
  out.add_text(2, model.producer);
  out.add_message(7, encode_graph(model));
  opset.add_text(1, "");
  opset.add_int(2, model.opset);
  out.add_message(8, opset);
  for (const auto& [key, value] : model.metadata) {
    ProtobufWriter pair;
    pair.add_text(1, key);
    pair.add_text(2, value);
    out.add_message(14, pair);
  }
  return out.bytes();
}

Status write_onnx(const std::string& path, const OnnxModel& model) {
  const Result<std::string> bytes = encode_onnx(model);
  return bytes ? replace_file(path, std::string_view(*bytes)) : bytes.status().with_context(path);
}

}  // namespace camloc
