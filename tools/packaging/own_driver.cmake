# Builds a driver that was copied from palpate's template:
#   cmake -B build -DCMAKE_BUILD_TYPE=Release && cmake --build build
cmake_minimum_required(VERSION 3.25)
project(own_driver LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 17)
find_package(palpate 0.1 REQUIRED)
find_package(CLI11 REQUIRED)
file(GLOB sources CONFIGURE_DEPENDS *.cpp)
add_executable(own_driver ${sources})
target_link_libraries(own_driver PRIVATE palpate::bus palpate::registry palpate::kinematics CLI11::CLI11)
