# Fails unless PAGE contains the text of PROGRAM as a code block.
file(READ ${PAGE} readme)
file(READ ${PROGRAM} program)
string(FIND "${readme}" "```cpp\n${program}```" place)
if(place EQUAL -1)
  message(FATAL_ERROR "${PAGE} has no code block equal to ${PROGRAM}")
endif()
