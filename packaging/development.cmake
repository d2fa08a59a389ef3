# SPDX-License-Identifier: GPL-3.0-or-later
# Headers, static libraries and `find_package(Calot)`: simulation, recorder and analytics, without devices and windows.
set(calot_libraries calot_flags calot_sim_math calot_sim_geometry calot_sim_solid calot_sim_vessel calot_sim_carving calot_sim_contact
  calot_sim_connective calot_sim_fat calot_sim calot_base calot_formats calot_engine calot_recording calot_recorder calot_statistics calot_checkpoints
  calot_external calot_analytics)
foreach(library IN LISTS calot_libraries)
  string(REPLACE "calot_" "" name ${library})
  set_target_properties(${library} PROPERTIES EXPORT_NAME ${name})
endforeach()
set(calot_packaged_libraries ${calot_libraries})
list(REMOVE_ITEM calot_packaged_libraries calot_flags)
install(TARGETS ${calot_libraries} EXPORT Calot ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
foreach(room sim recorder analytics)
  file(GLOB_RECURSE headers RELATIVE ${CMAKE_SOURCE_DIR} CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${room}/*.h)
  list(FILTER headers EXCLUDE REGEX "^sim/bullet/|^recorder/sources/devices/")
  foreach(header IN LISTS headers)
    get_filename_component(folder ${header} DIRECTORY)
    install(FILES ${CMAKE_SOURCE_DIR}/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/calot/${folder} COMPONENT development)
  endforeach()
endforeach()

include(CMakePackageConfigHelpers)
set(calot_package ${CMAKE_INSTALL_LIBDIR}/cmake/Calot)
configure_package_config_file(CalotConfig.cmake.in ${calot_made}/CalotConfig.cmake INSTALL_DESTINATION ${calot_package})
write_basic_package_version_file(${calot_made}/CalotConfigVersion.cmake COMPATIBILITY ExactVersion)
install(FILES ${calot_made}/CalotConfig.cmake ${calot_made}/CalotConfigVersion.cmake DESTINATION ${calot_package} COMPONENT development)
install(DIRECTORY example/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libcalot-dev/examples COMPONENT development)
install(EXPORT Calot NAMESPACE Calot:: FILE CalotTargets.cmake DESTINATION ${calot_package} COMPONENT development)
