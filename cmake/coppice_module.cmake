include(GNUInstallDirs)
set(COPPICE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/coppice)

# coppice_module(NAME field HEADERS a.h ... SOURCES a.cpp ... [TESTS a_test.cpp ...] [TEST_LIBRARIES coppice_zoo ...] [TEST_SHARDS n]
#                [PACKAGES fmt ...] [LIBRARIES fmt::fmt ...]                  required by its headers
#                [PRIVATE_PACKAGES "embree 3" ...] [PRIVATE_LIBRARIES ...]    required for linking
#                [BUILD_PACKAGES nanoflann ...] [BUILD_LIBRARIES ...])        headers that only its sources include
#
# Defines the library coppice::NAME of the folder src/coppice/NAME, which depends on the modules listed in layers.txt. It is a component
# of the package: find_package(coppice COMPONENTS NAME) finds only the packages that NAME and the modules below it require.
# Its tests are in tests/NAME/ and link only this module, so that a call to a higher layer fails at link time; script/headers
# compiles every header on its own.
function(coppice_module)
  cmake_parse_arguments(M "" "NAME;TEST_SHARDS" "HEADERS;SOURCES;TESTS;TEST_LIBRARIES;PACKAGES;LIBRARIES;PRIVATE_PACKAGES;PRIVATE_LIBRARIES;BUILD_PACKAGES;BUILD_LIBRARIES" ${ARGN})
  foreach(package IN LISTS M_PACKAGES M_PRIVATE_PACKAGES M_BUILD_PACKAGES)
    separate_arguments(package)
    find_package(${package} REQUIRED)
  endforeach()

  set(target coppice_${M_NAME})
  add_library(${target} ${M_SOURCES})
  add_library(coppice::${M_NAME} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${M_HEADERS})
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
                        DEFINE_SYMBOL "")
  target_compile_features(${target} PUBLIC cxx_std_20)
  coppice_warnings(${target})
  coppice_group_sources(${target})
  coppice_layers_below(below ${M_NAME})
  set(below_targets ${below})
  list(TRANSFORM below_targets PREPEND coppice::)
  target_link_libraries(${target} PUBLIC ${below_targets} ${M_LIBRARIES} PRIVATE ${M_PRIVATE_LIBRARIES})
  foreach(library IN LISTS M_BUILD_LIBRARIES)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:${library}>)
  endforeach()

  # Users of a shared library do not need the private packages of that library.
  if(NOT BUILD_SHARED_LIBS)
    list(APPEND M_PACKAGES ${M_PRIVATE_PACKAGES})
  endif()
  coppice_component(${M_NAME} "${below}" "${M_PACKAGES}")

  if(COPPICE_BUILD_TESTS AND M_TESTS)
    list(TRANSFORM M_TESTS PREPEND ${PROJECT_SOURCE_DIR}/tests/${M_NAME}/)
    coppice_test(${M_NAME}_test SOURCES ${M_TESTS} LIBRARIES coppice::${M_NAME} ${M_TEST_LIBRARIES} SHARDS ${M_TEST_SHARDS})
  endif()
endfunction()

# coppice_layers_below(VARIABLE NAME): sets VARIABLE to the modules that NAME may include according to layers.txt, including base.
function(coppice_layers_below variable name)
  set(layers ${PROJECT_SOURCE_DIR}/layers.txt)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${layers})
  file(STRINGS ${layers} line REGEX "^${name}:")
  string(REGEX MATCHALL "[a-z_]+" modules "${line}")
  list(POP_FRONT modules)
  if(NOT name STREQUAL base)
    list(PREPEND modules base)
  endif()
  set(${variable} ${modules} PARENT_SCOPE)
endfunction()

# coppice_component(NAME BELOW PACKAGES): installs a module as coppice::NAME, and records for coppice-config.cmake the
# modules below it and the packages that its users need.
function(coppice_component name below packages)
  set_property(GLOBAL APPEND PROPERTY COPPICE_COMPONENTS ${name})
  set_property(GLOBAL APPEND_STRING PROPERTY COPPICE_COMPONENT_NOTES
               "set(coppice_${name}_below \"${below}\")\nset(coppice_${name}_packages \"${packages}\")\n")
  if(COPPICE_INSTALL)
    set_target_properties(coppice_${name} PROPERTIES EXPORT_NAME ${name})
    install(TARGETS coppice_${name} EXPORT coppice-${name}-targets FILE_SET HEADERS)
    install(EXPORT coppice-${name}-targets NAMESPACE coppice:: DESTINATION ${COPPICE_PACKAGE_DIR})
  endif()
