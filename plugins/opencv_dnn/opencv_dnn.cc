// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs networks with OpenCV's dnn, on one core. A library of its own, loaded when it is needed: OpenCV brings 200 MB of packages that
// neither the daemon nor the command may link.
#include <algorithm>
#include <cstring>
#include <exception>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <string>

#include "core/coarse/network_plugin.h"

namespace {

struct Network {
  cv::dnn::Net net;
  cv::Mat input;
};

/// The first line of `what`, cut to fit.
void say(const std::string& what, char* error, std::size_t error_bytes) {
  if (error_bytes == 0) return;
  const std::size_t length = std::min({what.find('\n'), what.size(), error_bytes - 1});
  std::memcpy(error, what.data(), length);
  error[length] = '\0';
}

/// What OpenCV says without the place in its sources.
std::string said_by(const std::exception& exception) {
  const auto* error = dynamic_cast<const cv::Exception*>(&exception);
  const std::string text = error != nullptr ? error->err : exception.what();
  const std::size_t begin = text.find_first_not_of("\n ");
  return begin == std::string::npos ? "OpenCV does not say why" : text.substr(begin);
}

void* create(const void* onnx, std::size_t num_bytes, const std::int32_t shape[4], char* error, std::size_t error_bytes) {
  try {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    cv::setNumThreads(1);
    auto network = std::make_unique<Network>();
    network->net = cv::dnn::readNetFromONNX(static_cast<const char*>(onnx), num_bytes);
    network->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    network->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    const std::array<int, 4> sides{shape[0], shape[1], shape[2], shape[3]};
    network->input = cv::Mat(4, sides.data(), CV_32F, cv::Scalar(0));
    network->net.setInput(network->input);
    network->net.forward();
    return network.release();
  } catch (const std::exception& exception) { say(said_by(exception), error, error_bytes); } catch (...) {
    say("an unknown error", error, error_bytes);
  }
  return nullptr;
}

int run(void* opaque, const float* input, std::size_t num_inputs, float* output, std::size_t num_outputs, char* error,
        std::size_t error_bytes) {
  try {
    auto& network = *static_cast<Network*>(opaque);
    if (num_inputs != network.input.total()) return say("an input of another size", error, error_bytes), 1;
    std::memcpy(network.input.data, input, num_inputs * sizeof(float));
    network.net.setInput(network.input);
    const cv::Mat result = network.net.forward();
    if (result.type() != CV_32F || !result.isContinuous() || result.total() != num_outputs)
      return say("an output of another size: " + std::to_string(result.total()) + " numbers", error, error_bytes), 1;
    std::memcpy(output, result.data, num_outputs * sizeof(float));
    return 0;
  } catch (const std::exception& exception) { say(said_by(exception), error, error_bytes); } catch (...) {
    say("an unknown error", error, error_bytes);
  }
  return 1;
}

void destroy(void* network) { delete static_cast<Network*>(network); }

constexpr CamlocNetworkPlugin kPlugin{kCamlocNetworkPluginVersion, "OpenCV " CV_VERSION, create, run, destroy};

}  // namespace

extern "C" __attribute__((visibility("default"))) const CamlocNetworkPlugin* camloc_network_plugin() { return &kPlugin; }
