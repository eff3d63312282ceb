# How every target of the project is compiled.
#
# Contraction is off so that a*b+c has one result on every processor: the same messages give the
# same bytes. For the same reason there is no -ffast-math and no -march=native anywhere.
#
# Optimising, g++ 12 sees what is not there in std::string and std::optional (its PR 105329, 105562),
# and so it does between the checks of sanitizers, see CMakePresets.json; the build with assertions,
# which optimises less, keeps both warnings.
#
# Of several sources as one (WELLGYRO_UNITY) g++ takes the names of one to shadow those of another, and
# beside precompiled headers it sees bounds broken that are kept: these warnings are for the sources one
# by one.
#
# Where WELLGYRO_LINES is off nothing is kept for debuggers, and reports of the sanitizers name
# functions without their lines: clang then takes 7 % less. tests/run asks for it without ccache.
option(WELLGYRO_LINES "Keep line numbers where the build has them" ON)

# Half of a compilation is the optimiser's. A tree that is built to be tested optimises what its tests
# wait for, the numeric rooms and their own loops, and nothing else: wellgyro_compile(target NUMERIC)
# adds these options to those of the tree, wellgyro_compile(target LIGHT) those for what loops little
# itself: tests, and in the sanitised tree some rooms.
set(WELLGYRO_NUMERIC_OPTIONS "" CACHE STRING "Options of numeric rooms and tests beside the tree's")
set(WELLGYRO_LIGHT_OPTIONS "" CACHE STRING "Options of what loops little, beside the tree's")
function(wellgyro_compile target)
  cmake_parse_arguments(COMPILE "NUMERIC;LIGHT" "" "" ${ARGN})
  target_compile_features(${target} PUBLIC cxx_std_20)
  # Nothing is contracted, so that every processor has the same bits; no one asks errno or the flags of
  # the floating point, whose upkeep is some 4 % of a survey's time.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU,Clang>:-ffp-contract=off -fno-math-errno -fno-trapping-math -Wall -Wextra -Wpedantic -Wconversion -Wno-sign-conversion
      -Wno-missing-field-initializers -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual>
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<CONFIG:Release>>:-Wno-maybe-uninitialized -Wno-restrict>
    $<$<AND:$<CXX_COMPILER_ID:GNU,Clang>,$<BOOL:${WELLGYRO_WERROR}>>:-Werror>
    $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${WELLGYRO_UNITY}>>:SHELL:--param ggc-min-heapsize=1000000
      -Wno-shadow -Wno-subobject-linkage -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread>
    $<$<NOT:$<BOOL:${WELLGYRO_LINES}>>:-g0>
    $<$<BOOL:${COMPILE_NUMERIC}>:${WELLGYRO_NUMERIC_OPTIONS}>
    $<$<BOOL:${COMPILE_LIGHT}>:${WELLGYRO_LIGHT_OPTIONS}>)
  # Static and shared libraries are made of the same objects.
  set_target_properties(${target} PROPERTIES DEFINE_SYMBOL "")
endfunction()

# Of an inline function that several objects hold the linker takes the first that it meets. For a program
# whose own copies are not optimised, the libraries are put before it, whole, where the tree optimises
# them apart.
function(wellgyro_link_before target)
  if(BUILD_SHARED_LIBS OR NOT (WELLGYRO_NUMERIC_OPTIONS OR WELLGYRO_LIGHT_OPTIONS))
    return()
  endif()
  foreach(library IN LISTS ARGN)
    if(library MATCHES "^wellgyro::")
      target_link_options(${target} PRIVATE
        "LINKER:--whole-archive,$<TARGET_FILE:${library}>,--no-whole-archive")
    endif()
  endforeach()
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
    # The macros with which it was made, of the libraries that the other target links.
    get_target_property(linked ${PCH_LIKE} LINK_LIBRARIES)
    foreach(library IN LISTS linked)
      if(TARGET ${library})
        target_compile_options(${target} PRIVATE
          $<FILTER:$<TARGET_PROPERTY:${library},INTERFACE_COMPILE_OPTIONS>,INCLUDE,^-D>)
        target_compile_definitions(${target} PRIVATE
          $<TARGET_PROPERTY:${library},INTERFACE_COMPILE_DEFINITIONS>)
      endif()
    endforeach()
  else()
    target_precompile_headers(${target} PRIVATE ${PCH_UNPARSED_ARGUMENTS})
  endif()
endfunction()
set(WELLGYRO_PCH_HEADERS <algorithm> <array> <cmath> <cstddef> <cstdint> <filesystem> <fstream>
  <functional> <limits> <map> <memory> <numbers> <optional> <set> <span> <sstream> <stdexcept>
  <string> <string_view> <utility> <variant> <vector> <Eigen/Cholesky> <Eigen/Core>
  <Eigen/Eigenvalues> <Eigen/Geometry> <Eigen/LU> <Eigen/QR> <Eigen/SVD>)

# Unity builds, where asked for: wellgyro_unity(target <source>...) has the compiler read the sources of
# each folder together, two dozen at a time, so that what they all include and instantiate is done once.
# A name in an unnamed namespace must then be one source's in its folder; tests/structure says where in
# the libraries it is not.
#
# Not the default: after a change all of the two dozen are compiled anew, and ccache shares less.
option(WELLGYRO_UNITY "Compile the sources of a room together: faster from scratch" OFF)
function(wellgyro_unity target)
  if(NOT WELLGYRO_UNITY)
    return()
  endif()
  set(most 24)
  set(folders)
  foreach(source IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
    cmake_path(GET source PARENT_PATH folder)
    list(APPEND folders ${folder})
    list(APPEND "in ${folder}" ${source})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder IN LISTS folders)
    list(LENGTH "in ${folder}" count)
    math(EXPR parts "(${count} + ${most} - 1) / ${most}")
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE group)
    string(MAKE_C_IDENTIFIER ${group} group)
    set(place 0)
    foreach(source IN LISTS "in ${folder}")
      math(EXPR part "${place} * ${parts} / ${count}")
      set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES
        UNITY_GROUP ${group}_${part})
      math(EXPR place "${place} + 1")
    endforeach()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# A room of a library: its sources, named relative to the room. Which headers are public is told by
# lib/public-headers.txt.
#   wellgyro_room(wellgyro noise SOURCES allan.cpp)
function(wellgyro_room target room)
  cmake_parse_arguments(ROOM "" "" "SOURCES;HEADERS" ${ARGN})
  if(ROOM_HEADERS)
    message(FATAL_ERROR "${room}: public headers stand in lib/public-headers.txt")
  endif()
  string(REGEX REPLACE "/.*" "" whole ${room})
  if(whole IN_LIST numeric_rooms)  # see lib/CMakeLists.txt
    set(target ${numeric})
  elseif(room IN_LIST light_rooms)
    set(target ${light})
  endif()
  list(TRANSFORM ROOM_SOURCES PREPEND ${PROJECT_SOURCE_DIR}/lib/wellgyro/${room}/)
  target_sources(${target} PRIVATE ${ROOM_SOURCES})
  wellgyro_unity(${target} ${ROOM_SOURCES})
endfunction()
