# Packages of the targets. A component of cmake --install is a Debian package of CPack:
#
#   daemon  palpate         palpated, its libraries, palpate-command, examples, systemd, limits
#   sim     palpate-sim     the simulator and its scenes
#   tools   palpate-tools   everything else that has a command line
#   dev     palpate-dev     headers and static libraries of core and rt, message types, the driver
#   python  python3-palpate the Python package (tools/python)
#
# Data keeps its place in the source tree below share/palpate, since scenes and configurations name
# each other by relative paths. Nothing that is installed knows where it was built or installed.

set(PALPATE_CONTROL_PROGRAMS palpated palpate-command)

# Programs with a command line are listed in packaging/CMakeLists.txt, which describes them.
function(palpate_install_program name)
  if(name STREQUAL "palpate-probe")
    install(TARGETS ${name} RUNTIME DESTINATION lib/palpate COMPONENT daemon)
    return()
  endif()
  if(name IN_LIST PALPATE_CONTROL_PROGRAMS)
    set(component daemon)
  elseif(name STREQUAL "palpate-sim")
    set(component sim)
  elseif(name MATCHES "^palpate-")
    set(component tools)
  else()
    return()
  endif()
  install(TARGETS ${name} RUNTIME COMPONENT ${component})
  set_property(GLOBAL APPEND PROPERTY PALPATE_PROGRAMS_${component} ${name})
endfunction()

# Libraries for drivers and for components loaded by name: every library of core and of rt, except
# the daemon itself. palpate::NAME has the same name inside and outside.
function(palpate_export_library name)
  file(RELATIVE_PATH folder ${CMAKE_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  if(folder MATCHES "^(core|rt)/" AND NOT name STREQUAL "daemon")
    set_target_properties(palpate_${name} PROPERTIES EXPORT_NAME ${name})
    install(TARGETS palpate_${name} EXPORT palpate ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}/palpate COMPONENT dev)
    set_property(GLOBAL APPEND PROPERTY PALPATE_EXPORTED ${name})
  endif()
endfunction()
