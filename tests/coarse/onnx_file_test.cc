// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/onnx_file.h"

#include "core/coarse/protobuf_wire.h"
#include "tests/coarse/sample_model.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

std::span<const std::uint8_t> as_bytes(std::string_view text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

ProtobufWriter tensor(const std::string& name, std::int64_t type, std::string_view raw, std::vector<std::int64_t> shape) {
  ProtobufWriter out;
  for (const std::int64_t side : shape) out.add_int(1, side);
  out.add_int(2, type);
  out.add_text(8, name);
  out.add_text(9, raw);
  return out;
}

ProtobufWriter named(const std::string& name) {
  ProtobufWriter out;
  out.add_text(1, name);
  return out;
}

/// A file with a node that adds input "x" and `second` to "y", after what `add` puts into the graph.
template <typename Add>
std::string file_with(const std::string& second, Add&& add) {
  ProtobufWriter file, graph, node, opset;
  node.add_text(1, "x");
  node.add_text(1, second);
  node.add_text(2, "y");
  node.add_text(4, "Add");
  add(&graph);
  graph.add_message(1, node);
  graph.add_message(11, named("x"));
  graph.add_message(12, named("y"));
  opset.add_int(2, 9);
  file.add_message(8, opset);
  file.add_message(7, graph);
  return file.bytes();
}

TEST(OnnxFile, ReadsWhatItWrote) {
  const TestFolder folder;
  OnnxModel model = sample_onnx();
  model.nodes[0].attributes = {
      {"f", 0.5F}, {"t", std::string("NOTSET")}, {"n", std::vector<std::int64_t>{1, -2}}, {"g", std::vector<float>{3, 4}}};
  model.weights.push_back({"scalar", {}, {7}});
  model.opset = 11;
  model.metadata["source"] =
      "K\xc3\xbc"
      "che";
  ASSERT_TRUE(write_onnx(folder / "a.onnx", model));
  const Result<OnnxModel> read = read_onnx(folder / "a.onnx");
  ASSERT_TRUE(read) << read.status().message();
  EXPECT_EQ(read->opset, 11);
  EXPECT_EQ(read->producer, "camloc");
  EXPECT_EQ(read->metadata, model.metadata);
  ASSERT_EQ(read->nodes.size(), 3U);
  EXPECT_EQ(read->nodes[2].op, "Gemm");
  EXPECT_EQ(read->nodes[2].name, "head");
  EXPECT_EQ(read->nodes[2].inputs, model.nodes[2].inputs);
  EXPECT_EQ(read->nodes[2].outputs, model.nodes[2].outputs);
  ASSERT_EQ(read->nodes[0].attributes.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(read->nodes[0].attributes[i].name, model.nodes[0].attributes[i].name);
    EXPECT_EQ(read->nodes[0].attributes[i].value, model.nodes[0].attributes[i].value);
  }
  ASSERT_EQ(read->weights.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read->weights[i].name, model.weights[i].name);
    EXPECT_EQ(read->weights[i].shape, model.weights[i].shape);
    EXPECT_EQ(read->weights[i].values, model.weights[i].values);
  }
  EXPECT_EQ(read->inputs[0].shape, (std::vector<std::int64_t>{1, 2, 12, 16}));
  EXPECT_EQ(read->outputs[0].name, "pose");
}

TEST(OnnxFile, WeightsAreNoInputsAndOtherTypesAreKeptOut) {
  const std::string floats("\0\0\x80\x3f", 4), integers("\1\0\0\0\0\0\0\0", 8);
  const auto read = parse_onnx(as_bytes(file_with("w", [&](ProtobufWriter* graph) {
    graph->add_message(5, tensor("w", 1, floats, {1}));
    graph->add_message(5, tensor("shape", 7, integers, {1}));
    graph->add_message(11, named("w"));
    graph->add_message(11, named("shape"));
  })));
  ASSERT_TRUE(read) << read.status().message();
  ASSERT_EQ(read->weights.size(), 1U);
  EXPECT_EQ(read->weights[0].values, std::vector<float>{1});
  ASSERT_EQ(read->inputs.size(), 1U);
  EXPECT_EQ(read->inputs[0].name, "x");
}

