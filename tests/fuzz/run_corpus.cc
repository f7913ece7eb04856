// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs a fuzz target over its corpus without libFuzzer: every file as it is, then with deterministic damage (cut, bytes
// flipped, bytes doubled), so that the target is exercised on every machine and in every sanitizer build.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

std::vector<std::uint8_t> read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::vector<std::uint8_t> damaged(std::vector<std::uint8_t> bytes, std::mt19937& random) {
  if (bytes.empty()) return bytes;
  auto position = [&] { return random() % bytes.size(); };
  switch (random() % 4) {
    case 0: bytes.resize(position()); break;
    case 1: bytes[position()] ^= static_cast<std::uint8_t>(1U << (random() % 8)); break;
    case 2:
      for (int i = 0; i < 8; ++i) bytes[position()] = static_cast<std::uint8_t>(random());
      break;
    default: bytes.insert(bytes.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(position())); break;
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int kDamagedCopies = 200;
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i) {
    if (!std::filesystem::is_directory(argv[i])) {
      files.emplace_back(argv[i]);
      continue;
    }
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    std::fprintf(stderr, "no corpus: give files or folders\n");
    return 1;
  }
  std::size_t runs = 0;
  for (const auto& path : files) {
    const std::vector<std::uint8_t> bytes = read_file(path);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    std::mt19937 random(1234);
    for (int i = 0; i < kDamagedCopies; ++i, ++runs) {
      const std::vector<std::uint8_t> copy = damaged(bytes, random);
      LLVMFuzzerTestOneInput(copy.data(), copy.size());
    }
  }
  std::printf("%zu files, %zu damaged copies: no crash\n", files.size(), runs);
  return 0;
}
