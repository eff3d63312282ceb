# How every target of the project is compiled.
#
# Contraction is off so that a*b+c has one result on every processor: the same messages give the
# same bytes. For the same reason there is no -ffast-math and no -march=native anywhere.
#
# Optimising, g++ 12 sees what is not there in std::string and std::optional (its PR 105329, 105562),
# and so it does between the checks of sanitizers, see CMakePresets.json; the build with assertions,
# which optimises less, keeps both warnings.
function(wellgyro_compile target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU,Clang>:-ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wno-sign-conversion
      -Wno-missing-field-initializers -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual>
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-Wno-maybe-uninitialized -Wno-restrict>
    $<$<AND:$<CXX_COMPILER_ID:GNU,Clang>,$<BOOL:${WELLGYRO_WERROR}>>:-Werror>)
  # Static and shared libraries are made of the same objects.
  set_target_properties(${target} PROPERTIES DEFINE_SYMBOL "")
endfunction()

# Precompiled headers, where asked for: wellgyro_precompile(target <header> ...) makes one for the
# target, wellgyro_precompile(target LIKE other) takes the one of another target, which must be of
# the same kind (libraries are compiled with -fPIC, programs with -fPIE) and define no macro that the
# target does not.
#
# Not the default: ccache shares no precompiled header between clones, a source that forgot an include
# compiles all the same, and g++ 12 then warns of bounds that are kept. tests/run asks for them, and
# for no warnings as errors, on a machine without ccache.
option(WELLGYRO_PCH "Precompile the headers of others: half the time from scratch" OFF)
function(wellgyro_precompile target)
  cmake_parse_arguments(PCH "" "LIKE" "" ${ARGN})
  if(NOT WELLGYRO_PCH)
    return()
  elseif(PCH_LIKE)
    target_precompile_headers(${target} REUSE_FROM ${PCH_LIKE})
  else()
    target_precompile_headers(${target} PRIVATE ${PCH_UNPARSED_ARGUMENTS})
  endif()
endfunction()
set(WELLGYRO_PCH_HEADERS <algorithm> <array> <cmath> <cstddef> <cstdint> <filesystem> <fstream>
  <functional> <limits> <map> <memory> <numbers> <optional> <set> <span> <sstream> <stdexcept>
  <string> <string_view> <utility> <variant> <vector> <Eigen/Cholesky> <Eigen/Core>
  <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <Eigen/QR> <Eigen/SVD>)

# A room of a library: its sources, named relative to the room. Which headers are public is told by
# lib/public-headers.txt.
#   wellgyro_room(wellgyro noise SOURCES allan.cpp)
function(wellgyro_room target room)
  cmake_parse_arguments(ROOM "" "" "SOURCES;HEADERS" ${ARGN})
  if(ROOM_HEADERS)
    message(FATAL_ERROR "${room}: public headers stand in lib/public-headers.txt")
  endif()
  list(TRANSFORM ROOM_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/lib/wellgyro/${room}/)
  target_sources(${target} PRIVATE ${ROOM_SOURCES})
endfunction()
