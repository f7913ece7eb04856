// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// What the driver tests share: a scratch folder that goes away, files in it, and where the real recordings are.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/io/image_writer.h"

namespace camloc {

class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "camloc_test_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  /// Writes a file, making its folders; returns its path.
  std::string write(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path path = std::filesystem::path(path_) / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
    return path.string();
  }

 private:
  std::string path_;
};

inline std::vector<std::uint8_t> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// A smooth colour image, so that JPEG changes it little.
inline ColorImage smooth_color(int width, int height, int seed = 0) {
  ColorImage image{{}, width, height};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.pixels.push_back(static_cast<std::uint8_t>(40 + (2 * x + seed) % 200));
      image.pixels.push_back(static_cast<std::uint8_t>(40 + (2 * y + 3 * seed) % 200));
      image.pixels.push_back(static_cast<std::uint8_t>(60 + seed % 100));
    }
  }
  return image;
}

inline Image<std::uint16_t> ramp_depth(int width, int height, int seed = 0) {
  Image<std::uint16_t> image;
  image.resize(width, height);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = static_cast<std::uint16_t>(i * 257 + static_cast<std::size_t>(seed));
  return image;
}

/// A 7-Scenes folder of `count` frames, with depth and without poses.
inline void write_7scenes(const TestFolder& folder, int count, int width = 32, int height = 24) {
  for (int i = 0; i < count; ++i) {
    char name[32];
    std::snprintf(name, sizeof(name), "frame-%06d", i);
    ASSERT_TRUE(write_jpeg(folder / (std::string(name) + ".color.jpg"), smooth_color(width, height, i)));
    ASSERT_TRUE(write_depth_png(folder / (std::string(name) + ".depth.png"), ramp_depth(width, height, i)));
  }
}

inline std::filesystem::path source_folder() { return std::filesystem::path(__FILE__).parent_path().parent_path().parent_path(); }

/// A folder of real recordings; may not exist.
inline std::string data_folder(const std::string& name) {
  const char* data = std::getenv("CAMLOC_DATA");
  return ((data != nullptr ? std::filesystem::path(data) : source_folder() / "../shared/data") / name).string();
}

}  // namespace camloc
