# Installs the build, moves the installation (so that nothing can point back to where it was made),
# and builds and runs a program of another project with it.

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK_DIR}
    RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "'${command}' ended with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(prefix ${WORK_DIR}/moved)
file(REMOVE_RECURSE ${WORK_DIR})
file(MAKE_DIRECTORY ${WORK_DIR})
run(${CMAKE_COMMAND} --install ${BUILD_DIR} --prefix ${WORK_DIR}/made)
file(RENAME ${WORK_DIR}/made ${prefix})

file(GLOB_RECURSE package_files ${prefix}/*/cmake/vdb_offset/*.cmake)
if(NOT package_files)
  message(FATAL_ERROR "no package config was installed")
endif()
foreach(file ${package_files})
  file(READ ${file} text)
  foreach(path ${SOURCE_DIR} ${BUILD_DIR} ${WORK_DIR})
    string(FIND "${text}" "${path}/" where)
    if(NOT where EQUAL -1)
      message(FATAL_ERROR "${file} names ${path}, a place of the build")
    endif()
  endforeach()
endforeach()

set(flags "")
if(SANITIZE)
  set(flags -fsanitize=${SANITIZE})
endif()
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE_DIR}/tests/consumer -B ${WORK_DIR}/build
    -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${flags}
    -D CMAKE_BUILD_TYPE=${BUILD_TYPE} -D WANTED_VERSION=${VERSION})
run(${CMAKE_COMMAND} --build ${WORK_DIR}/build)
run(${WORK_DIR}/build/consumer)
if(NOT EXISTS ${WORK_DIR}/cube.vtm)
  message(FATAL_ERROR "the program ran, but wrote no blocks")
endif()

# The README shows the program that was just built.
file(READ ${SOURCE_DIR}/README.md readme)
file(READ ${SOURCE_DIR}/tests/consumer/main.cc program)
string(FIND "${readme}" "${program}" where)
if(where EQUAL -1)
  message(FATAL_ERROR "README.md does not show tests/consumer/main.cc as it is")
endif()

if(EXISTS ${prefix}/bin/vdb-offset)
  run(${prefix}/bin/vdb-offset --version)
  if(NOT output MATCHES "${VERSION}")
    message(FATAL_ERROR "the installed command says its version is '${output}', not ${VERSION}")
  endif()
endif()
