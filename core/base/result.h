// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Errors that come from outside (a file, a device, a datagram) travel as values. Everything else is either our own bug
// (assert) or a normal outcome of a frame (an enum in the result).
#pragma once

#include <cassert>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace camloc {

enum class ErrorCode {
  kOk,
  kInvalid,      ///< malformed input: bad value, wrong type, wrong size
  kNotFound,     ///< the named thing does not exist
  kCorrupt,      ///< exists but its bytes contradict themselves
  kUnsupported,  ///< well formed but of a version or kind this build does not read
  kIo,           ///< the operating system refused: permission, disk full, read error
  kUnavailable,  ///< may work later: device unplugged, no route, no frame yet
  kTimeout,      ///< nothing arrived in time
  kEnd,          ///< a recorded source has no more frames
};

/// Outcome of an operation that returns nothing. The message is one line: what, which object, why, what to do about it.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(ErrorCode code, std::string message) : code_(code), message_(std::move(message)) {}

  static Status ok() { return {}; }
  [[nodiscard]] bool is_ok() const { return code_ == ErrorCode::kOk; }
  explicit operator bool() const { return is_ok(); }
  [[nodiscard]] ErrorCode code() const { return code_; }
  [[nodiscard]] const std::string& message() const { return message_; }

  /// The same error with "context: " in front of its message.
  [[nodiscard]] Status with_context(std::string_view context) const {
    return is_ok() ? *this : Status(code_, std::string(context) + ": " + message_);
  }

 private:
  ErrorCode code_ = ErrorCode::kOk;
  std::string message_;
};

/// A value or the reason why there is none. Reading the value of a failed result is our own bug.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}                                     // NOLINT(google-explicit-constructor)
  Result(Status status) : status_(std::move(status)) { assert(!status_.is_ok()); }  // NOLINT(google-explicit-constructor)
  Result(ErrorCode code, std::string message) : status_(code, std::move(message)) {}

  [[nodiscard]] bool is_ok() const { return value_.has_value(); }
  explicit operator bool() const { return is_ok(); }
  [[nodiscard]] const Status& status() const { return status_; }

  T& value() & {
    assert(value_);
    return *value_;
  }
  const T& value() const& {
    assert(value_);
    return *value_;
  }
  T&& value() && {
    assert(value_);
    return std::move(*value_);
  }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

 private:
  std::optional<T> value_;
  Status status_;
};

}  // namespace camloc
