# Runs within cmake --install, after the programs: writes their manual pages and completion.
string(RANDOM LENGTH 8 palpate_run)  # separates concurrent installations
set(palpate_here "${palpate_made}/${palpate_run}")
execute_process(
  COMMAND "${palpate_python}" "${palpate_describe}" --programs "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/bin"
          --output "${palpate_here}" ${palpate_programs}
  COMMAND_ERROR_IS_FATAL ANY)
set(palpate_zsh site-functions)
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(palpate_zsh vendor-completions)
  file(GLOB palpate_pages "${palpate_here}/man/*.1")
  execute_process(COMMAND gzip -9n ${palpate_pages} COMMAND_ERROR_IS_FATAL ANY)
endif()
file(INSTALL "${palpate_here}/man/" DESTINATION "${CMAKE_INSTALL_PREFIX}/share/man/man1")
file(INSTALL "${palpate_here}/bash/" DESTINATION "${CMAKE_INSTALL_PREFIX}/share/bash-completion/completions")
file(INSTALL "${palpate_here}/zsh/" DESTINATION "${CMAKE_INSTALL_PREFIX}/share/zsh/${palpate_zsh}")
file(REMOVE_RECURSE "${palpate_here}")
