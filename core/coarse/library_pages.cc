// SPDX-FileCopyrightText: 2026 The camloc authors
// SPDX-License-Identifier: Apache-2.0
#include "core/coarse/library_pages.h"

#include <dlfcn.h>
#include <link.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

namespace camloc {
namespace {

bool has_text_relocations(const link_map& library) {
  for (const ElfW(Dyn)* entry = library.l_ld; entry != nullptr && entry->d_tag != DT_NULL; ++entry) {
    if (entry->d_tag == DT_TEXTREL || (entry->d_tag == DT_FLAGS && (entry->d_un.d_val & DF_TEXTREL) != 0)) return true;
  }
  return false;
}

/// Whole pages of the segments that nobody may write to.
int give_back(dl_phdr_info* info, std::size_t, void* data) {
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  for (const auto* library = static_cast<const link_map*>(data); library != nullptr; library = library->l_next) {
    if (library->l_addr != info->dlpi_addr || library->l_addr == 0 || has_text_relocations(*library)) continue;
    for (int i = 0; i < info->dlpi_phnum; ++i) {
      const ElfW(Phdr)& segment = info->dlpi_phdr[i];
      if (segment.p_type != PT_LOAD || (segment.p_flags & PF_W) != 0) continue;
      const std::uintptr_t begin = (info->dlpi_addr + segment.p_vaddr + page - 1) / page * page;
      const std::uintptr_t end = (info->dlpi_addr + segment.p_vaddr + segment.p_filesz) / page * page;
      if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
    }
  }
  return 0;
}

}  // namespace

void give_back_library_pages(void* handle) {
  link_map* first = nullptr;
  if (::dlinfo(handle, RTLD_DI_LINKMAP, &first) == 0 && first != nullptr) ::dl_iterate_phdr(give_back, first);
}

}  // namespace camloc
