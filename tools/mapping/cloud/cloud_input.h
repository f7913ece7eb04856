// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Bytes of a cloud file one after the other through a buffer: a scan may be larger than the memory.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <istream>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/base/work_observer.h"

namespace camloc::mapping {

class CloudInput {
 public:
  /// `stream` stands at its first byte; it and `observer`, who is told of every megabyte, outlive this. `name` is for messages.
  CloudInput(std::istream& stream, std::string name, WorkObserver& observer = WorkObserver::nobody());

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t total() const { return total_; }
  [[nodiscard]] std::uint64_t position() const { return consumed_ + next_; }
  [[nodiscard]] std::uint64_t remaining() const { return total_ - std::min(total_, position()); }
  /// Up to `size` bytes at the front without taking them; fewer at the end.
  [[nodiscard]] std::span<const std::byte> peek(std::size_t size);
  /// The next `size` bytes, at most kMaxRead, valid until the next call; empty where the file ends before.
  [[nodiscard]] std::span<const std::byte> read(std::size_t size);
  /// False where the file ends before.
  [[nodiscard]] bool skip(std::uint64_t size);
  /// The next line without its end ("\n", "\r\n" or "\r" alone), valid until the next call; nothing at the end of the file. A
  /// line longer than kMaxLine is cut there, its rest is the next line.
  [[nodiscard]] std::optional<std::string_view> read_line();
  /// True when the observer said stop.
  [[nodiscard]] bool is_stopped() const { return is_stopped_; }
  /// kCorrupt "name: is truncated: what", or kIo when reading was stopped.
  [[nodiscard]] Status truncated(const std::string& what) const;
  /// `code` "name: what".
  [[nodiscard]] Status error(ErrorCode code, const std::string& what) const { return {code, name_ + ": " + what}; }

  static constexpr std::size_t kMaxRead = std::size_t{1} << 16;
  static constexpr std::size_t kMaxLine = std::size_t{1} << 12;

 private:
  /// At least `size` bytes in the buffer, if the file has them.
  void fill(std::size_t size);

  std::istream& stream_;
  std::string name_;
  WorkObserver& observer_;
  std::uint64_t total_ = 0, consumed_ = 0;  ///< consumed_: bytes of the file before the buffer
  std::vector<std::byte> buffer_;
  std::size_t next_ = 0, end_ = 0;
  bool is_stopped_ = false;
};

}  // namespace camloc::mapping
