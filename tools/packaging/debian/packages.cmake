# Debian packages, one per component: cpack -G DEB in the build folder, or
# tools/packaging/make_packages.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGE_VENDOR palpate)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "shape of soft objects by force and touch")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_SET_DESTDIR ON)  # so that an installation script recognises /usr by its destination
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_OUTPUT_FILE_PREFIX ${CMAKE_BINARY_DIR}/packages)
set(CPACK_THREADS 0)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(same "(= ${PROJECT_VERSION}-1)")
include(${CMAKE_CURRENT_LIST_DIR}/control.cmake)
set(CPACK_PACKAGE_CONTACT "${PALPATE_MAINTAINER}")

# Copyright and changelog go to the folder where Debian looks for them; other prefixes need neither.
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} C)
  install(CODE "
    set(palpate_package ${CPACK_DEBIAN_${C}_PACKAGE_NAME})
    set(palpate_version ${PROJECT_VERSION}-1)
    set(palpate_maintainer \"${PALPATE_MAINTAINER}\")
    set(palpate_debian \"${CMAKE_CURRENT_SOURCE_DIR}/debian\")
    set(palpate_licence \"${CMAKE_SOURCE_DIR}/LICENSE\")
    set(palpate_made \"${CMAKE_CURRENT_BINARY_DIR}/documents/${CPACK_DEBIAN_${C}_PACKAGE_NAME}\")" COMPONENT ${component})
  install(SCRIPT debian/install_documents.cmake COMPONENT ${component})
endforeach()
# Libraries of the build itself are in no package.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY})
include(CPack)
