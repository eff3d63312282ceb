# The version is that of the last tag vX.Y.Z, or where there is none, as in a source archive, this:
set(WELLGYRO_VERSION 0.1.0)
set(WELLGYRO_COMMIT "no repository")
find_package(Git QUIET)
if(Git_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${CMAKE_CURRENT_SOURCE_DIR} describe --tags --abbrev=0
      --match "v[0-9]*.[0-9]*.[0-9]*"
    OUTPUT_VARIABLE tag OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(tag MATCHES "^v([0-9]+\\.[0-9]+\\.[0-9]+)$")
    set(WELLGYRO_VERSION ${CMAKE_MATCH_1})
  endif()
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${CMAKE_CURRENT_SOURCE_DIR} rev-parse --short=12 HEAD
    OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(commit)
    set(WELLGYRO_COMMIT ${commit})
  endif()
endif()
