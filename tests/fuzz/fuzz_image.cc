// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Arbitrary bytes as a colour and as a depth image: an image of the announced size, or an error in one line.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "core/io/image_file.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

template <typename T>
void check(const camloc::Status& status, const camloc::Image<T>& image) {
  if (!status) return require(status.message().find('\n') == std::string::npos);
  require(image.width > 0 && image.height > 0);
  require(image.pixels.size() == static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> bytes(data, size);
  // Damage may announce a huge image; larger ones take memory and time, and show nothing new.
  const camloc::Result<camloc::ImageSize> announced = camloc::decode_image_size(bytes, "fuzz");
  if (announced && announced->width * announced->height > 1 << 20) return 0;
  camloc::Image<std::uint8_t> gray;
  check(camloc::decode_gray(bytes, "fuzz", &gray), gray);
  camloc::Image<std::uint16_t> depth;
  check(camloc::decode_depth(bytes, "fuzz", &depth), depth);
  const camloc::Result<camloc::ColorImage> color = camloc::decode_color(bytes, "fuzz");
  require(color.is_ok() == camloc::decode_gray(bytes, "fuzz", &gray).is_ok());
  return 0;
}
