# cmake -DFULL=program -DMATTE=program -DNM=nm -P gate.cmake
# Fails unless the lobes that MATTE cannot have are absent from it and present in FULL, and both make the same picture.
cmake_minimum_required(VERSION 3.25)

foreach(build FULL MATTE)
    execute_process(COMMAND ${NM} -C ${${build}} OUTPUT_VARIABLE ${build}_symbols COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND ${${build}} OUTPUT_VARIABLE ${build}_said COMMAND_ERROR_IS_FATAL ANY)
    string(REGEX REPLACE "\n.*" "" ${build}_picture "${${build}_said}")
endforeach()

foreach(lobe glossy_lobe specular_lobe transmitted_lobe)
    if(NOT FULL_symbols MATCHES "${lobe}")
        message(FATAL_ERROR "${lobe} is not in the full program: the gate sees nothing")
    endif()
    if(MATTE_symbols MATCHES "${lobe}")
        message(FATAL_ERROR "${lobe} is in a program whose scene cannot have it")
    endif()
endforeach()
if(NOT FULL_picture STREQUAL MATTE_picture)
    message(FATAL_ERROR "left out, the picture changes: ${FULL_picture} is not ${MATTE_picture}")
endif()
if(NOT MATTE_said MATCHES "caustic paths 0: left out, no specular surface")
    message(FATAL_ERROR "caustic photons are not left out: ${MATTE_said}")
endif()
