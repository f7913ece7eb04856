# SPDX-FileCopyrightText: 2026 The camloc authors
# SPDX-License-Identifier: Apache-2.0
#
# The Debian packages, written by cpack: camloc for the device, camloc-tools for the workstation, and one each for what brings a large
# library with it, where that is built: camloc-calibration, camloc-bench, the plug-in camloc-coarse (OpenCV) and camloc-training
# (libtorch). Included last by the main CMakeLists.txt;
# what goes into them is said by install() beside each program, what they weigh is in tests/packaging/weight.sh.
set(packages camloc camloc-tools)
if(TARGET camloc-camera)
  list(APPEND packages camloc-calibration)
endif()
if(TARGET camloc-bench)
  list(APPEND packages camloc-bench)
endif()
if(TARGET camloc-train)
  list(APPEND packages camloc-training)
endif()
if(TARGET camloc-opencv-dnn)
  list(APPEND packages camloc-coarse)
endif()

# Message types, for subscribers: the .lcm files, and a pkg-config file that says where they are.
configure_file(${CMAKE_CURRENT_LIST_DIR}/camloc-lcmtypes.pc.in ${CMAKE_BINARY_DIR}/packaging/camloc-lcmtypes.pc @ONLY)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/daemon/lcmtypes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/camloc/lcmtypes FILES_MATCHING PATTERN "*.lcm")
install(FILES ${CMAKE_BINARY_DIR}/packaging/camloc-lcmtypes.pc DESTINATION ${CMAKE_INSTALL_DATADIR}/pkgconfig)

# What Debian policy asks of every package.
configure_file(${CMAKE_CURRENT_LIST_DIR}/changelog.in ${CMAKE_BINARY_DIR}/packaging/changelog @ONLY)
execute_process(COMMAND gzip -9nkf ${CMAKE_BINARY_DIR}/packaging/changelog COMMAND_ERROR_IS_FATAL ANY)
foreach(package IN LISTS packages)
  install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright ${CMAKE_BINARY_DIR}/packaging/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${package})
endforeach()

# Settings in pieces: files here come on top of camlocd.toml.
install(DIRECTORY DESTINATION ${CMAKE_INSTALL_FULL_SYSCONFDIR}/camloc/camlocd.toml.d)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The camloc authors <camloc@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
# Folders and files as root's, whatever the umask of whoever builds.
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_CAMLOC_PACKAGE_NAME camloc)
set(CPACK_DEBIAN_CAMLOC_DESCRIPTION "The daemon camlocd reads a depth camera, finds its place in a map of the
building and publishes a pose with its covariance for every frame over LCM.
.
This package is for the device: the daemon with its systemd unit and udev
rules, the program camloc that looks at cameras, maps and the daemon, and the
LCM types of the messages.")
# The two programs that the maintainer script calls come with systemd, or alone where another init runs or none yet. OpenNI2 is opened with
# dlopen by cameras that want it; ip sets the route of camloc-multicast.service.
set(CPACK_DEBIAN_CAMLOC_PACKAGE_DEPENDS "systemd-standalone-sysusers | systemd, systemd-standalone-tmpfiles | systemd")
set(CPACK_DEBIAN_CAMLOC_PACKAGE_RECOMMENDS "libopenni2-0, iproute2")
set(CPACK_DEBIAN_CAMLOC_PACKAGE_SUGGESTS "camloc-tools, camloc-calibration, camloc-coarse")

set(CPACK_DEBIAN_CAMLOC-TOOLS_PACKAGE_NAME camloc-tools)
set(CPACK_DEBIAN_CAMLOC-TOOLS_DESCRIPTION "Programs for the workstation: build, merge, evaluate and look at the maps that
camlocd localizes in, place them in site coordinates, and write synthetic
buildings to try things on.")
set(CPACK_DEBIAN_CAMLOC-CALIBRATION_PACKAGE_NAME camloc-calibration)
set(CPACK_DEBIAN_CAMLOC-CALIBRATION_DESCRIPTION "Finds the calibration of a camera for camlocd from pictures of a flat
board: lens, depth scale and how the two sensors are placed.")
set(CPACK_DEBIAN_CAMLOC-BENCH_PACKAGE_NAME camloc-bench)
set(CPACK_DEBIAN_CAMLOC-BENCH_DESCRIPTION "Measures where the time of localization goes on this machine and how accurate
it is, beside a plain chain of OpenCV calls.")
set(CPACK_DEBIAN_CAMLOC-TRAINING_PACKAGE_NAME camloc-training)
set(CPACK_DEBIAN_CAMLOC-TRAINING_DESCRIPTION "Trains a network on the recordings that a map was made of: it says roughly
where a camera is when camlocd has lost its place.")
set(CPACK_DEBIAN_CAMLOC-COARSE_PACKAGE_NAME camloc-coarse)
set(CPACK_DEBIAN_CAMLOC-COARSE_DESCRIPTION "Runs the neural networks that tell camlocd roughly where it is after it lost
its place: a library that it loads when it needs it, with OpenCV behind it.")
foreach(package TOOLS CALIBRATION BENCH TRAINING COARSE)
  set(CPACK_DEBIAN_CAMLOC-${package}_PACKAGE_RECOMMENDS camloc)
endforeach()

# conffiles names its files one a line; cpack wants the control files under their own names.
set(control ${CMAKE_BINARY_DIR}/packaging/debian)
file(WRITE ${control}/conffiles "${CMAKE_INSTALL_FULL_SYSCONFDIR}/camloc/camlocd.toml\n")
foreach(script postinst prerm postrm)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/camloc.${script} ${control}/${script} COPYONLY)
endforeach()
set(CPACK_DEBIAN_CAMLOC_PACKAGE_CONTROL_EXTRA ${control}/conffiles ${control}/postinst ${control}/prerm ${control}/postrm)

include(CPack)
foreach(package IN LISTS packages)
  cpack_add_component(${package})
endforeach()
