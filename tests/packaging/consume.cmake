# cmake -DHOW=… -DAGLOW_ROOT=… -DAGLOW_BUILD=… -DAGLOW_VERSION=… -DGENERATOR=… -DCOMPILER=… -DSCRATCH=… -P consume.cmake
# Builds and runs a host that takes the library by HOW, from nothing, in the folder SCRATCH.
cmake_minimum_required(VERSION 3.25)

function(run)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE said ERROR_VARIABLE said)
    if(NOT status EQUAL 0)
        list(JOIN ARGN " " command)
        message(FATAL_ERROR "${command}\n${said}")
    endif()
    set(said "${said}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${SCRATCH})

if(HOW STREQUAL "include path")
    file(MAKE_DIRECTORY ${SCRATCH})
    run(${COMPILER} -std=c++20 -I ${AGLOW_ROOT}/include ${AGLOW_ROOT}/tests/packaging/consumer/main.cpp -pthread
        -o ${SCRATCH}/consumer
    )
    run(${SCRATCH}/consumer)
else()
    set(configure ${CMAKE_COMMAND} -S ${AGLOW_ROOT}/tests/packaging/consumer -B ${SCRATCH}/build -G ${GENERATOR}
        -DCMAKE_CXX_COMPILER=${COMPILER} -DHOW=${HOW} -DAGLOW_ROOT=${AGLOW_ROOT} -DAGLOW_VERSION=${AGLOW_VERSION}
    )
    if(HOW STREQUAL "find_package")
        # Installed in one place and moved to another: the package must not remember where it was.
        run(${CMAKE_COMMAND} --install ${AGLOW_BUILD} --prefix ${SCRATCH}/before)
        file(RENAME ${SCRATCH}/before ${SCRATCH}/prefix)
        list(APPEND configure -DCMAKE_PREFIX_PATH=${SCRATCH}/prefix)
    endif()
    run(${configure})
    run(${CMAKE_COMMAND} --build ${SCRATCH}/build)
    run(${SCRATCH}/build/consumer)
endif()

if(NOT said STREQUAL "aglow ${AGLOW_VERSION}\n")
    message(FATAL_ERROR "the host said `${said}`, not `aglow ${AGLOW_VERSION}`")
endif()

if(HOW MATCHES "add_subdirectory|FetchContent")
    run(${CMAKE_COMMAND} --install ${SCRATCH}/build --prefix ${SCRATCH}/host)
    if(EXISTS ${SCRATCH}/host/include)
        message(FATAL_ERROR "the host installs headers of the library, unasked")
    endif()
endif()
