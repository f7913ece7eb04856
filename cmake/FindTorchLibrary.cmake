# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# libtorch as the target camloc_torch, where libtorch-dev is installed. Its own package file also asks for what it was built with.
find_path(TorchLibrary_INCLUDE_DIR torch/nn/module.h PATH_SUFFIXES torch/csrc/api/include)
find_library(TorchLibrary_TORCH torch)
find_library(TorchLibrary_CPU torch_cpu)
find_library(TorchLibrary_C10 c10)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(TorchLibrary REQUIRED_VARS TorchLibrary_TORCH TorchLibrary_CPU TorchLibrary_C10 TorchLibrary_INCLUDE_DIR)
if(TorchLibrary_FOUND AND NOT TARGET camloc_torch)
  add_library(camloc_torch INTERFACE)
  target_include_directories(camloc_torch SYSTEM INTERFACE ${TorchLibrary_INCLUDE_DIR})
  # libtorch registers its kernels when it is loaded, so it is linked though few of its symbols are named.
  target_link_libraries(camloc_torch INTERFACE -Wl,--no-as-needed ${TorchLibrary_TORCH} -Wl,--as-needed ${TorchLibrary_CPU} ${TorchLibrary_C10})
endif()
