// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Views come back from the log bit for bit; whatever happens to the file, what is read was written.
#include "tools/mapping/build/frame_log.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <random>

#include "tests/drivers/test_folder.h"

namespace camloc::mapping {
namespace {

constexpr std::uint64_t kIdentity = 0x1234567890ABCDEF;

LoggedFrame random_view(std::uint64_t frame, std::size_t num_features, std::size_t num_surface) {
  std::mt19937_64 rng(frame + 1);
  const auto number = [&] { return std::uniform_real_distribution<float>(-5, 700)(rng); };
  LoggedFrame logged;
  logged.frame = frame;
  logged.view.stamp_ns = 1'000'000'000'000 + static_cast<std::int64_t>(frame * 33'333'333);
  for (std::size_t i = 0; i < num_features; ++i) {
    logged.view.features.keypoints.push_back({number(), number(), number(), number(), static_cast<std::uint8_t>(rng() % 8)});
    logged.view.features.descriptors.push_back({{rng(), rng(), rng(), rng()}});
    logged.view.normalized.emplace_back(number(), number());
    logged.view.depth_m.push_back(i % 3 == 0 ? 0 : number());
  }
  if (frame == 0) logged.view.patches.resize(num_features);
  for (FeaturePatch& patch : logged.view.patches) {
    for (std::uint8_t& grey : patch.pixels) grey = static_cast<std::uint8_t>(rng());
  }
  if (frame != 3) {
    logged.thumbnail.width = 8;
    logged.thumbnail.height = 6;
    logged.thumbnail.cell_px = 8;
    for (std::size_t i = 0; i < 48; ++i) {
      logged.thumbnail.grey.push_back(static_cast<std::uint16_t>(rng()));
      logged.thumbnail.depth.push_back(static_cast<std::uint16_t>(rng()));
    }
  }
  for (std::size_t i = 0; i < num_surface; ++i) logged.surface_m.emplace_back(number(), number(), number());
  return logged;
}

std::vector<LoggedFrame> random_views() {
  return {random_view(0, 30, 12), random_view(3, 0, 5), random_view(4, 50, 0), random_view(5, 0, 0), random_view(9, 20, 20)};
}

void expect_equal(const LoggedFrame& a, const LoggedFrame& b) {
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.view.stamp_ns, b.view.stamp_ns);
  ASSERT_EQ(a.view.size(), b.view.size());
  EXPECT_EQ(a.view.features.descriptors, b.view.features.descriptors);
  EXPECT_EQ(a.view.normalized, b.view.normalized);
  EXPECT_EQ(a.view.depth_m, b.view.depth_m);
  EXPECT_EQ(a.surface_m, b.surface_m);
  EXPECT_EQ(a.thumbnail.grey, b.thumbnail.grey);
  EXPECT_EQ(a.thumbnail.depth, b.thumbnail.depth);
  EXPECT_EQ(std::tie(a.thumbnail.width, a.thumbnail.height, a.thumbnail.cell_px),
            std::tie(b.thumbnail.width, b.thumbnail.height, b.thumbnail.cell_px));
  ASSERT_EQ(a.view.patches.size(), b.view.patches.size());
  for (std::size_t i = 0; i < a.view.patches.size(); ++i) EXPECT_EQ(a.view.patches[i].pixels, b.view.patches[i].pixels);
  for (std::size_t i = 0; i < a.view.size(); ++i) {
    const Keypoint &p = a.view.features.keypoints[i], &q = b.view.features.keypoints[i];
    EXPECT_EQ(std::tie(p.u, p.v, p.angle_rad, p.response, p.level), std::tie(q.u, q.v, q.angle_rad, q.response, q.level));
  }
}

void write_log(const std::string& path, const std::vector<LoggedFrame>& views) {
  auto writer = FrameLogWriter::create(path, kIdentity);
  ASSERT_TRUE(writer.is_ok()) << writer.status().message();
  for (const LoggedFrame& view : views) ASSERT_TRUE(writer->add(view).is_ok());
  ASSERT_TRUE(writer->flush().is_ok());
}

/// How many views come out; all must be those that went in.
std::size_t num_readable(const std::string& path, const std::vector<LoggedFrame>& written, std::uint64_t* size_bytes = nullptr) {
  auto reader = FrameLogReader::open(path, kIdentity);
  if (!reader.is_ok()) return 0;
  std::size_t count = 0;
  LoggedFrame view;
  Status status = Status::ok();
  while ((status = reader->next(&view)).is_ok()) {
    if (count == written.size()) {
      ADD_FAILURE() << "more views than were written";
      return count;
    }
    expect_equal(view, written[count++]);
  }
  EXPECT_EQ(status.code(), ErrorCode::kEnd);
  if (size_bytes != nullptr) *size_bytes = reader->size_bytes();
  return count;
}

TEST(ViewLog, ViewsComeBackBitForBit) {
  const TestFolder folder;
  const auto views = random_views();
  write_log(folder / "log", views);
  std::uint64_t size_bytes = 0;
  EXPECT_EQ(num_readable(folder / "log", views, &size_bytes), views.size());
  EXPECT_EQ(size_bytes, std::filesystem::file_size(folder / "log"));
}

TEST(ViewLog, TheLogEndsWhereItWasCutOff) {
  const TestFolder folder;
  const auto views = random_views();
  write_log(folder / "log", views);
  const std::vector<std::uint8_t> whole = bytes_of(folder / "log");
  std::size_t last = 0;
  for (std::size_t size = 0; size <= whole.size(); size += 37) {
    folder.write("cut", {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    const std::size_t count = num_readable(folder / "cut", views);
    EXPECT_GE(count, last);
    EXPECT_LT(count, views.size());
    last = count;
  }
  EXPECT_EQ(last, views.size() - 1);
}

TEST(ViewLog, AFlippedBitEndsTheLogThere) {
  const TestFolder folder;
  const auto views = random_views();
  write_log(folder / "log", views);
  const std::vector<std::uint8_t> whole = bytes_of(folder / "log");
  std::mt19937 rng(3);
  for (int i = 0; i < 200; ++i) {
    std::string damaged(whole.begin(), whole.end());
    const std::size_t at = 64 + rng() % (whole.size() - 64);
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (rng() % 8)));
    folder.write("damaged", damaged);
    EXPECT_LT(num_readable(folder / "damaged", views), views.size());
  }
}

TEST(ViewLog, ASizeFromADamagedHeaderIsNotBelieved) {
  const TestFolder folder;
  const auto views = random_views();
  write_log(folder / "log", views);
  std::string damaged;
  for (const std::uint8_t byte : bytes_of(folder / "log")) damaged.push_back(static_cast<char>(byte));
  for (std::size_t at = 64 + 16; at < 64 + 24; ++at) damaged[at] = '\xFF';  // both counts of the first record
  folder.write("damaged", damaged);
  EXPECT_EQ(num_readable(folder / "damaged", views), 0U);
}

TEST(ViewLog, AnotherBuildsLogIsRefused) {
  const TestFolder folder;
  write_log(folder / "log", random_views());
  const auto other = FrameLogReader::open(folder / "log", kIdentity + 1);
  ASSERT_FALSE(other.is_ok());
  EXPECT_EQ(other.status().code(), ErrorCode::kInvalid);
  EXPECT_NE(other.status().message().find("another recording"), std::string::npos);
  EXPECT_EQ(FrameLogReader::open(folder / "none", kIdentity).status().code(), ErrorCode::kNotFound);
  for (const std::string& bytes : {std::string(), std::string("hello"), std::string(64, '\0'), std::string(200, 'x')}) {
    folder.write("foreign", bytes);
    EXPECT_EQ(FrameLogReader::open(folder / "foreign", kIdentity).status().code(), ErrorCode::kCorrupt);
  }
}

TEST(ViewLog, AppendingGoesOnAfterACut) {
  const TestFolder folder;
  const auto views = random_views();
  write_log(folder / "log", views);
  const std::vector<std::uint8_t> whole = bytes_of(folder / "log");
  for (const std::size_t cut : {std::size_t{1}, std::size_t{100}, whole.size() / 2, whole.size() - 70}) {
    folder.write("cut", {whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(cut)});
    std::uint64_t size_bytes = 0;
    const std::size_t count = num_readable(folder / "cut", views, &size_bytes);
    auto writer = FrameLogWriter::append(folder / "cut", size_bytes);
    ASSERT_TRUE(writer.is_ok());
    for (std::size_t i = count; i < views.size(); ++i) ASSERT_TRUE(writer->add(views[i]).is_ok());
    ASSERT_TRUE(writer->flush().is_ok());
    EXPECT_EQ(bytes_of(folder / "cut"), whole);
  }
}

TEST(ViewLog, CreatingReplacesAnOldLog) {
  const TestFolder folder;
  write_log(folder / "log", random_views());
  write_log(folder / "log", {random_view(7, 3, 3)});
  EXPECT_EQ(num_readable(folder / "log", {random_view(7, 3, 3)}), 1U);
}

TEST(ViewLog, WhatCannotBeWrittenIsAnErrorWithThePath) {
  const TestFolder folder;
  const auto writer = FrameLogWriter::create(folder / "no/log", kIdentity);
  ASSERT_FALSE(writer.is_ok());
  EXPECT_EQ(writer.status().code(), ErrorCode::kIo);
  EXPECT_NE(writer.status().message().find("no/log"), std::string::npos);
  EXPECT_FALSE(FrameLogWriter::append(folder / "no/log", 64).is_ok());
  auto full = FrameLogWriter::create("/dev/full", kIdentity);
  ASSERT_TRUE(full.is_ok());
  Status status = full->add(random_view(0, 5000, 100));
  if (status.is_ok()) status = full->flush();
  EXPECT_EQ(status.code(), ErrorCode::kIo);
  EXPECT_NE(status.message().find("disk full"), std::string::npos) << status.message();
}

TEST(ViewLog, OneBuildAtATimeHasIt) {
  const TestFolder folder;
  {
    const auto lock = lock_frame_log(folder / "log");
    ASSERT_TRUE(lock.is_ok()) << lock.status().message();
    EXPECT_EQ(lock_frame_log(folder / "log").status().code(), ErrorCode::kUnavailable);
    ASSERT_TRUE(FrameLogWriter::create(folder / "log", kIdentity).is_ok()) << "who has it writes";
  }
  EXPECT_TRUE(lock_frame_log(folder / "log").is_ok()) << "a log may be there";
}

TEST(ViewLog, WhatIsNoLogIsLeftAlone) {
  const TestFolder folder;
  const std::string victim = folder.write("victim", "precious");
  std::filesystem::create_symlink("victim", folder / "link");
  std::filesystem::create_hard_link(victim, folder / "hard");
  EXPECT_EQ(lock_frame_log(victim).status().code(), ErrorCode::kInvalid);
  EXPECT_EQ(lock_frame_log(folder / "link").status().code(), ErrorCode::kInvalid);
  folder.write("empty", "");
  std::filesystem::create_hard_link(folder / "empty", folder / "second");
  EXPECT_EQ(lock_frame_log(folder / "empty").status().code(), ErrorCode::kInvalid) << "another name for somebody's file";
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(lock_frame_log(folder / "pipe").status().code(), ErrorCode::kInvalid);
  EXPECT_FALSE(FrameLogWriter::create(folder / "link", kIdentity).is_ok());
  EXPECT_EQ(std::filesystem::file_size(victim), 8U);
}

}  // namespace
}  // namespace camloc::mapping
