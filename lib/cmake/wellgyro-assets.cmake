# Writes OUTPUT, a source that holds files as bytes: ASSETS is a list of Function=file. Run with
# cmake -P at build time.
set(source "#include \"wellgyro/page/assets_internal.h\"\n\nnamespace wellgyro {\n")
foreach(asset IN LISTS ASSETS)
  string(REGEX MATCH "^([A-Za-z0-9]+)=(.*)$" found "${asset}")
  set(function ${CMAKE_MATCH_1})
  file(READ "${CMAKE_MATCH_2}" bytes HEX)
  string(REGEX REPLACE "(................................................................)"
    "\\1\n" bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND source "namespace {\nconstexpr char k${function}[] = {\n${bytes}};\n}  // namespace\n")
  string(APPEND source
    "std::string_view ${function}() { return {k${function}, sizeof k${function}}; }\n\n")
endforeach()
string(APPEND source "}  // namespace wellgyro\n")
file(WRITE "${OUTPUT}" "${source}")
