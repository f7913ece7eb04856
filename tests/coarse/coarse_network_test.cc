// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/coarse_network.h"

#include "tests/coarse/sample_model.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

#ifdef CAMLOC_NETWORK_PLUGIN_FILE
const std::string kPlugin = CAMLOC_NETWORK_PLUGIN_FILE;
#else
const std::string kPlugin;
#endif

#define SKIP_WITHOUT_PLUGIN() \
  if (kPlugin.empty()) GTEST_SKIP() << "the plug-in is not built: libopencv-dnn-dev is missing"

RgbdCamera small_camera() {
  RgbdCamera camera;
  camera.color = {64, 48, 58, 58, 31.5, 23.5, LensModel::kPinhole, {}};
  camera.depth = camera.color;
  return camera;
}

CoarseModel sample_model() { return {sample_onnx(), sample_coarse_info()}; }

/// All pixels alike.
FrameBuffer even_frame(std::uint8_t gray, std::uint16_t depth_mm) {
  FrameBuffer frame;
  frame.stamp_ns = 42;
  frame.gray.resize(64, 48);
  frame.depth.resize(64, 48);
  std::fill(frame.gray.pixels.begin(), frame.gray.pixels.end(), gray);
  std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), depth_mm);
  return frame;
}

TEST(CoarseNetwork, GivesThePoseWorkedOutByHand) {
  SKIP_WITHOUT_PLUGIN();
  auto network = CoarseNetwork::load(sample_model(), small_camera(), kPlugin);
  ASSERT_TRUE(network) << network.status().message();
  EXPECT_EQ(network->engine().substr(0, 7), "OpenCV ");
  for (const auto& [gray, depth_mm] : {std::pair<std::uint8_t, std::uint16_t>(191, 2500), {0, 1000}, {255, 0}}) {
    const FrameBuffer frame = even_frame(gray, depth_mm);
    const auto pose = network->locate(frame.view());
    ASSERT_TRUE(pose) << pose.status().message();
    const double g = (gray - 127.5) / 64, d = depth_mm / 5000.0;
    EXPECT_LT((pose->T_map_camera.translation - Eigen::Vector3d(1 + 0.5 * g, 2 + 2 * d, 3 - g)).norm(), 1e-5);
    EXPECT_LT(rotation_distance_rad(pose->T_map_camera.rotation, Eigen::Quaterniond::Identity()), 1e-6);
    EXPECT_EQ(pose->stamp_ns, 42);
    EXPECT_EQ(pose->covariance(2, 2), 0.0625);
  }
}

TEST(CoarseNetwork, TheSameFrameGivesTheSameBitsAlsoFromAnotherCopy) {
  SKIP_WITHOUT_PLUGIN();
  FrameBuffer frame = even_frame(0, 1234);
  for (std::size_t i = 0; i < frame.gray.pixels.size(); ++i) frame.gray.pixels[i] = static_cast<std::uint8_t>(i * 31 % 253);
  std::optional<Eigen::Vector3d> first;
  for (int copy = 0; copy < 2; ++copy) {
    auto network = CoarseNetwork::load(sample_model(), small_camera(), kPlugin);
    ASSERT_TRUE(network);
    for (int i = 0; i < 2; ++i) {
      const Eigen::Vector3d position = network->locate(frame.view())->T_map_camera.translation;
      EXPECT_EQ(position, first.value_or(position));
      first = position;
    }
  }
}

TEST(CoarseNetwork, AnOperatorThatNobodyKnowsIsRefusedInOneLine) {
  SKIP_WITHOUT_PLUGIN();
  CoarseModel model = sample_model();
  model.onnx.nodes[0].op = "GlobalMagicPool";
  const auto network = CoarseNetwork::load(model, small_camera(), kPlugin);
  ASSERT_FALSE(network);
  EXPECT_NE(network.status().message().find("refuses the network: "), std::string::npos);
  EXPECT_EQ(network.status().message().find('\n'), std::string::npos);
}

TEST(CoarseNetwork, AGraphOfAnotherShapeThanItSaysIsAnError) {
  SKIP_WITHOUT_PLUGIN();
  CoarseModel model = sample_model();
  model.onnx.weights[0] = {"head_w", {6, 2}, std::vector<float>(12, 0.0F)};
  model.onnx.weights[1] = {"head_b", {6}, std::vector<float>(6, 0.0F)};
  auto network = CoarseNetwork::load(model, small_camera(), kPlugin);
  const Status status = network ? network->locate(even_frame(1, 1).view()).status() : network.status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalid);
  model = sample_model();
  model.onnx.weights[1].values.assign(7, 0.0F);
  network = CoarseNetwork::load(model, small_camera(), kPlugin);
  ASSERT_TRUE(network);
  EXPECT_EQ(network->locate(even_frame(100, 0).view()).status().message(), "the network's output is no pose");
}

TEST(CoarseNetwork, SaysWhatIsMissing) {
  const TestFolder folder;
  const auto message = [](const std::string& path) { return CoarseNetwork::load(sample_model(), small_camera(), path).status().message(); };
  EXPECT_NE(message(folder / "none.so").find("the package camloc-coarse"), std::string::npos);
  EXPECT_NE(message(folder.write("text.so", "no library")).find("cannot load the plug-in"), std::string::npos);
  EXPECT_NE(message("/proc/self/exe"), "");
}

}  // namespace
}  // namespace camloc
