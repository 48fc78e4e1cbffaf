# cmake -DSOURCE=near_miss.cpp -P refused.cmake -- compiler and flags
# Fails unless the compiler refuses SOURCE in the words of its first line, and accepts it with -DMENDED.
cmake_minimum_required(VERSION 3.25)

set(compile)
math(EXPR last "${CMAKE_ARGC} - 1")
foreach(i RANGE 0 ${last})
    if(DEFINED compiling)
        list(APPEND compile ${CMAKE_ARGV${i}})
    elseif(CMAKE_ARGV${i} STREQUAL "--")
        set(compiling TRUE)
    endif()
endforeach()

file(STRINGS ${SOURCE} first LIMIT_COUNT 1)
if(NOT first MATCHES "^// expect: (.+)$")
    message(FATAL_ERROR "${SOURCE} does not begin with `// expect: <regex>`")
endif()
set(expected "${CMAKE_MATCH_1}")

execute_process(COMMAND ${compile} ${SOURCE} RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
if(status EQUAL 0)
    message(FATAL_ERROR "${SOURCE} compiles, and must not")
elseif(NOT said MATCHES "${expected}")
    message(FATAL_ERROR "${SOURCE} is refused, but not in the words `${expected}`:\n${said}")
endif()

execute_process(COMMAND ${compile} -DMENDED ${SOURCE} RESULT_VARIABLE status ERROR_VARIABLE said)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "${SOURCE} must compile when MENDED is defined:\n${said}")
endif()
