// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mapping/cloud/cloud_input.h"

#include <cassert>
#include <cstring>

namespace camloc::mapping {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

}  // namespace

CloudInput::CloudInput(std::istream& stream, std::string name, WorkObserver& observer)
    : stream_(stream), name_(std::move(name)), observer_(observer), buffer_(kBufferBytes) {
  stream_.seekg(0, std::ios::end);
  const auto end = stream_.tellg();
  total_ = end < 0 ? 0 : static_cast<std::uint64_t>(end);
  stream_.clear();
  stream_.seekg(0);
}

void CloudInput::fill(std::size_t size) {
  assert(size <= kBufferBytes);
  if (end_ - next_ >= size || is_stopped_) return;
  std::memmove(buffer_.data(), buffer_.data() + next_, end_ - next_);
  consumed_ += next_;
  end_ -= next_;
  next_ = 0;
  stream_.read(reinterpret_cast<char*>(buffer_.data() + end_), static_cast<std::streamsize>(kBufferBytes - end_));
  end_ += static_cast<std::size_t>(std::max<std::streamsize>(0, stream_.gcount()));
  const auto megabytes = [](std::uint64_t bytes) { return std::to_string((bytes + 500'000) / 1'000'000); };
  if (!observer_.on_progress("reading the cloud: " + megabytes(position()) + " of " + megabytes(total_) + " MB")) {
    is_stopped_ = true;
    next_ = end_ = 0;
  }
}

std::span<const std::byte> CloudInput::peek(std::size_t size) {
  fill(size);
  return {buffer_.data() + next_, std::min(size, end_ - next_)};
}

std::span<const std::byte> CloudInput::read(std::size_t size) {
  assert(size <= kMaxRead);
  fill(size);
  if (end_ - next_ < size) return {};
  const std::span<const std::byte> bytes(buffer_.data() + next_, size);
  next_ += size;
  return bytes;
}

bool CloudInput::skip(std::uint64_t size) {
  if (size > remaining()) return false;
  while (size > 0) {
    fill(1);
    if (end_ == next_) return false;
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(size, end_ - next_));
    next_ += step;
    size -= step;
  }
  return true;
}

std::optional<std::string_view> CloudInput::read_line() {
  fill(kMaxLine + 2);
  if (end_ == next_) return std::nullopt;
  const char* begin = reinterpret_cast<const char*>(buffer_.data() + next_);
  const std::string_view available(begin, std::min(end_ - next_, kMaxLine));
  const std::size_t length = std::min(available.find_first_of("\r\n"), available.size());
  next_ += length;
  if (next_ < end_ && buffer_[next_] == std::byte{'\r'}) ++next_;
  if (next_ < end_ && buffer_[next_] == std::byte{'\n'}) ++next_;
  return std::string_view(begin, length);
}

Status CloudInput::truncated(const std::string& what) const {
  if (is_stopped_) return {ErrorCode::kIo, "interrupted while reading " + name_};
  return {ErrorCode::kCorrupt, name_ + ": is truncated: " + what};
}

}  // namespace camloc::mapping
