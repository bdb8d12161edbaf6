# Target `docs`, if Doxygen is installed (scripts/setup --with-docs): XML of the public headers, from which scripts/docs makes the C++ reference.
# A warning is an error.
find_program(TAXELSIM_DOXYGEN doxygen)
mark_as_advanced(TAXELSIM_DOXYGEN)
if(TAXELSIM_DOXYGEN)
  configure_file(${PROJECT_SOURCE_DIR}/docs/Doxyfile.in ${PROJECT_BINARY_DIR}/docs/Doxyfile @ONLY)
  add_custom_target(docs
    COMMAND ${TAXELSIM_DOXYGEN} ${PROJECT_BINARY_DIR}/docs/Doxyfile
    VERBATIM)
endif()
