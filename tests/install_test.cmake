# cmake -D BUILD= -D SOURCE= -D WORK= -D COMPILER= -D FLAGS= -D PYTHON= -P install_test.cmake
# Uses Coppice like another project: installs BUILD into WORK/prefix, builds examples/ and tests/guest against it as separate
# projects and runs them; then builds tests/guest with Coppice as a subdirectory and with shared libraries.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
endfunction()

# build(FOLDER SOURCE -D ...): configures and builds a project.
function(build folder source)
  run(${CMAKE_COMMAND} -S ${source} -B ${folder} -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_CXX_FLAGS=${FLAGS} ${ARGN})
  run(${CMAKE_COMMAND} --build ${folder})
endfunction()

file(REMOVE_RECURSE ${WORK})
set(prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})

build(${WORK}/examples ${SOURCE}/examples -D CMAKE_PREFIX_PATH=${prefix} -D CMAKE_BUILD_TYPE=Debug)
run(${WORK}/examples/mesh_a_tree ${SOURCE}/examples/oak.swc ${WORK}/oak.ply)
run(${PYTHON} ${SOURCE}/tests/tour_test.py ${SOURCE} ${WORK}/examples/tour)
run(${prefix}/bin/coppice check ${WORK}/oak.ply --no-intersections)
foreach(file man/man1/coppice-mesh.1 bash-completion/completions/coppice applications/coppice-studio.desktop)
  if(NOT EXISTS ${prefix}/share/${file})
    message(FATAL_ERROR "share/${file} is not installed")
  endif()
endforeach()

# The module skeleton does not need the packages of meshes, images and files.
foreach(package embree PNG ZLIB EXPAT hwy Eigen3 nanoflann nlohmann_json)
  list(APPEND without -D CMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()
build(${WORK}/guest ${SOURCE}/tests/guest -D CMAKE_PREFIX_PATH=${prefix} ${without})
run(${WORK}/guest/guest)

build(${WORK}/host ${SOURCE}/tests/guest -D COPPICE_SOURCE=${SOURCE} -D BUILD_SHARED_LIBS=ON -D COPPICE_CUDA=OFF)
run(${WORK}/host/guest)
file(GLOB shared ${WORK}/host/coppice/src/coppice/skeleton/*.so)
if(NOT shared)
  message(FATAL_ERROR "BUILD_SHARED_LIBS=ON built no shared library")
endif()
