# SPDX-License-Identifier: GPL-3.0-or-later
# Manual pages and completion of shells, made from the help of the programs (scripts/manual.py).
find_program(CALOT_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH REQUIRED)
file(STRINGS ${CMAKE_CURRENT_SOURCE_DIR}/debian/changelog calot_dates REGEX "^ -- .*  .*")
list(GET calot_dates 0 calot_date)
string(REGEX REPLACE "^ -- .*>  " "" calot_date "${calot_date}")

set(calot_commands ${calot_programs})
list(REMOVE_ITEM calot_commands calot-dashboard calot-trainer)
set(calot_windows ${calot_programs})
list(REMOVE_ITEM calot_windows ${calot_commands})
foreach(kind commands windows)
  if(NOT calot_${kind})
    continue()
  endif()
  set(files)
  foreach(program IN LISTS calot_${kind})
    list(APPEND files $<TARGET_FILE:${program}>)
  endforeach()
  add_custom_command(OUTPUT ${calot_made}/${kind}.stamp
    COMMAND ${CALOT_PYTHON} -B ${CMAKE_SOURCE_DIR}/scripts/manual.py ${files} --output ${calot_made}/${kind} --date "${calot_date}" --version ${PROJECT_VERSION}
    COMMAND ${CMAKE_COMMAND} -E touch ${calot_made}/${kind}.stamp
    DEPENDS ${calot_${kind}} ${CMAKE_SOURCE_DIR}/scripts/manual.py ${CMAKE_SOURCE_DIR}/scripts/completion.py ${CMAKE_CURRENT_SOURCE_DIR}/debian/changelog VERBATIM)
  add_custom_target(calot_manual_${kind} ALL DEPENDS ${calot_made}/${kind}.stamp)
  install(DIRECTORY ${calot_made}/${kind}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT ${kind})
  install(DIRECTORY ${calot_made}/${kind}/bash/ DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT ${kind})
  install(DIRECTORY ${calot_made}/${kind}/zsh/ DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT ${kind})
  install(DIRECTORY ${calot_made}/${kind}/fish/ DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT ${kind})
endforeach()
