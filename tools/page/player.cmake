# The player of a page that plays a grid by itself: libcore's files and player.cpp, compiled to WebAssembly by Debian's
# clang and wasi-libc. Sets player_wasm, the file; it is empty where the compiler cannot link for wasm32-wasi.
find_program(HAPGRID_WASM_CXX NAMES clang++ clang++-19 clang++-16 clang++-14)
set(player_wasm)
set(wasm_folder ${CMAKE_CURRENT_BINARY_DIR}/page)
file(MAKE_DIRECTORY ${wasm_folder})
# An exception ends the player (alone.cpp). -Os: a page is sent to others, and a tick takes less than a microsecond. fmt
# from its version 11 on wants cstdlib, which clang's library no longer includes by itself.
set(wasm_flags --target=wasm32-wasi -std=c++20 -include cstdlib -Os -DNDEBUG -ffp-contract=off -fexceptions -fno-rtti
  -ffunction-sections -fdata-sections -fvisibility=hidden -DXXH_INLINE_ALL -DXXH_NO_STREAM -I${PROJECT_SOURCE_DIR}
  -Wall -Wextra)
set(wasm_link --target=wasm32-wasi -mexec-model=reactor -Wl,--no-entry -Wl,--gc-sections -Wl,--strip-all
  -Wl,-z,stack-size=262144)
if(HAPGRID_WASM_CXX AND NOT HAPGRID_WASM_LINKS)
  file(WRITE ${wasm_folder}/try.cpp "#include <fmt/core.h>\n#include <xxhash.h>\n#include <string>\nstd::string text;\n")
  execute_process(COMMAND ${HAPGRID_WASM_CXX} ${wasm_flags} ${wasm_link} try.cpp -o try.wasm
    WORKING_DIRECTORY ${wasm_folder} RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  if(failed EQUAL 0)
    set(HAPGRID_WASM_LINKS ON CACHE INTERNAL "")
  endif()
endif()
if(NOT HAPGRID_WASM_LINKS)
  message(STATUS "no compiler for WebAssembly: view --html makes no page of a grid")
  return()
endif()
set(objects)
foreach(source libcore/base/digest libcore/follow/branch_nodes libcore/follow/branch_traversal
    libcore/follow/cell_walk libcore/follow/node_force
    libcore/follow/traversal libcore/grid/box libcore/grid/equality libcore/grid/grid
    libcore/loop/energy_tank libcore/loop/mapping libcore/loop/safety libcore/scene/drawing
    libcore/scene/scene tools/page/alone tools/page/coupled_hip tools/page/player tools/page/unpack)
  get_filename_component(name ${source} NAME)
  set(object ${wasm_folder}/${name}.o)
  add_custom_command(OUTPUT ${object}
    COMMAND ${CMAKE_CXX_COMPILER_LAUNCHER} ${HAPGRID_WASM_CXX} ${wasm_flags} -MD -MF ${object}.d -c
            ${PROJECT_SOURCE_DIR}/${source}.cpp -o ${object}
    DEPENDS ${PROJECT_SOURCE_DIR}/${source}.cpp DEPFILE ${object}.d
    COMMENT "Compiling ${source}.cpp for a page" COMMAND_EXPAND_LISTS VERBATIM)
  list(APPEND objects ${object})
endforeach()
set(player_wasm ${wasm_folder}/player.wasm)
add_custom_command(OUTPUT ${player_wasm} COMMAND ${HAPGRID_WASM_CXX} ${wasm_link} ${objects} -o ${player_wasm}
  DEPENDS ${objects} COMMENT "Linking the player of a page" VERBATIM)
