# palpate::plugin: interface target for libraries with user components: `plugin.hpp` and the headers
# of core that it includes; nothing to link.
add_library(palpate_plugin INTERFACE)
add_library(palpate::plugin ALIAS palpate_plugin)
set_target_properties(palpate_plugin PROPERTIES EXPORT_NAME plugin)
target_link_libraries(palpate_plugin INTERFACE Eigen3::Eigen)
target_compile_features(palpate_plugin INTERFACE cxx_std_17)
# host and library must agree on the alignment
target_compile_definitions(palpate_plugin INTERFACE
  EIGEN_MAX_ALIGN_BYTES=16 PALPATE_VERSION="${PROJECT_VERSION}")
# and on the allocation of memory that the other side frees: with AVX, as the host is compiled, it is Eigen's own
if(PALPATE_MARCH AND NOT PALPATE_SANITIZE)
  target_compile_definitions(palpate_plugin INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=0)
endif()
# symbols of the library must not be merged with equally named ones of the host
target_compile_options(palpate_plugin INTERFACE -fvisibility=hidden)
target_link_options(palpate_plugin INTERFACE -Wl,-Bsymbolic)
target_include_directories(palpate_plugin INTERFACE
  $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}> $<INSTALL_INTERFACE:include/palpate>)

set(folder ${CMAKE_BINARY_DIR}/palpate-plugin)
set(config "include(CMakeFindDependencyMacro)
find_dependency(Eigen3 3.4 NO_MODULE)
include(\"\${CMAKE_CURRENT_LIST_DIR}/palpate-plugin-targets.cmake\")
")
file(WRITE ${folder}/palpate-plugin-config.cmake "${config}")
export(TARGETS palpate_plugin NAMESPACE palpate:: FILE ${folder}/palpate-plugin-targets.cmake)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/palpate-plugin)
install(TARGETS palpate_plugin EXPORT palpate-plugin-targets COMPONENT plugin)
install(EXPORT palpate-plugin-targets NAMESPACE palpate:: DESTINATION ${package} COMPONENT plugin)
install(FILES ${folder}/palpate-plugin-config.cmake DESTINATION ${package} COMPONENT plugin)
install(DIRECTORY ${CMAKE_SOURCE_DIR}/core DESTINATION include/palpate COMPONENT plugin
  FILES_MATCHING PATTERN "*.hpp")
install(FILES ${CMAKE_SOURCE_DIR}/rt/plugin/plugin.hpp
  ${CMAKE_SOURCE_DIR}/rt/plugin/plugin_components.hpp
  DESTINATION include/palpate/rt/plugin COMPONENT plugin)
install(FILES ${CMAKE_SOURCE_DIR}/rt/config/option.hpp
  DESTINATION include/palpate/rt/config COMPONENT plugin)
