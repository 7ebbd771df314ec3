# Runs within cmake --install; palpate_system holds the files, palpate_made is a folder to write to.
string(RANDOM LENGTH 8 run)  # separates concurrent installations
set(palpate_made "${palpate_made}/${run}")
set(settings "${CMAKE_INSTALL_PREFIX}/etc")
set(library "${CMAKE_INSTALL_PREFIX}/lib")
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
  set(settings "/etc")
  set(library "/lib")  # where Debian 12 expects the units of packages
endif()

file(READ "${palpate_system}/palpated.service" text)
string(REPLACE "/usr/bin/" "${CMAKE_INSTALL_PREFIX}/bin/" text "${text}")
string(REPLACE "/etc/palpate/" "${settings}/palpate/" text "${text}")
string(REPLACE "man:palpated(1)" "man:palpated(1) file:${CMAKE_INSTALL_PREFIX}/share/doc/palpate/own_robot.md" text
  "${text}")
file(WRITE "${palpate_made}/palpated.service" "${text}")
file(INSTALL "${palpate_made}/palpated.service" "${palpate_system}/palpate-multicast.service"
  DESTINATION "${library}/systemd/system")
file(INSTALL "${palpate_system}/60-palpate.conf" DESTINATION "${CMAKE_INSTALL_PREFIX}/lib/sysctl.d")
file(INSTALL "${palpate_system}/palpate.conf" DESTINATION "${settings}/security/limits.d")
# An example to start from; an existing file is kept, since it has been edited.
if(NOT EXISTS "$ENV{DESTDIR}${settings}/palpate/palpated.yaml")
  file(READ "${palpate_system}/palpated.yaml" text)
  if(CMAKE_INSTALL_PREFIX STREQUAL "/usr")
    string(REPLACE "../../share/" "../../usr/share/" text "${text}")
  endif()
  file(WRITE "${palpate_made}/palpated.yaml" "${text}")
  file(INSTALL "${palpate_made}/palpated.yaml" DESTINATION "${settings}/palpate")
endif()
file(REMOVE_RECURSE "${palpate_made}")
