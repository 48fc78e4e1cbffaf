# Writes OUTPUT, a header that says which commit of SOURCE this is; untouched where it says so already.
execute_process(
    COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE commit
    OUTPUT_STRIP_TRAILING_WHITESPACE
    ERROR_QUIET
)
if(NOT commit)
    set(commit unknown)
endif()
set(text "#pragma once\nnamespace error_vs_time {\ninline constexpr const char* commit = \"${commit}\";\n}\n")
if(EXISTS ${OUTPUT})
    file(READ ${OUTPUT} before)
endif()
if(NOT text STREQUAL before)
    file(WRITE ${OUTPUT} "${text}")
endif()
