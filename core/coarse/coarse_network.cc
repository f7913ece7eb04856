// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/coarse_network.h"

#include <dlfcn.h>
#include <malloc.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "core/coarse/library_pages.h"
#include "core/coarse/network_plugin.h"

namespace camloc {
namespace {

struct CloseLibrary {
  void operator()(void* handle) const { ::dlclose(handle); }
};
using Library = std::unique_ptr<void, CloseLibrary>;

struct LoadedPlugin {
  Library library;
  const CamlocNetworkPlugin* functions = nullptr;
};

Result<LoadedPlugin> load_plugin(const std::string& path) {
  if (Status status = check_network_plugin(path); !status) return status;
  LoadedPlugin plugin;
  plugin.library.reset(::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL));
  if (!plugin.library) return Status(ErrorCode::kUnsupported, std::string("cannot load the plug-in: ") + ::dlerror());
  const auto function = reinterpret_cast<CamlocNetworkPluginFunction>(::dlsym(plugin.library.get(), CAMLOC_NETWORK_PLUGIN_FUNCTION));
  if (function == nullptr) return Status(ErrorCode::kUnsupported, path + ": is no plug-in of camloc");
  plugin.functions = function();
  if (plugin.functions == nullptr || plugin.functions->version != kCamlocNetworkPluginVersion)
    return Status(ErrorCode::kUnsupported, path + ": is of another version of camloc; install both of the same version");
  return plugin;
}

}  // namespace

struct CoarseNetwork::Impl {
  Impl(LoadedPlugin loaded, const CoarseModelInfo& info, const RgbdCamera& camera)
      : plugin(std::move(loaded)),
        engine(plugin.functions->engine),
        covariance(coarse_covariance(info)),
        input(camera, info.layout),
        values(input.size()) {}
  ~Impl() {
    if (network != nullptr) plugin.functions->destroy(network);
    give_back();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  /// Memory that only starting or ending took.
  void give_back() const {
    ::malloc_trim(0);
    give_back_library_pages(plugin.library.get());
  }
  [[nodiscard]] Status create(const CoarseModel& model);

  LoadedPlugin plugin;
  std::string engine;
  void* network = nullptr;
  Matrix6d covariance;
  NetworkInput input;
  std::vector<float> values;
};

Status CoarseNetwork::Impl::create(const CoarseModel& model) {
  // Written anew: the plug-in sees no byte that was not understood here.
  const Result<std::string> bytes = encode_onnx(model.onnx);
  if (!bytes) return bytes.status();
  const NetworkInputLayout& layout = model.info.layout;
  const std::array<std::int32_t, 4> shape{1, layout.channels, layout.height, layout.width};
  std::array<char, 200> error{};
  network = plugin.functions->create(bytes->data(), bytes->size(), shape.data(), error.data(), error.size());
  if (network == nullptr) return {ErrorCode::kInvalid, engine + " refuses the network: " + error.data()};
  return Status::ok();
}

std::string network_plugin_path() {
  const char* path = std::getenv("CAMLOC_NETWORK_PLUGIN");  // NOLINT(concurrency-mt-unsafe): nobody here sets any
  return path != nullptr ? path : CAMLOC_PLUGIN_FOLDER "/camloc-opencv-dnn.so";
}

Status check_network_plugin(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return Status::ok();
  return {ErrorCode::kNotFound, path + ": not there; coarse models are run by the package camloc-coarse, install it"};
}

Result<CoarseNetwork> CoarseNetwork::load(const CoarseModel& model, const RgbdCamera& camera, const std::string& plugin_path) {
  Result<LoadedPlugin> plugin = load_plugin(plugin_path);
  if (!plugin) return plugin.status();
  auto impl = std::make_unique<Impl>(std::move(*plugin), model.info, camera);
  if (Status status = impl->create(model); !status) return status;
  impl->give_back();  // reading a network takes several times its size, which would stay for as long as it is loaded
  return CoarseNetwork(std::move(impl));
}

CoarseNetwork::CoarseNetwork(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
CoarseNetwork::~CoarseNetwork() = default;
CoarseNetwork::CoarseNetwork(CoarseNetwork&&) noexcept = default;
CoarseNetwork& CoarseNetwork::operator=(CoarseNetwork&&) noexcept = default;

const std::string& CoarseNetwork::engine() const { return impl_->engine; }

Result<CoarsePose> CoarseNetwork::locate(const Frame& frame) {
  impl_->input.fill(frame, impl_->values);
  const auto output = run(impl_->values);
  if (!output) return output.status();
  const std::optional<Rigid3> T_map_camera = coarse_pose(*output);
  if (!T_map_camera) return Status(ErrorCode::kInvalid, "the network's output is no pose");
  return CoarsePose{frame.stamp_ns, *T_map_camera, impl_->covariance};
}

Result<std::array<float, kCoarseOutputSize>> CoarseNetwork::run(std::span<const float> input) {
  std::array<float, kCoarseOutputSize> output{};
  std::array<char, 200> error{};
  if (impl_->plugin.functions->run(impl_->network, input.data(), input.size(), output.data(), output.size(), error.data(), error.size()) !=
      0)
    return Status(ErrorCode::kInvalid, impl_->engine + " does not run the network: " + error.data());
  return output;
}

}  // namespace camloc
