// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The .cmap file, byte by byte.
//
// Constraints
//   - A headset maps the file and localizes: no parsing, no pointers, no second copy of the large arrays.
//   - At most 60 bytes a landmark all in, because the descriptors alone are 35 (1.1 of 32 bytes each).
//   - Any damaged byte is noticed at open; a map never turns silently into another one.
//   - The same map gives the same bytes, so that files can be compared and identified by a hash.
//   - A section that is added later does not make maps unreadable: a reader that does not know it skips it, unless the
//     section says that it must be understood.
//
// Rejected
//   - FlatBuffers, Protocol Buffers, HDF5, SQLite: a parser or a library for what is a dozen arrays; alignment of 32-byte
//     descriptors is not theirs to promise.
//   - Compression: descriptors are noise to a compressor (under 3 %), and a compressed map cannot be mapped.
//   - float positions: 16 bits of a 4 m cube are 0.06 mm, the sensor has millimetres.
//   - An index of first descriptors: a running sum of num_descriptors at open costs 10 us and saves 4 bytes a landmark.
//   - 32-bit keyframe lists: steps between sorted indices are mostly below 128, one byte instead of four.
//   - Names of 8 bytes for sections: 32 bits hold four characters, and the table of format 1 stays what it was.
//
// Layout. Little-endian, IEEE 754, packed by hand: no record below has padding of its own.
//
//   0      FileHeader, 64 bytes. Its layout and its hash are the same in every version, so that a damaged header and a
//          newer version can be told apart.
//   64     num_sections SectionRecord of 32 bytes, ids ascending, then zeros up to a multiple of 64. The kNumCoreSections
//          below come first and are in every map, maybe without elements; others follow where the map has them.
//   ...    The sections in the same order, without gaps. Each starts at a multiple of 64 and is followed by zeros up to
//          the next. Nothing comes after the last.
//
// A reader that does not know a section skips it when kSectionIsOptional is set, after its place and hash were checked, and
// refuses the map when it is not. It is set on what makes poses better or a tool's work easier, and left out on
// what makes poses wrong where it is ignored. A published section is never changed: another one with another id takes its
// place. The version grows only when a reader would go wrong in the header or the table.
//
// Format 1 has the core sections alone and no flag; element_bytes had the 32 bits that flags share now, so its table reads
// as one of format 2. It is read and no longer written.
//
// Hashes are XXH3 64-bit with seed 0. header_hash covers the header before it; map_id covers the section table with its
// zeros; the hash of a section covers its elements and the zeros after them. So every byte of the file is covered.
//
// Sections (element, count)
//   meta                MetaRecord, 1
//   cubes               CubeRecord, num_cubes; each at least one landmark
//   landmarks           LandmarkRecord, num_landmarks; ordered by cube, within one along a Morton curve
//   descriptors         32 bytes, num_descriptors; those of landmark 0 first, at least one each; bit order of cv::ORB
//   keyframes           KeyframeRecord, num_keyframes <= 65535
//   keyframe_lists      bytes; per keyframe its landmark indices, ascending: the first index, then the steps to the next,
//                       each as base-128 digits, lowest first, high bit set on all but the last digit (LEB128)
//   words               32 bytes, num_words; the vocabulary
//   word_begin          u32, num_words + 1; entries of word w are word_begin[w] .. word_begin[w + 1]
//   inverted_keyframes  u16, num_entries; keyframes that contain the word, ascending within a word
//   inverted_weights    u8, num_entries; tf-idf of the word in that keyframe, 1..255 relative to the keyframe's norm
//   wcs                 WcsRecord, 0 or 1
//   RIVL (optional)     RivalRecord; by keyframe, of one keyframe the most alike first
//   TWIN (optional)     u8, num_landmarks: keyframes of other places that show something just like it, saturating. RIVL and
//                       TWIN come together or not at all; a map with neither was not asked whether places look alike
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace camloc::map_format {

inline constexpr std::uint32_t kVersion = 2;
inline constexpr std::uint32_t kOldestVersion = 1;  ///< that is still read
/// "CMAP", then bytes that a transfer in text mode would change, as in PNG.
inline constexpr std::array<char, 8> kMagic = {'C', 'M', 'A', 'P', '\r', '\n', '\x1a', '\n'};
inline constexpr std::uint32_t kByteOrder = 0x01020304;  ///< as a machine of the writer's byte order reads it
inline constexpr std::uint32_t kOtherByteOrder = 0x04030201;
inline constexpr std::uint64_t kAlignment = 64;
inline constexpr std::uint32_t kMaxKeyframes = 65535;  ///< the inverted file names them with 16 bits

struct FileHeader {
  std::array<char, 8> magic;
  std::uint32_t byte_order;
  std::uint32_t version;
  std::uint64_t file_bytes;
  std::uint64_t map_id;  ///< hash of the section table, which holds the hashes of all content
  std::uint32_t num_sections;
  std::array<std::uint32_t, 5> reserved;  ///< zero
  std::uint64_t header_hash;              ///< of the 56 bytes before
};
static_assert(sizeof(FileHeader) == 64);

/// The core sections have the numbers of their order, further ones four characters: see section_id().
enum class SectionId : std::uint32_t {
  kMeta,
  kCubes,
  kLandmarks,
  kDescriptors,
  kKeyframes,
  kKeyframeLists,
  kWords,
  kWordBegin,
  kInvertedKeyframes,
  kInvertedWeights,
  kWcs,
};
inline constexpr std::uint32_t kNumCoreSections = 11;
inline constexpr std::uint32_t kMaxSections = 64;

/// The id of a further section, of four printable characters, so that two branches that add one do not take the same.
[[nodiscard]] constexpr SectionId section_id(const char (&characters)[5]) {
  std::uint32_t id = 0;
  for (int i = 0; i < 4; ++i) id |= static_cast<std::uint32_t>(static_cast<unsigned char>(characters[i])) << (8 * i);
  return SectionId{id};
}

inline constexpr SectionId kRivals = section_id("RIVL"), kTwins = section_id("TWIN");

inline constexpr std::uint16_t kSectionIsOptional = 1;  ///< flag: a reader that does not know the section skips it

struct SectionRecord {
  SectionId id;
  std::uint16_t element_bytes;  ///< at least 1
  std::uint16_t flags;          ///< a reader refuses those that it does not know
  std::uint64_t offset;         ///< from the start of the file, multiple of 64
  std::uint64_t num_elements;
  std::uint64_t hash;
};
static_assert(sizeof(SectionRecord) == 32);

/// Where the first section begins.
[[nodiscard]] constexpr std::uint64_t first_section_offset(std::uint32_t num_sections) {
  return (sizeof(FileHeader) + num_sections * sizeof(SectionRecord) + kAlignment - 1) / kAlignment * kAlignment;
}

/// p_a = rotation * p_b + translation.
struct TransformRecord {
  std::array<double, 4> rotation_wxyz;  ///< unit quaternion
  std::array<double, 3> translation_m;
};
static_assert(sizeof(TransformRecord) == 56);

/// See Intrinsics.
struct IntrinsicsRecord {
  std::int32_t width, height;
  std::uint32_t lens;                ///< 0 pinhole, 1 Brown-Conrady, 2 equidistant, 3 rational
  std::uint32_t reserved;            ///< zero
  double fx, fy, cx, cy;             ///< pixels
  std::array<double, 5> distortion;  ///< of lens 3: eight 32-bit floats k1 k2 p1 p2 k3 k4 k5 k6, then zeros
};
static_assert(sizeof(IntrinsicsRecord) == 88);

/// Facts about the whole map. Texts are UTF-8, at most 63 bytes, filled up with zeros.
struct MetaRecord {
  std::array<char, 64> name;
  std::array<char, 64> camera_name;
  IntrinsicsRecord color;
  IntrinsicsRecord depth;
  TransformRecord T_color_depth;
  double depth_unit_m, min_depth_m, max_depth_m;
  double depth_noise_constant_m, depth_noise_quadratic_per_m;
  std::uint32_t is_depth_registered;        ///< 0 or 1
  std::uint32_t poses_are_of_depth_camera;  ///< 0 or 1
  double pose_sigma_m, pose_sigma_rad;      ///< see MapData
  float orb_scale_factor;
  std::uint32_t orb_num_levels;
};
static_assert(sizeof(MetaRecord) == 432);

/// A cube of the map with its own origin: landmark coordinates are 16-bit fractions of its side.
/// p_map = origin + extent * q / 65535. Its landmarks are contiguous.
struct CubeRecord {
  std::array<float, 3> origin_m;
  float extent_m;
  std::uint32_t first_landmark;
  std::uint32_t num_landmarks;
};
static_assert(sizeof(CubeRecord) == 24);

/// Everything about a landmark but its descriptors. The codes are defined in landmark_codes.h.
struct LandmarkRecord {
  std::array<std::uint16_t, 3> position;  ///< fraction of its cube's extent
  std::array<std::uint8_t, 2> direction;  ///< octahedral code of the mean direction landmark -> camera, axes of `map`
  std::uint8_t view_cosine;               ///< cosine of the widest angle between that direction and an observation, [-1, 1] -> 0..255
  std::uint8_t min_reference;             ///< smallest and largest reference distance over its observations; the reference
  std::uint8_t max_reference;             ///< distance d * scale_factor^level is where it would be seen on level 0; log code
  std::uint8_t angle;                     ///< keypoint orientation where the first descriptor was seen, 2 pi / 256
  std::uint8_t num_observations;          ///< frames that saw it, saturating
  std::uint8_t num_descriptors;           ///< at least 1
  std::uint16_t position_sigma_mm;        ///< scatter of its observations, saturating
};
static_assert(sizeof(LandmarkRecord) == 16);

/// One mapped view. Keyframes are the minimum set that covers all landmarks (greedy set cover).
struct KeyframeRecord {
  std::array<float, 4> rotation_wxyz;  ///< of T_map_camera, unit quaternion
  std::array<float, 3> position_m;
  std::uint32_t first_list_byte;  ///< into keyframe_lists; the list ends where the next one begins
  std::uint32_t num_landmark_entries;
};
static_assert(sizeof(KeyframeRecord) == 36);

/// What a keyframe shows is at another place of the map, too: a camera there, at this pose relative to the rival keyframe, would see
/// nearly the same.
struct RivalRecord {
  std::uint16_t keyframe, rival;         ///< indices of keyframes, not equal
  std::array<std::int16_t, 3> position;  ///< of the camera in the axes of the rival keyframe, 1/2048 m
  std::array<std::int16_t, 3> rotation;  ///< rotation vector from the rival keyframe's axes, pi / 32767
};
static_assert(sizeof(RivalRecord) == 16);

/// Where the map lies in the world.
struct WcsRecord {
  TransformRecord T_wcs_map;
  std::array<double, 36> covariance;  ///< of pose_error(), metres then radians, axes of `wcs`; symmetric, row by row
};
static_assert(sizeof(WcsRecord) == 344);

}  // namespace camloc::map_format