TEST(OnnxFile, AConstantIsAWeightAndOneOfAnotherTypeCannotBeWritten) {
  for (const std::int64_t type : {1, 7}) {
    const auto read = parse_onnx(as_bytes(file_with("w", [&](ProtobufWriter* graph) {
      ProtobufWriter node, attribute;
      attribute.add_text(1, "value");
      attribute.add_message(5, tensor("", type, std::string(8, '\0'), {type == 1 ? 2 : 1}));
      attribute.add_int(20, 4);
      node.add_message(5, attribute);
      node.add_text(2, "w");
      node.add_text(4, "Constant");
      graph->add_message(1, node);
    })));
    ASSERT_TRUE(read) << read.status().message();
    EXPECT_EQ(read->nodes.size(), 1U);
    EXPECT_EQ(read->weights.size(), type == 1 ? 1U : 0U);
    EXPECT_EQ(encode_onnx(*read).is_ok(), type == 1);
  }
}

TEST(OnnxFile, EveryTruncationIsAnErrorOrStillANetwork) {
  const std::string bytes = *encode_onnx(sample_onnx());
  std::size_t num_refused = 0;
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto read = parse_onnx(as_bytes(std::string_view(bytes).substr(0, size)));
    EXPECT_EQ(read.status().message().find('\n'), std::string::npos);
    num_refused += read ? 0 : 1;
  }
  // Metadata stands last: cut between two of its pairs, the file is whole for ONNX.
  EXPECT_GT(num_refused, bytes.size() - 30);
}

std::string message_of(const std::string& file) { return parse_onnx(as_bytes(file)).status().message(); }

TEST(OnnxFile, SaysWhatIsWrong) {
  const auto with_tensor = [](const ProtobufWriter& weight) {
    return message_of(file_with("w", [&](ProtobufWriter* graph) { graph->add_message(5, weight); }));
  };
  EXPECT_NE(with_tensor(tensor("w", 1, "12345678", {3})).find("2 values, which is not what its shape says"), std::string::npos);
  EXPECT_NE(with_tensor(tensor("w", 1, "12345", {1})).find("part of a number"), std::string::npos);
  EXPECT_NE(with_tensor(tensor("w", 1, "", {std::int64_t{1} << 40, std::int64_t{1} << 40})).find("not what its shape says"),
            std::string::npos);
  EXPECT_NE(with_tensor(tensor("w", 1, "", {-1})).find("not what its shape says"), std::string::npos);
  ProtobufWriter elsewhere = tensor("w", 1, "", {1});
  elsewhere.add_int(14, 1);
  EXPECT_NE(with_tensor(elsewhere).find("second file"), std::string::npos);
  EXPECT_NE(message_of(file_with("w", [](ProtobufWriter*) {})).find("which nothing before it makes"), std::string::npos);
  EXPECT_NE(message_of("").find("no network"), std::string::npos);
  EXPECT_NE(message_of("%PDF-1.4").find("no ONNX file"), std::string::npos);
}

TEST(OnnxFile, WritesNothingThatContradictsItself) {
  const TestFolder folder;
  OnnxModel model = sample_onnx();
  model.weights[0].values.pop_back();
  EXPECT_EQ(write_onnx(folder / "a.onnx", model).code(), ErrorCode::kInvalid);
  model = sample_onnx();
  model.nodes[1].inputs[0] = "nobody";
  EXPECT_NE(write_onnx(folder / "a.onnx", model).message().find("nobody"), std::string::npos);
  model = sample_onnx();
  model.weights.push_back({"image", {1}, {0}});
  EXPECT_NE(write_onnx(folder / "a.onnx", model).message().find("made twice"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.onnx"));
  EXPECT_EQ(write_onnx(folder / "none/a.onnx", sample_onnx()).code(), ErrorCode::kIo);
}

TEST(OnnxFile, RefusesAFileThatIsTooLargeWithoutReadingIt) {
  const TestFolder folder;
  folder.write("large.onnx", "");
  std::filesystem::resize_file(folder / "large.onnx", kMaxOnnxBytes + 1);
  EXPECT_EQ(read_onnx(folder / "large.onnx").status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(read_onnx(folder / "none.onnx").status().code(), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace camloc
