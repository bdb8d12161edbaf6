# Writes the words of a SPIR-V module, little-endian, as a C++ array.
#
#   cmake -DMODULE=FILE -DNAME=IDENTIFIER -DHEADER=FILE -P SpirvHeader.cmake
file(READ ${MODULE} bytes HEX)
string(REGEX REPLACE "(..)(..)(..)(..)" "0x\\4\\3\\2\\1," words "${bytes}")
string(REGEX REPLACE "(...........,...........,...........,...........,...........,...........,...........,...........,)" "\\1\n" words "${words}")
file(WRITE ${HEADER} "#pragma once\n#include <cstdint>\nconst std::uint32_t ${NAME}[] = {\n${words}};\n")