endfunction()

# coppice_test(NAME SOURCES ... LIBRARIES ... [SHARDS n]): adds a GoogleTest program of unit tests.
function(coppice_test name)
  cmake_parse_arguments(T "" "SHARDS" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${T_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(${name} PRIVATE ${T_LIBRARIES} coppice_test_paths GTest::gtest_main)
  coppice_warnings(${name})
  coppice_group_sources(${name})
  target_compile_options(${name} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${COPPICE_TEST_OPTIONS}>")
  add_dependencies(unit_tests ${name})
  coppice_add_shards(${name} unit "${T_SHARDS}" "*")
  coppice_note_thread_tests(${T_SOURCES})
endfunction()

# coppice_add_shards(NAME LABEL COUNT FILTER): adds COUNT tests of CTest that run equal shares of the matching cases of a GoogleTest program,
# each in one process, because starting a process needs more time than most cases. The results of the cases are written to
# results/LABEL.NAME.SHARD.xml in the build folder.
function(coppice_add_shards name label count filter)
  if(NOT count)
    set(count 1)
  endif()
  math(EXPR last "${count} - 1")
  foreach(shard RANGE ${last})
    set(test ${label}.${name}.${shard})
    add_test(NAME ${test} COMMAND ${name} --gtest_brief=1 "--gtest_filter=${filter}" --gtest_output=xml:${PROJECT_BINARY_DIR}/results/${test}.xml)
    set_tests_properties(${test} PROPERTIES LABELS ${label} TIMEOUT 900 COST 100 ENVIRONMENT "GTEST_TOTAL_SHARDS=${count};GTEST_SHARD_INDEX=${shard}")
  endforeach()
endfunction()

# coppice_group_sources(TARGET): with COPPICE_GROUPED_SOURCES, compiles up to 16 compatible sources as one, which needs less than half of
# the time. The whole group is compiled if one of its sources changes. Sources with SKIP_UNITY_BUILD_INCLUSION are compiled alone.
function(coppice_group_sources target)
  if(NOT COPPICE_GROUPED_SOURCES)
    return()
  endif()
  get_target_property(listed ${target} SOURCES)
  foreach(source IN LISTS listed)
    get_source_file_property(alone ${source} SKIP_UNITY_BUILD_INCLUSION)
    if(source MATCHES "[.]cpp$" AND NOT alone)
      cmake_path(ABSOLUTE_PATH source)
      list(APPEND sources ${source})
    else()
      list(APPEND others ${source})
    endif()
  endforeach()
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${sources} ${PROJECT_SOURCE_DIR}/script/source_groups.py)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  execute_process(COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/script/source_groups.py 16 ${CMAKE_CURRENT_BINARY_DIR}/${target}_groups
                          ${sources}
                  OUTPUT_VARIABLE grouped COMMAND_ERROR_IS_FATAL ANY)
  set_property(TARGET ${target} PROPERTY SOURCES ${grouped} ${others})
  # A source may reuse names of other sources of its group, but not twice within one function. The compiler takes included sources for
  # headers, and would warn of their anonymous namespaces.
  set(options -Wno-shadow "$<$<CXX_COMPILER_ID:GNU>:-Wshadow=local;-Wno-subobject-linkage>")
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${options}>")
endfunction()

# coppice_note_thread_tests(SOURCE...): adds the sources with thread tests (cases named ...Thread...) to the program thread_tests.
function(coppice_note_thread_tests)
  foreach(source IN LISTS ARGN)
    cmake_path(ABSOLUTE_PATH source)
    file(STRINGS ${source} found REGEX "^TEST.*Thread" LIMIT_COUNT 1)
    if(found)
      set_property(GLOBAL APPEND PROPERTY COPPICE_THREAD_TESTS ${source})
    endif()
  endforeach()
endfunction()
