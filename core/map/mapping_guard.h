// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// Survives a file that is truncated, or whose disk fails, while it is mapped. Reading such a page raises SIGBUS, which
// ends the process. With the guard installed, a fault inside a registered mapping puts an anonymous page of zeros where
// the page was and marks the mapping as damaged; the interrupted read then goes on and sees zeros. A fault anywhere else
// goes to the handler that was there before.
//
// Rejected: reading the file into memory (twice the memory while the new map of a hot swap is loaded, no sharing between
// processes), and testing the file size before each frame (a race, and blind to read errors).
#pragma once

#include <cstddef>

namespace camloc {

/// Mappings that can be registered at a time; further ones work but are not guarded.
inline constexpr int kMaxGuardedMappings = 64;

/// Installs the handler for SIGBUS in this process. Programs that map files call it once at start; further calls do
/// nothing. Thread-safe. Returns false when the operating system refuses.
bool install_mapping_guard();

/// Registers pages for as long as it lives; destroy it before they are unmapped. Movable. The table behind it has a fixed
/// size and no lock, because the signal handler reads it.
class MappingGuard {
 public:
  MappingGuard() = default;
  /// `begin` is the start of a page.
  MappingGuard(const void* begin, std::size_t bytes);
  ~MappingGuard();
  MappingGuard(MappingGuard&& other) noexcept;
  MappingGuard& operator=(MappingGuard&& other) noexcept;
  MappingGuard(const MappingGuard&) = delete;
  MappingGuard& operator=(const MappingGuard&) = delete;

  /// False when the table was full.
  [[nodiscard]] bool is_registered() const { return slot_ >= 0; }
  /// True once a page could not be read and was replaced by zeros.
  [[nodiscard]] bool is_damaged() const;

 private:
  void release();
  int slot_ = -1;
};

}  // namespace camloc
