# Writes a C++ source that holds the parts of view's page: cmake -D OUT=... -D THREE=... -D HERE=... -P embed.cmake
set(text "#pragma GCC diagnostic ignored \"-Woverlength-strings\"\n#include \"tools/view/page/parts.hpp\"\nnamespace hapgrid {\n")
foreach(part IN ITEMS "kPageHead=${HERE}/page.html" "kPageThree=${THREE}" "kPageScript=${HERE}/page.js")
  string(REGEX MATCH "^([^=]*)=(.*)$" part "${part}")
  set(name ${CMAKE_MATCH_1})
  file(READ "${CMAKE_MATCH_2}" content)
  string(APPEND text "const char* const ${name} = R\"hapgrid(${content})hapgrid\";\n")
endforeach()
file(WRITE ${OUT} "${text}}  // namespace hapgrid\n")
