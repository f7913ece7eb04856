# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# Read by ctest after the lists of tests that gtest_discover_tests() wrote, each in a variable PROGRAM_TESTS. Only with a call of its own
# could it give single tests a label, and each call runs the program once more.
get_cmake_property(variables VARIABLES)
list(FILTER variables INCLUDE REGEX "^test_([a-z0-9_]+)_TESTS$")
foreach(tests IN LISTS variables)
  string(REGEX REPLACE "^test_(.*)_TESTS$" "\\1" layer ${tests})
  foreach(test IN LISTS ${tests})
    if(test MATCHES "(^|[./])Recorded")
      set_tests_properties(${test} PROPERTIES LABELS "${layer};recordings")
    endif()
  endforeach()
endforeach()
