# The live figures of the book: the chapters that they need, compiled to WebAssembly by Debian's emscripten into one file of
# JavaScript, build/live/live-program.js (chapter LiveFigure). A target `live`; nothing where emscripten is missing.
set(MALUS_LIVE AUTO CACHE STRING "The live figures of the book: ON, OFF, or AUTO (where emscripten is installed)")
set_property(CACHE MALUS_LIVE PROPERTY STRINGS AUTO ON OFF)
set(MALUS_LIVE_PROGRAM)
if(MALUS_LIVE STREQUAL "OFF")
  return()
endif()
find_program(MALUS_EMSCRIPTEN em++)
if(NOT MALUS_EMSCRIPTEN)
  if(MALUS_LIVE STREQUAL "ON")
    message(FATAL_ERROR "The live figures need em++; Debian's package emscripten brings it.")
  endif()
  message(STATUS "The book's figures do not move: Debian's package emscripten is not installed.")
  return()
endif()

set(live ${PROJECT_BINARY_DIR}/live)
# /usr/include itself would hide emscripten's own headers: only the folders of libraries that are headers alone
file(MAKE_DIRECTORY ${live}/include)
foreach(header boost/version.hpp fmt/format.h Random123/philox.h)
  cmake_path(GET header PARENT_PATH library)
  find_path(MALUS_LIVE_${library} ${header} REQUIRED)
  file(CREATE_LINK ${MALUS_LIVE_${library}}/${library} ${live}/include/${library} SYMBOLIC)
endforeach()
get_target_property(eigen Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
set(compile ${CMAKE_COMMAND} -E env NODE_PATH=/usr/share/nodejs ${MALUS_EMSCRIPTEN} -std=c++20 -O2 -fexceptions -DFMT_HEADER_ONLY
  -I${CMAKE_CURRENT_SOURCE_DIR}/cmake/wasm -I${CMAKE_CURRENT_SOURCE_DIR}/generated -I${live}/include -I${live}/printed "-I${eigen}")
set(objects)
foreach(chapter base/CDVector base/Error base/Limits base/Random base/InputFiles
    light/CDPolarimetricMath light/CDSpectralLocation light/CDSpectralPoint light/CDSpectralUnits light/CDSpectralVector light/Parameters
    surface/Fresnel surface/Microfacets surface/DirectionSampling surface/CDBRDFModel surface/ModelRegistry surface/DHRTorranceSparrow
    surface/FacetIntegral surface/BRDFTorranceSparrow surface/TorranceSparrowGather surface/ManyMatrices
    air/RayleighLight air/RayleighOperators air/NeutralPoints render/ErrorBars live/LiveFigure live/LiveFigures)
  string(REPLACE / - object ${chapter})
  set(object ${live}/${object}.o)
  add_custom_command(
    OUTPUT ${object}
    COMMAND ${compile} -c ${MALUS_GENERATED}/${chapter}.cpp -o ${object} -MD -MF ${object}.d
    DEPENDS tangle ${MALUS_GENERATED}/${chapter}.cpp cmake/wasm/algorithm cmake/wasm/bit cmake/wasm/Random123/philox.h
    DEPFILE ${object}.d
    WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR}
    COMMENT "compile ${chapter} to WebAssembly" VERBATIM)
  list(APPEND objects ${object})
endforeach()
set(MALUS_LIVE_PROGRAM ${live}/live-program.js)
add_custom_command(
  OUTPUT ${MALUS_LIVE_PROGRAM}
  COMMAND ${compile} -sSINGLE_FILE=1 -sMODULARIZE=1 -sEXPORT_NAME=malusLive -sENVIRONMENT=web -sALLOW_MEMORY_GROWTH=1 -sFILESYSTEM=0
    -sEXPORTED_FUNCTIONS=_malusLiveFigures,_malusLiveEvaluate,_malloc -sEXPORTED_RUNTIME_METHODS=UTF8ToString
    ${objects} -o ${MALUS_LIVE_PROGRAM}
  DEPENDS ${objects}
  COMMENT "link the live figures" VERBATIM)
add_custom_target(live DEPENDS ${MALUS_LIVE_PROGRAM})
