# The fuzz targets of the loaders and nothing else (TRISTIM_FUZZ=ON, preset "fuzz"): see tests/fuzz/README.md.
# Included by the top CMakeLists.txt, since the rule that makes ${EMBEDDED_CPP} holds for its folder alone.
if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  message(FATAL_ERROR "TRISTIM_FUZZ needs clang, which brings libFuzzer: use the preset, cmake --preset fuzz")
endif()

set(FUZZ_DIR ${CMAKE_SOURCE_DIR}/tests/fuzz)
# What reads users' files, and all that it needs.
file(GLOB LOADER_SOURCES CONFIGURE_DEPENDS host/base/*.cpp host/scene/*.cpp host/meshes/*.cpp host/spectra/*.cpp)
list(APPEND LOADER_SOURCES host/films/film_stack.cpp host/films/illuminant.cpp host/films/value_range.cpp)

# Undefined behaviour ends the run, as does what the address sanitizer finds.
set(FUZZ_CHECKS address,undefined)
add_library(tristim_loaders STATIC ${LOADER_SOURCES} ${EMBEDDED_CPP} ${FUZZ_DIR}/line_mutator.cpp ${FUZZ_DIR}/mesh_target.cpp
            ${FUZZ_DIR}/scratch.cpp)
# Texts cut into pieces, without a line of code.
set_source_files_properties(${EMBEDDED_CPP} PROPERTIES COMPILE_OPTIONS "-w;-fno-sanitize=all")
set_unity_groups(tristim_loaders host 4)
target_include_directories(tristim_loaders PUBLIC host tests/fuzz)
target_compile_options(tristim_loaders PUBLIC -O1 -gline-tables-only -fno-omit-frame-pointer -fno-sanitize-recover=all
                       -fsanitize=fuzzer-no-link,${FUZZ_CHECKS})
target_compile_definitions(tristim_loaders PUBLIC _GLIBCXX_ASSERTIONS)
target_link_libraries(tristim_loaders PUBLIC OpenImageIO::OpenImageIO Imath::Imath fmt::fmt
                      PRIVATE OpenMeshCore tristim_options)

set(FUZZ_SECONDS 12 CACHE STRING "How long each target runs as a test")
foreach(TARGET scene obj ply spd film)
  add_executable(fuzz_${TARGET} ${FUZZ_DIR}/fuzz_${TARGET}.cpp)
  target_link_libraries(fuzz_${TARGET} PRIVATE tristim_loaders tristim_options)
  target_link_options(fuzz_${TARGET} PRIVATE -fsanitize=fuzzer,${FUZZ_CHECKS})
  add_test(NAME fuzz.${TARGET}
           COMMAND ${FUZZ_DIR}/run $<TARGET_FILE_DIR:fuzz_${TARGET}> ${TARGET} ${FUZZ_SECONDS} -seed=1)
  set_tests_properties(fuzz.${TARGET} PROPERTIES LABELS fuzz TIMEOUT 300 ENVIRONMENT FUZZ_FRESH=1)
endforeach()
