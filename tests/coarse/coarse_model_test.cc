// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/coarse_model.h"

#include <cmath>

#include "tests/coarse/sample_model.h"
#include "tests/drivers/test_folder.h"

namespace camloc {
namespace {

TEST(CoarseModel, ReadsWhatWasSet) {
  const TestFolder folder;
  ASSERT_TRUE(write_onnx(folder / "a.onnx", sample_onnx()));
  const Result<CoarseModel> model = read_coarse_model(folder / "a.onnx");
  ASSERT_TRUE(model) << model.status().message();
  const CoarseModelInfo info = sample_coarse_info();
  EXPECT_EQ(model->info.map_id, info.map_id);
  EXPECT_EQ(model->info.net, info.net);
  EXPECT_EQ(model->info.training, info.training);
  EXPECT_EQ(model->info.num_training_frames, info.num_training_frames);
  EXPECT_EQ(model->info.layout.channels, 2);
  EXPECT_EQ(model->info.layout.width, 16);
  EXPECT_EQ(model->info.layout.height, 12);
  EXPECT_EQ(model->info.layout.focal_px, info.layout.focal_px);
  EXPECT_EQ(model->info.layout.mean, info.layout.mean);
  EXPECT_EQ(model->info.layout.scale, info.layout.scale);
  EXPECT_EQ(model->info.sigma_position_m, info.sigma_position_m);
  EXPECT_EQ(model->info.sigma_rotation_rad, info.sigma_rotation_rad);
  EXPECT_EQ(model->info.train_fx, 525);
  EXPECT_EQ(model->info.train_fy, 525.5F);
  EXPECT_EQ(model->info.train_width, 640);
  EXPECT_EQ(model->info.train_height, 480);
}

TEST(CoarseModel, RefusesEachBadNumberWithItsKey) {
  const OnnxModel good = sample_onnx();
  for (const auto& [key, value] : good.metadata) {
    OnnxModel bad = good;
    bad.metadata.erase(key);
    EXPECT_NE(coarse_info_of(bad).status().message().find(key), std::string::npos) << key;
    if (key == "camloc.net" || key == "camloc.training") continue;
    for (const char* text : {"nan", "-1e30", "", "1.5.2", "inf"}) {
      bad.metadata[key] = text;
      EXPECT_NE(coarse_info_of(bad).status().message().find(key), std::string::npos) << key << " = " << text;
    }
  }
  OnnxModel bad = good;
  bad.metadata["camloc.width"] = "16.5";
  EXPECT_FALSE(coarse_info_of(bad));
  bad.metadata["camloc.width"] = "16";
  bad.metadata["camloc.sigma_position_m"] = "0";
  EXPECT_FALSE(coarse_info_of(bad));
}

TEST(CoarseModel, TheGraphMustSayTheSame) {
  const auto message = [](const OnnxModel& model) { return coarse_info_of(model).status().message(); };
  OnnxModel bad = sample_onnx();
  bad.inputs[0].shape = {1, 2, 16, 12};
  EXPECT_EQ(message(bad), "its input is 1x2x16x12, its metadata says 1x2x12x16");
  bad = sample_onnx();
  bad.outputs[0].shape = {1, 6};
  EXPECT_EQ(message(bad), "its output is 1x6; a pose is 1x7");
  bad = sample_onnx();
  bad.outputs.push_back({"means", {1, 2}});
  EXPECT_NE(message(bad).find("one of each"), std::string::npos);
  bad = sample_onnx();
  bad.weights[0].values[3] = std::nanf("");
  EXPECT_NE(message(bad).find("'head_w'"), std::string::npos) << message(bad);
  bad.weights[0].values[3] = INFINITY;
  EXPECT_FALSE(coarse_info_of(bad));
}

TEST(CoarseModel, IsForOneMap) {
  EXPECT_TRUE(check_coarse_map(sample_coarse_info(), 0xAB));
  const std::string message = check_coarse_map(sample_coarse_info(), 0xAC).message();
  EXPECT_NE(message.find("00000000000000ab"), std::string::npos);
  EXPECT_NE(message.find("00000000000000ac"), std::string::npos);
  EXPECT_EQ(map_id_text(0x0123456789abcdefU), "0123456789abcdef");
}

TEST(CoarseModel, APoseFromItsOutput) {
  const std::optional<Rigid3> pose = coarse_pose(std::array<float, 7>{1, 2, 3, 0, 0, 2, 0});
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(pose->rotation.coeffs(), Eigen::Vector4d(0, 1, 0, 0));  // x y z w
  EXPECT_FALSE(coarse_pose(std::array<float, 7>{1, 2, 3, 0, 0, 0, 0}));
  EXPECT_FALSE(coarse_pose(std::array<float, 7>{NAN, 2, 3, 1, 0, 0, 0}));
  EXPECT_FALSE(coarse_pose(std::array<float, 6>{1, 2, 3, 1, 0, 0}));
  const Matrix6d covariance = coarse_covariance(sample_coarse_info());
  EXPECT_EQ(covariance(0, 0), 0.0625);
  EXPECT_EQ(covariance(5, 5), 0.015625);
  EXPECT_EQ(covariance(0, 5), 0);
}

}  // namespace
}  // namespace camloc
