// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/camloc-sim/dataset.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "core/io/camera_file.h"
#include "core/io/file_bytes.h"
#include "core/io/sequence.h"
#include "tools/camloc-sim/building.h"

namespace camloc::sim {
namespace {

namespace fs = std::filesystem;

class Dataset : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "camloc_sim_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }

  static DatasetOptions tiny() {
    DatasetOptions options;
    options.kind = SceneKind::kSmall;
    options.recording.rate_hz = 10;
    options.recording.duration_scale = 0.02;
    options.lidar_step_m = 0.1;
    return options;
  }
  static std::string read(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  static std::map<std::string, std::string> read_all(const fs::path& folder) {
    std::map<std::string, std::string> result;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) result[fs::relative(entry.path(), folder).string()] = read(entry.path());
    }
    return result;
  }

  fs::path folder_;
};

TEST_F(Dataset, SameOptionsSameBytesWhateverTheNumberOfThreads) {
  DatasetOptions options = tiny();
  ASSERT_TRUE(write_dataset(folder_ / "one", options, {}).is_ok());
  options.recording.num_jobs = 3;
  ASSERT_TRUE(write_dataset(folder_ / "three", options, {}).is_ok());
  const auto one = read_all(folder_ / "one"), three = read_all(folder_ / "three");
  EXPECT_GT(one.size(), 20U);
  EXPECT_TRUE(one == three);
  options.seed = 2;
  ASSERT_TRUE(write_dataset(folder_ / "other", options, {}).is_ok());
  EXPECT_FALSE(one == read_all(folder_ / "other"));
}

TEST_F(Dataset, IsReadableAsAnyOtherSequence) {
  const DatasetOptions options = tiny();
  const Result<DatasetSummary> summary = write_dataset(folder_ / "set", options, {});
  ASSERT_TRUE(summary.is_ok()) << summary.status().message();
  const Result<RgbdCamera> camera = read_camera_file(folder_ / "set/camera.toml");
  ASSERT_TRUE(camera.is_ok()) << camera.status().message();
  EXPECT_EQ(camera->color.fx, 525.0);
  EXPECT_EQ(camera->depth_unit_m, 0.0002);
  for (const std::uint32_t day : {1U, 2U}) {
    const World world = make_world({options.kind, options.seed, day});
    const std::string name = folder_ / "set" / (day == 1 ? "mapping" : "day2");
    const Result<Sequence> sequence = read_sequence(name);
    ASSERT_TRUE(sequence.is_ok()) << sequence.status().message();
    const auto num_frames = static_cast<std::size_t>(day == 1 ? summary->num_mapping_frames : summary->num_day2_frames);
    ASSERT_EQ(sequence->frames.size(), num_frames);
    const Result<std::vector<std::optional<Rigid3>>> poses = read_embedded_poses(*sequence);
    ASSERT_TRUE(poses.is_ok()) << poses.status().message();
    for (std::size_t i = 0; i < num_frames; ++i) {
      EXPECT_FALSE(sequence->frames[i].depth_path.empty());
      if (i > 0) { EXPECT_EQ(sequence->frames[i].stamp_ns - sequence->frames[i - 1].stamp_ns, 100'000'000); }
      ASSERT_TRUE((*poses)[i].has_value());
      const Vector6d error = pose_error(world.trajectory.pose(0.1 * static_cast<double>(i)), *(*poses)[i]);
      EXPECT_LT(error.norm(), 1e-6);
    }
  }
}

TEST_F(Dataset, RefusesAFolderWithSomethingInIt) {
  fs::create_directories(folder_ / "set");
  ASSERT_TRUE(replace_file(folder_ / "set/notes.txt", "mine").is_ok());
  DatasetOptions options = tiny();
  const Result<DatasetSummary> refused = write_dataset(folder_ / "set", options, {});
  ASSERT_FALSE(refused.is_ok());
  EXPECT_EQ(refused.status().code(), ErrorCode::kInvalid);
  EXPECT_NE(refused.status().message().find("--force"), std::string::npos);
  options.may_overwrite = true;
  options.only = "lidar";
  EXPECT_TRUE(write_dataset(folder_ / "set", options, {}).is_ok());
  EXPECT_EQ(read(folder_ / "set/notes.txt"), "mine");
}

TEST_F(Dataset, ReportsWhereItCannotWrite) {
  ASSERT_TRUE(replace_file(folder_ / "file", "x").is_ok());
  const Result<DatasetSummary> result = write_dataset(folder_ / "file", tiny(), {});
  ASSERT_FALSE(result.is_ok());
  EXPECT_EQ(result.status().code(), ErrorCode::kIo);
}

TEST_F(Dataset, AFailingFrameEndsTheRecording) {
  fs::create_directories(folder_ / "walk");
  ASSERT_TRUE(replace_file(folder_ / "walk/rgb", "in the way").is_ok());
  const World world = make_world({SceneKind::kSmall, 1, 1});
  const Result<int> result = record(world, tiny().recording, folder_ / "walk", {});
  ASSERT_FALSE(result.is_ok());
  EXPECT_EQ(result.status().code(), ErrorCode::kIo);
}

TEST_F(Dataset, LidarPointsLieOnStaticSurfaces) {
  const Scene scene = build_scene(floor_plan(SceneKind::kSmall, 1), {SceneKind::kSmall, 1, 1});
  const std::string path = folder_ / "cloud.ply";
  const Result<std::uint64_t> count = write_lidar_ply(path, scene, 0.2, 1);
  ASSERT_TRUE(count.is_ok());
  const std::string bytes = read(path);
  const std::string end = "end_header\n";
  const std::size_t start = bytes.find(end) + end.size();
  EXPECT_NE(bytes.find("element vertex " + std::to_string(*count) + "\n"), std::string::npos);
  ASSERT_EQ(bytes.size() - start, 13 * *count);
  int num_checked = 0;
  for (std::uint64_t i = 0; i < *count; i += 37, ++num_checked) {
    float xyz[3];
    std::memcpy(xyz, bytes.data() + start + 13 * i, 12);
    const Eigen::Vector3d p(xyz[0], xyz[1], xyz[2]);
    double nearest = 1e9;
    for (const Surface& s : scene.surfaces) {
      const Eigen::Vector3d offset = p - s.origin;
      const double u = offset.dot(s.u_axis), v = offset.dot(s.v_axis);
      if (s.is_static && u > -0.001 && v > -0.001 && u < s.width + 0.001 && v < s.height + 0.001)
        nearest = std::min(nearest, std::fabs(offset.dot(s.normal())));
    }
    ASSERT_LT(nearest, 0.012) << p.transpose();
  }
  EXPECT_GT(num_checked, 200);
}

}  // namespace
}  // namespace camloc::sim
