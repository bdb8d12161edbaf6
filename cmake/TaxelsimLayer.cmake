# taxelsim_layer(<name> SOURCES ... [USES <layers> ...] [LINK <libraries> ...])
#
# One folder of src/ as an object library taxelsim_<name>. USES names the layers below that it may include from; LINK are outside
# libraries, private to the layer's sources. All layers together become libtaxelsim.
function(taxelsim_layer name)
  cmake_parse_arguments(LAYER "" "" "SOURCES;USES;LINK" ${ARGN})
  add_library(taxelsim_${name} OBJECT ${LAYER_SOURCES})
  target_include_directories(taxelsim_${name} PUBLIC
    ${PROJECT_SOURCE_DIR}/include ${PROJECT_BINARY_DIR}/include ${PROJECT_SOURCE_DIR}/src)
  list(TRANSFORM LAYER_USES PREPEND taxelsim_)
  target_link_libraries(taxelsim_${name} PUBLIC ${LAYER_USES} PRIVATE ${LAYER_LINK})
  taxelsim_compile_options(taxelsim_${name})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Lets the compiler inline functions that the library exports, as Clang always does.
    target_compile_options(taxelsim_${name} PRIVATE -fno-semantic-interposition)
  endif()
  set_property(GLOBAL APPEND PROPERTY TAXELSIM_LAYERS taxelsim_${name})
  set_property(GLOBAL APPEND PROPERTY TAXELSIM_LINK ${LAYER_LINK})
endfunction()

# Warnings, sanitizers and strict floating point for one of our targets. Contraction is off so that a value does not depend on which
# compiler pass saw it.
function(taxelsim_compile_options target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)  # false alarms on std::string (GCC bug 105651)
  endif()
  if(TAXELSIM_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(TAXELSIM_BUILD_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
  if(TAXELSIM_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${TAXELSIM_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE -Wno-maybe-uninitialized)  # false alarms in instrumented code
    elseif("${TAXELSIM_SANITIZE}" MATCHES "address")
      target_compile_definitions(${target} PRIVATE __SANITIZE_ADDRESS__)  # as GCC does
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${TAXELSIM_SANITIZE})
    get_target_property(type ${target} TYPE)
    if(type STREQUAL "EXECUTABLE")
      target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/cmake/sanitizers.cpp)
      target_link_options(${target} PRIVATE -Wl,--export-dynamic-symbol=dlclose)
    endif()
  endif()
endfunction()
