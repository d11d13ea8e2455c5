# cmake -D BUILD= -D SOURCE= -D WORK= -D COMPILER= -D FLAGS= -P install_test.cmake
# Installs BUILD into WORK/prefix, builds examples/ as a project of its own against it, and runs the example.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -S ${SOURCE}/examples -B ${WORK}/build -D CMAKE_PREFIX_PATH=${WORK}/prefix
    -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${FLAGS} -D CMAKE_BUILD_TYPE=Release)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/mesh_a_tree ${SOURCE}/examples/oak.swc ${WORK}/oak.ply)
run(${WORK}/prefix/bin/coppice check ${WORK}/oak.ply --no-intersections)
