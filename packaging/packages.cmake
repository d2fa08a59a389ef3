# SPDX-License-Identifier: GPL-3.0-or-later
# Debian packages, one a component. scripts/package.sh makes and checks them.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME calot)
set(CPACK_PACKAGE_VENDOR Calot)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_OUTPUT_FILE_PREFIX ${CMAKE_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_THREADS 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(calot_version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})
# Whoever hands packages out names an address of theirs.
set(CALOT_MAINTAINER "The Calot authors <calot@example.org>" CACHE STRING "Maintainer of the Debian packages")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${CALOT_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

# calot_package(component NAME name SUMMARY text TEXT text ...): one package; further words are those of its control file.
set(CPACK_COMPONENTS_ALL)
macro(calot_package component)
  cmake_parse_arguments(ARG "" "NAME;SUMMARY;TEXT;SECTION;ARCHITECTURE;DEPENDS;RECOMMENDS;SUGGESTS" "" ${ARGN})
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${ARG_NAME})
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${ARG_SUMMARY}\n${ARG_TEXT}")
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${ARG_SUMMARY}\n${ARG_TEXT}")
  foreach(field SECTION ARCHITECTURE DEPENDS RECOMMENDS SUGGESTS)
    if(ARG_${field})
      set(CPACK_DEBIAN_${upper}_PACKAGE_${field} "${ARG_${field}}")
    endif()
  endforeach()
  # Packages of programs and libraries need the libraries that these are linked with.
  if(NOT ARG_ARCHITECTURE AND NOT ${component} STREQUAL development)
    set(CPACK_DEBIAN_${upper}_PACKAGE_SHLIBDEPS ON)
  endif()
  install(FILES ${CMAKE_CURRENT_SOURCE_DIR}/debian/copyright ${calot_made}/changelog.Debian.gz ${calot_made}/changelog.gz
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${ARG_NAME} COMPONENT ${component})
endmacro()

foreach(log debian/changelog:changelog.Debian.gz ../CHANGELOG.md:changelog.gz)
  string(REPLACE ":" ";" log ${log})
  list(GET log 0 text)
  list(GET log 1 packed)
  add_custom_command(OUTPUT ${calot_made}/${packed} COMMAND gzip -9nc ${CMAKE_CURRENT_SOURCE_DIR}/${text} > ${calot_made}/${packed}
    DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${text})
endforeach()
add_custom_target(calot_changelogs ALL DEPENDS ${calot_made}/changelog.Debian.gz ${calot_made}/changelog.gz)

set(calot_about "Calot records virtual laparoscopic cholecystectomy training at 1 kHz,
replays every attempt bit for bit, and assesses it: figures of motion and
force, errors, norms, studies of groups. It is research software, not a
medical device.\n.\n")
calot_package(commands NAME calot SUMMARY "record, replay and assess training of laparoscopic surgery"
  TEXT "${calot_about}This package has the command line, the scenes and the simulation."
  DEPENDS "fonts-dejavu-core, libosmesa6" RECOMMENDS "calot-engines (= ${calot_version}), calot-modules (= ${calot_version})" SUGGESTS "calot-gui, calot-doc, python3-numpy")
calot_package(engines NAME calot-engines ARCHITECTURE all SUMMARY "kept engines and golden recordings of Calot"
  TEXT "${calot_about}This package has engines that decide recordings of earlier simulation
versions, as WebAssembly modules, and golden recordings that prove what an
engine computes."
  DEPENDS nodejs)
if(calot_modules)
  calot_package(modules NAME calot-modules SUMMARY "films, PDF, devices and surfaces of Calot"
    TEXT "${calot_about}This package has what the command line loads for films, for reports as PDF and
for input devices: gamepads, cameras, trackers, SpaceMice, Inverse3, and for surfaces
whose parts overlap."
    DEPENDS "calot (= ${calot_version}), fonts-dejavu-core, qt6-qpa-plugins")
endif()
if(CALOT_WINDOWS)
  calot_package(windows NAME calot-gui SUMMARY "dashboard and trainer of Calot"
    TEXT "${calot_about}This package has the dashboard, which shows cohorts and recordings, and the
trainer, which runs an operation live in a window."
    DEPENDS "calot (= ${calot_version}), fonts-dejavu-core, libosmesa6, qt6-qpa-plugins, shared-mime-info" RECOMMENDS qt6-wayland
    SUGGESTS "qt6-speech-speechd-plugin, speech-dispatcher")
endif()
calot_package(documents NAME calot-doc ARCHITECTURE all SECTION doc SUMMARY "documentation of Calot"
  TEXT "${calot_about}This package has the documentation, the formats of files, examples for clusters
and stations, and the bill of materials.")
calot_package(development NAME libcalot-dev SECTION libdevel SUMMARY "headers and static libraries of Calot"
  TEXT "${calot_about}This package has headers, static libraries and a CMake package: simulation,
recorder and analytics for programs of one's own."
  DEPENDS "libboost-dev, libeigen3-dev (>= 3.4), libfmt-dev, libhdf5-dev, libsodium-dev, libspdlog-dev, libsqlite3-dev, libsqlitecpp-dev, libssl-dev, libutf8proc-dev, libxxhash-dev, nlohmann-json3-dev, pkg-config")
if(TARGET calot_python)
  calot_package(python NAME python3-calot SECTION python SUMMARY "Python module of Calot"
    TEXT "${calot_about}This package has the module for Python 3."
    DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy, libosmesa6, calot (= ${calot_version})")
endif()
# Everything that the packages hold.
add_custom_target(calot_packaged)
add_dependencies(calot_packaged ${calot_programs} ${calot_modules} ${calot_packaged_libraries} calot_manual_commands calot_changelogs)
if(CALOT_WINDOWS)
  add_dependencies(calot_packaged calot_manual_windows)
endif()
if(TARGET calot_python)
  add_dependencies(calot_packaged calot_python)
endif()
include(CPack)
