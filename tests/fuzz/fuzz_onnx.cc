// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arbitrary bytes as a network: an error says why in one line, or what was read is whole, can be asked what it is for, and is the
// same after it was written and read again.
#include <cstdint>
#include <cstdlib>

#include "core/coarse/coarse_model.h"

namespace {

using namespace camloc;

void require(bool condition) {
  if (!condition) std::abort();
}

void require_one_line(const Status& status) { require(status.message().find('\n') == std::string::npos); }

std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Result<OnnxModel> model = parse_onnx({data, size});
  require_one_line(model.status());
  if (!model) return 0;
  for (const OnnxTensor& tensor : model->weights) require(num_values(tensor.shape) == static_cast<std::int64_t>(tensor.values.size()));
  require_one_line(coarse_info_of(*model).status());
  const Result<std::string> written = encode_onnx(*model);
  if (!written) return 0;  // something was kept out, or is there twice
  const Result<OnnxModel> again = parse_onnx(as_bytes(*written));
  require(again.is_ok() && *encode_onnx(*again) == *written);
  return 0;
}
