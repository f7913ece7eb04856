// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
//
// The one place with process-wide state: a signal handler has no other way to learn what it may touch. The handler uses
// lock-free atomics and the system calls mmap and sigaction only.
#include "core/map/mapping_guard.h"

#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <utility>

namespace camloc {
namespace {

enum SlotState : int { kFree, kClaimed, kActive };

struct Slot {
  std::atomic<int> state = kFree;
  std::atomic<std::uintptr_t> begin = 0;
  std::atomic<std::uintptr_t> end = 0;
  std::atomic<bool> is_damaged = false;
};
static_assert(std::atomic<std::uintptr_t>::is_always_lock_free && std::atomic<bool>::is_always_lock_free &&
              std::atomic<int>::is_always_lock_free);

// Initialized before any code runs, so that the handler may use it at any time.
constinit std::array<Slot, kMaxGuardedMappings> g_slots;
constinit struct sigaction g_previous {};
constinit std::uintptr_t g_page_bytes = 4096;

/// The registered mapping that holds the address, or null.
Slot* find_slot(std::uintptr_t address) {
  for (Slot& slot : g_slots) {
    if (slot.state.load(std::memory_order_acquire) != kActive) continue;
    if (address >= slot.begin.load(std::memory_order_relaxed) && address < slot.end.load(std::memory_order_relaxed)) return &slot;
  }
  return nullptr;
}

bool replace_page(std::uintptr_t address) {
  void* const page = reinterpret_cast<void*>(address & ~(g_page_bytes - 1));
  return ::mmap(page, g_page_bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) != MAP_FAILED;
}

/// A fault that is not ours: what would have happened without us.
void chain(int signal_number, siginfo_t* info, void* context) {
  if ((g_previous.sa_flags & SA_SIGINFO) != 0 && g_previous.sa_sigaction != nullptr) {
    g_previous.sa_sigaction(signal_number, info, context);
  } else if (g_previous.sa_handler != SIG_DFL && g_previous.sa_handler != SIG_IGN) {
    g_previous.sa_handler(signal_number);
  } else {
    // Back to the default; a fault repeats as soon as we return, a signal sent by kill() has to be sent again.
    struct sigaction default_action {};
    default_action.sa_handler = SIG_DFL;
    ::sigaction(SIGBUS, &default_action, nullptr);
    if (info->si_code <= 0) ::raise(SIGBUS);
  }
}

void handle_sigbus(int signal_number, siginfo_t* info, void* context) {
  const int saved_errno = errno;
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  Slot* const slot = info->si_code == BUS_ADRERR ? find_slot(address) : nullptr;
  if (slot != nullptr && replace_page(address)) {
    slot->is_damaged.store(true, std::memory_order_release);
  } else {
    chain(signal_number, info, context);
  }
  errno = saved_errno;
}

bool install_once() {
  g_page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  if (::sigaction(SIGBUS, nullptr, &g_previous) != 0) return false;
  struct sigaction action {};
  action.sa_sigaction = handle_sigbus;
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  ::sigemptyset(&action.sa_mask);
  return ::sigaction(SIGBUS, &action, nullptr) == 0;
}

}  // namespace

bool install_mapping_guard() {
  static const bool is_installed = install_once();
  return is_installed;
}

MappingGuard::MappingGuard(const void* begin, std::size_t bytes) {
  for (int i = 0; i < kMaxGuardedMappings; ++i) {
    Slot& slot = g_slots[i];
    int expected = kFree;
    if (!slot.state.compare_exchange_strong(expected, kClaimed, std::memory_order_acq_rel)) continue;
    slot.begin.store(reinterpret_cast<std::uintptr_t>(begin), std::memory_order_relaxed);
    slot.end.store(reinterpret_cast<std::uintptr_t>(begin) + bytes, std::memory_order_relaxed);
    slot.is_damaged.store(false, std::memory_order_relaxed);
    slot.state.store(kActive, std::memory_order_release);
    slot_ = i;
    return;
  }
}

MappingGuard::~MappingGuard() { release(); }
MappingGuard::MappingGuard(MappingGuard&& other) noexcept : slot_(std::exchange(other.slot_, -1)) {}

MappingGuard& MappingGuard::operator=(MappingGuard&& other) noexcept {
  if (this != &other) {
    release();
    slot_ = std::exchange(other.slot_, -1);
  }
  return *this;
}

bool MappingGuard::is_damaged() const { return slot_ >= 0 && g_slots[slot_].is_damaged.load(std::memory_order_acquire); }

void MappingGuard::release() {
  if (slot_ >= 0) g_slots[slot_].state.store(kFree, std::memory_order_release);
  slot_ = -1;
}

}  // namespace camloc
