# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# OpenCV's modules one by one, as Debian splits them into packages (libopencv-calib3d-dev, ...). OpenCV's own OpenCVConfig.cmake is
# in libopencv-dev alone, which comes with every module and with GDAL, VTK, Qt, MPI and MariaDB.
#   find_package(OpenCVModules COMPONENTS core calib3d)    targets opencv_core and opencv_calib3d, those of them that are there
find_path(OpenCVModules_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
mark_as_advanced(OpenCVModules_INCLUDE_DIR)
foreach(module IN LISTS OpenCVModules_FIND_COMPONENTS)
  find_library(OpenCVModules_${module}_LIBRARY opencv_${module})
  mark_as_advanced(OpenCVModules_${module}_LIBRARY)
  if(OpenCVModules_${module}_LIBRARY AND EXISTS ${OpenCVModules_INCLUDE_DIR}/opencv2/${module}.hpp)
    set(OpenCVModules_${module}_FOUND TRUE)
    if(NOT TARGET opencv_${module})
      add_library(opencv_${module} UNKNOWN IMPORTED)
      set_target_properties(opencv_${module} PROPERTIES IMPORTED_LOCATION ${OpenCVModules_${module}_LIBRARY}
        INTERFACE_INCLUDE_DIRECTORIES ${OpenCVModules_INCLUDE_DIR})
    endif()
  endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVModules REQUIRED_VARS OpenCVModules_INCLUDE_DIR HANDLE_COMPONENTS)
