# Names, dependencies and descriptions of the Debian packages, one for each component of cmake --install: read by
# packages.cmake (CPack) and by write_source.cmake (the source package). `same` is the restriction to the same version.
# To publish packages, set your own address.
set(PALPATE_MAINTAINER "palpate authors <palpate@example.org>" CACHE STRING "Maintainer of the Debian packages")
set(CPACK_COMPONENTS_ALL daemon sim tools dev python)

# palpate_package(component package section summary dependencies description)
function(palpate_package component package section summary depends)
  string(TOUPPER ${component} C)
  foreach(pair "PACKAGE_NAME=${package}" "PACKAGE_SECTION=${section}" "PACKAGE_SHLIBDEPS=ON" "PACKAGE_DEPENDS=${depends}")
    string(FIND "${pair}" "=" at)
    string(SUBSTRING "${pair}" 0 ${at} key)
    math(EXPR at "${at} + 1")
    string(SUBSTRING "${pair}" ${at} -1 value)
    set(CPACK_DEBIAN_${C}_${key} "${value}" PARENT_SCOPE)
  endforeach()
  list(JOIN ARGN "\n" description)
  set(CPACK_COMPONENT_${C}_DESCRIPTION "${summary}\n${description}" PARENT_SCOPE)
endfunction()

# CHOLMOD and libtorch need a BLAS with locks.
set(blas "")
set(cholmod "")
if(PALPATE_SUITESPARSE)
  set(blas "libopenblas0-pthread")
  set(cholmod ", libsuitesparse-dev")
endif()
palpate_package(daemon palpate misc "daemon that feels and steers the shape of soft objects" "${blas}"
  "palpated reads force-torque, joint and tactile sensors from LCM channels,"
  "estimates the shape of a soft object that a robot holds, and commands the"
  "arm until the shape is as wanted. palpate-command talks to it. Comes with"
  "examples, units for systemd and real-time limits.")
palpate_package(sim palpate-sim misc "simulator of arm, hand, sensors and soft object for palpated"
  "palpate ${same}, libosmesa6"
  "palpate-sim uses the same channels as a robot, so that palpated runs without"
  "a robot. Its camera renders by OSMesa.")
palpate_package(tools palpate-tools misc "tools around palpated: fitting, training, evaluation, logs"
  "palpate ${same}, palpate-sim ${same}, python3"
  "Material parameters from recordings, sensor models, scores on the"
  "simulator's truth, replay and import of logs, injection of faults.")
palpate_package(dev palpate-dev libdevel "headers and libraries of palpate for drivers and components"
  "libeigen3-dev, liblcm-dev, libyaml-cpp-dev, libsodium-dev, liburdfdom-dev, libmetis-dev, libcli11-dev${cholmod}"
  "For find_package(palpate) of CMake: message types, the LCM bus with its"
  "codes of authentication, the mathematics, and a driver to start one's own"
  "from.")
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)  # no part of it is linked
palpate_package(python python3-palpate python "logs, buses and commands of palpated from Python"
  "python3, python3-numpy"
  "Reads LCM logs as numpy arrays, publishes and subscribes, commands palpated"
  "and scores shapes on the simulator's truth. Needs no LCM module.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, palpate")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
  "${CMAKE_CURRENT_LIST_DIR}/python/postinst;${CMAKE_CURRENT_LIST_DIR}/python/prerm")
# Loaded together with a model, so that no program is linked to it.
set(CPACK_DEBIAN_TOOLS_PACKAGE_RECOMMENDS "python3-palpate, python3-scipy, python3-yaml, python3-pil, python3-jinja2, python3-matplotlib, rt-tests, stress-ng, liblcm-bin")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "python3-opencv, python3-open3d")
set(CPACK_DEBIAN_DAEMON_PACKAGE_RECOMMENDS "iproute2")  # for palpate-multicast.service
set(CPACK_DEBIAN_DAEMON_PACKAGE_SUGGESTS "palpate-tools, palpate-sim")
set(CPACK_DEBIAN_DAEMON_PACKAGE_CONTROL_EXTRA
  "${CMAKE_CURRENT_LIST_DIR}/conffiles;${CMAKE_CURRENT_LIST_DIR}/postinst;${CMAKE_CURRENT_LIST_DIR}/postrm;${CMAKE_CURRENT_LIST_DIR}/prerm")
