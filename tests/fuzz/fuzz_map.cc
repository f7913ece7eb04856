// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The map reader on arbitrary bytes: as they are, and with all hashes made right, so that the checks behind the hashes
// are reached. What opens is read completely.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <vector>

#include "core/base/unique_fd.h"
#include "core/map/look_alikes.h"
#include "core/map/map_sections.h"
#include "core/map/map_view.h"
#include "core/map/retrieval.h"
#include "tests/map/synthetic_map.h"

namespace {

using namespace camloc;

void require(bool condition) {
  if (!condition) std::abort();
}

void use(const MapView& view) {
  const MapInfo& info = view.info();
  std::uint64_t sum = 0;
  for (std::uint32_t i = 0; i < info.num_landmarks; ++i) {
    require(view.cube_of(i) < info.num_cubes);
    require(!view.landmark_descriptors(i).empty());
    for (const auto& d : view.landmark_descriptors(i)) sum += d.bits[3];
    require(view.position_m(i).allFinite() || view.cubes()[view.cube_of(i)].extent_m > 1e30F);
  }
  std::vector<std::uint32_t> list(info.max_keyframe_landmarks);
  for (std::uint32_t k = 0; k < info.num_keyframes; ++k) {
    const std::size_t count = view.keyframe_landmarks(k, list);
    for (std::size_t i = 0; i < count; ++i) require(list[i] < info.num_landmarks && (i == 0 || list[i] > list[i - 1]));
  }
  const LookAlikes look_alikes(view);
  for (std::uint32_t k = 0; k < info.num_keyframes; ++k) {
    for (std::size_t i = 0; i < look_alikes.num_rivals(k); ++i) {
      const RivalPose rival = look_alikes.rival(k, i);
      require(rival.keyframe < info.num_keyframes && rival.keyframe != k && rival.T_map_camera.translation.allFinite());
    }
  }
  for (std::uint32_t i = 0; i <= info.num_landmarks; ++i) sum += look_alikes.is_repeated(i) ? 1 : 0;
  Retriever retriever(view, 64);
  for (const auto& found : retriever.retrieve(view.words(), 5)) require(found.keyframe < info.num_keyframes);
  require(view.sections().size() >= map_format::kNumCoreSections && view.sections().size() <= map_format::kMaxSections);
  for (const MapSection& section : view.sections()) {
    for (const std::byte byte : view.section(section.record.id)) sum += static_cast<std::uint64_t>(byte);
  }
  volatile std::uint64_t keep = sum;
  static_cast<void>(keep);
}

/// In a buffer of exactly the right length, so that a sanitizer sees a read past the end.
void check_in_memory(const std::vector<std::byte>& bytes) {
  constexpr std::align_val_t kAlignment{map_format::kAlignment};
  std::byte* const exact = static_cast<std::byte*>(::operator new(bytes.size(), kAlignment));
  if (!bytes.empty()) std::memcpy(exact, bytes.data(), bytes.size());
  const Result<MapSections> sections = read_map_sections({exact, bytes.size()});
  if (sections.is_ok()) static_cast<void>(check_map_content(*sections));
  ::operator delete(exact, kAlignment);
}

void open_as_file(const std::vector<std::byte>& bytes) {
  const UniqueFd fd(::memfd_create("fuzz_map", MFD_CLOEXEC));
  require(fd.is_open() && ::write(fd.get(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  const Result<MapView> view = MapView::open("/proc/self/fd/" + std::to_string(fd.get()));
  if (view.is_ok()) use(*view);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  for (int pass = 0; pass < 2; ++pass) {
    check_in_memory(bytes);
    open_as_file(bytes);
    testing::reseal(bytes);
  }
  return 0;
}
