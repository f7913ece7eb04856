// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/training/device_check.h"

#include <algorithm>
#include <cmath>

#include "core/coarse/coarse_network.h"

namespace camloc::training {
namespace {

constexpr std::size_t kMostViews = 5;

}  // namespace

Result<double> compare_with_device(const std::string& model_path, const RgbdCamera& camera, const TrainingSet& set,
                                   std::span<const std::size_t> views, Trainer* trainer) {
  const auto model = read_coarse_model(model_path);
  if (!model) return model.status();
  auto network = CoarseNetwork::load(*model, camera);
  if (!network) return network.status();
  std::vector<float> input(set.input_size());
  std::mt19937_64 unused(1);
  double largest = 0;
  for (const std::size_t view : views.first(std::min(views.size(), kMostViews))) {
    static_cast<void>(set.draw(view, {0, 0, 0, 0, 0, 0}, &unused, input));
    const std::vector<float> wanted = trainer->best_output(input);
    const auto computed = network->run(input);
    if (!computed) return computed.status();
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      const double difference = std::abs(static_cast<double>((*computed)[i]) - wanted[i]);
      largest = std::max(largest, difference / std::max(1.0, std::abs(static_cast<double>(wanted[i]))));
    }
  }
  return largest;
}

}  // namespace camloc::training
