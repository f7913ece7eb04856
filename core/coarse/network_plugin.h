// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What a library that runs networks looks like to who loads it: C, so that neither side's C++ crosses the border. No function throws,
// prints, or keeps a pointer that it was given; a network belongs to one thread at a time.
#pragma once

#include <cstddef>
#include <cstdint>

// NOLINTBEGIN(modernize-use-using)
extern "C" {

constexpr std::uint32_t kCamlocNetworkPluginVersion = 1;
#define CAMLOC_NETWORK_PLUGIN_FUNCTION "camloc_network_plugin"

struct CamlocNetworkPlugin {
  std::uint32_t version;  ///< kCamlocNetworkPluginVersion of its build
  const char* engine;     ///< what runs the networks, for people: "OpenCV 4.6.0"
  /// A network of one input and one output from the bytes of an ONNX file, run once, so that memory and errors come now; nullptr and
  /// one line in `error`. `shape` is that of the input, 1 x C x H x W.
  void* (*create)(const void* onnx, std::size_t num_bytes, const std::int32_t shape[4], char* error, std::size_t error_bytes);
  /// 0, or another number and one line in `error` (also where the numbers are not those of the network).
  int (*run)(void* network, const float* input, std::size_t num_inputs, float* output, std::size_t num_outputs, char* error,
             std::size_t error_bytes);
  void (*destroy)(void* network);
};

typedef const CamlocNetworkPlugin* (*CamlocNetworkPluginFunction)();
}
// NOLINTEND(modernize-use-using)
