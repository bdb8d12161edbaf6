# Installs BUILD into WORK/prefix, moves that, then configures, builds and runs SOURCE against it. Any failure ends the script with an error.
file(REMOVE_RECURSE ${WORK})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
# An installed copy must not depend on where it was installed.
file(RENAME ${WORK}/prefix ${WORK}/moved)

execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${WORK}/moved
  -DEXPECTED_VERSION=${VERSION} ${CACHE} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build COMMAND_ERROR_IS_FATAL ANY)
# The load of the last instance is 5 N, along y.
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build --target run OUTPUT_VARIABLE output ECHO_OUTPUT_VARIABLE COMMAND_ERROR_IS_FATAL ANY)
if(NOT output MATCHES "force 5.00 N, edge angle 1.57 rad")
  message(FATAL_ERROR "the program's output is wrong")
endif()
execute_process(COMMAND ${WORK}/moved/bin/taxelsim --version OUTPUT_VARIABLE version COMMAND_ERROR_IS_FATAL ANY)
if(NOT version MATCHES "${VERSION}")
  message(FATAL_ERROR "the installed program says version '${version}', not ${VERSION}")
endif()
