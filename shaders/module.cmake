# Compiles one pass to a C++ header with an array of words: cmake -DSOURCE=... -DHEADER=... -DNAME=... -DOPTIONS=... -DGLSLANGVALIDATOR=... -DSPIRV_OPT=...
# -DSPIRV_DIS=... -DSPIRV_AS=... -P module.cmake. Intermediate files lie next to the header.
#
# spirv-opt inlines all functions and removes variables and unused code, once and not in every process. Then all arithmetic is marked as exact: no driver may rearrange or fuse
# operations, so that two variants of a kernel compute the same bits from the same expressions (docs/notes/decisions/0022-exact-arithmetic.md).
cmake_minimum_required(VERSION 3.20)

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(failed)
    message(FATAL_ERROR "${SOURCE}: ${ARGN}\n${output}")
  endif()
endfunction()

# No --ssa-rewrite, with which lavapipe takes twice as long to build a kernel, and meshes 5 to 15 % longer in every frame.
set(local_variables --eliminate-local-single-block --eliminate-local-single-store --eliminate-dead-code-aggressive)
set(passes --preserve-bindings --preserve-spec-constants --merge-return --inline-entry-points-exhaustive --eliminate-dead-functions ${local_variables}
  --scalar-replacement=100 --convert-local-access-chains ${local_variables})

run(${GLSLANGVALIDATOR} -V --quiet --target-env vulkan1.2 ${OPTIONS} -o ${HEADER}.spv ${SOURCE})
run(${SPIRV_OPT} --target-env=vulkan1.2 ${passes} ${HEADER}.spv -o ${HEADER}.spv)
run(${SPIRV_DIS} --raw-id --no-header ${HEADER}.spv -o ${HEADER}.spvasm)

file(READ ${HEADER}.spvasm text)
string(REGEX MATCHALL "%[0-9]+ = Op(F(Negate|Add|Sub|Mul|Div|Rem|Mod)|VectorTimes|MatrixTimes|OuterProduct|Dot)" results "${text}")
string(REGEX MATCHALL "OpDecorate %[0-9]+ NoContraction" exact "${text}")
list(TRANSFORM results REPLACE " = .*" " NoContraction")
list(TRANSFORM results PREPEND "OpDecorate ")
list(REMOVE_ITEM results ${exact} "")
list(JOIN results "\n" decorations)
string(REGEX MATCH "\n *OpDecorate " first "${text}")
string(FIND "${text}" "${first}" at)
string(SUBSTRING "${text}" 0 ${at} before)
string(SUBSTRING "${text}" ${at} -1 after)
file(WRITE ${HEADER}.spvasm "${before}\n${decorations}${after}")
run(${SPIRV_AS} --target-env vulkan1.2 --preserve-numeric-ids ${HEADER}.spvasm -o ${HEADER}.spv)

file(READ ${HEADER}.spv bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
file(WRITE ${HEADER} "#pragma once\n#include <cstdint>\nconst std::uint32_t ${NAME}[] = {${words}};\n")
