# Writes FILE, which CTest reads: one test for each GoogleTest suite of PROGRAM. One process runs a whole suite, so that it opens the device
# and builds a pipeline once. Run after PROGRAM was linked, with FOLDER (prefix of the names, and a label) and RESULTS (folder for the
# results of each suite as XML).
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listing RESULT_VARIABLE status TIMEOUT 60)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "${PROGRAM} --gtest_list_tests: ${status}\n${listing}")
endif()

string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+[.]" suites "${listing}")
list(TRANSFORM suites STRIP)
list(REMOVE_DUPLICATES suites)
set(text)
foreach(suite ${suites})
  string(REGEX REPLACE "[.]$" "" suite "${suite}")
  string(REPLACE "/" "_" file "${suite}")
  set(labels ${FOLDER})
  if(suite MATCHES "OnEveryDriver")
    list(APPEND labels portability)
  endif()
  if(suite MATCHES "Study$")
    list(APPEND labels study)
  endif()
  # RapidCheck's cases are the same in every run: its seed is fixed here.
  string(APPEND text "add_test([=[${FOLDER}.${suite}]=] [=[${PROGRAM}]=] [=[--gtest_filter=${suite}.*]=] --gtest_brief=1)\n"
    "set_tests_properties([=[${FOLDER}.${suite}]=] PROPERTIES LABELS [=[${labels}]=] TIMEOUT 1800 "
    "ENVIRONMENT [=[RC_PARAMS=seed=1;GTEST_OUTPUT=xml:${RESULTS}/${FOLDER}.${file}.xml]=])\n")
endforeach()
file(WRITE ${FILE} "${text}")
