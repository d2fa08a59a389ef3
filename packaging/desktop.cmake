# SPDX-License-Identifier: GPL-3.0-or-later
# What a desktop knows of the windows: entries, icons, types of files, AppStream data.
foreach(program dashboard trainer)
  install(FILES desktop/calot-${program}.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT windows)
  install(FILES metainfo/calot-${program}.metainfo.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/metainfo COMPONENT windows)
  install(FILES icons/calot-${program}.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT windows)
endforeach()
install(FILES mime/calot.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages COMPONENT windows)
install(FILES icons/application-x-calot-recording.svg icons/application-x-calot-cohort.svg
  DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/mimetypes COMPONENT windows)
