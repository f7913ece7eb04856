// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// A coarse model that runs: the frame's network input, the network in a plug-in library that is loaded for it, and a pose with the
// model's covariance.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/frame.h"
#include "core/coarse/coarse_model.h"
#include "core/coarse/network_input.h"

namespace camloc {

/// Where the camera was, by a network: decimetres or metres off, and never a pose to publish as it is.
struct CoarsePose {
  std::int64_t stamp_ns = 0;  ///< of the frame
  Rigid3 T_map_camera;
  Matrix6d covariance = Matrix6d::Zero();  ///< of pose_error()
};

/// The installed plug-in, or what the environment variable CAMLOC_NETWORK_PLUGIN names.
[[nodiscard]] std::string network_plugin_path();

/// Whether there is one to load: kNotFound says which package has it.
[[nodiscard]] Status check_network_plugin(const std::string& path = network_plugin_path());

/// Movable; belongs to one thread at a time. Loads the plug-in and the network at construction, gives both back at destruction. The
/// libraries behind the plug-in stay mapped, because the loader cannot unload them; what they hold in memory is given back.
class CoarseNetwork {
 public:
  /// Errors: kNotFound (no plug-in: which package has it), kUnsupported (a plug-in of another version, an operator it does not know),
  /// kInvalid (a network that it refuses).
  [[nodiscard]] static Result<CoarseNetwork> load(const CoarseModel& model, const RgbdCamera& camera,
                                                  const std::string& plugin_path = network_plugin_path());
  ~CoarseNetwork();
  CoarseNetwork(CoarseNetwork&&) noexcept;
  CoarseNetwork& operator=(CoarseNetwork&&) noexcept;

  /// kInvalid where the network gives no pose. The same frame gives the same bits.
  [[nodiscard]] Result<CoarsePose> locate(const Frame& frame);
  /// The network alone: what it makes of an input of NetworkInputLayout::size(). kInvalid where the library behind it fails.
  [[nodiscard]] Result<std::array<float, kCoarseOutputSize>> run(std::span<const float> input);
  [[nodiscard]] const std::string& engine() const;

 private:
  struct Impl;
  explicit CoarseNetwork(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace camloc
