# coppice_module(NAME field HEADERS a.h ... SOURCES a.cpp ... [LIBRARIES public targets] [PRIVATE_LIBRARIES targets]
#                [TESTS a_test.cpp ...] [TEST_LIBRARIES coppice_zoo ...])
#
# One folder of src/coppice = one library coppice::NAME, which depends on what layers.txt names. Its tests lie in
# tests/NAME/ and link this module alone, so that a call to a higher layer fails at link time; every header is also
# compiled on its own (all_verify_interface_header_sets).
function(coppice_module)
  cmake_parse_arguments(M "" "NAME" "HEADERS;SOURCES;LIBRARIES;PRIVATE_LIBRARIES;TESTS;TEST_LIBRARIES" ${ARGN})
  set(target coppice_${M_NAME})
  add_library(${target} STATIC ${M_SOURCES})
  add_library(coppice::${M_NAME} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/src FILES ${M_HEADERS})
  set_target_properties(${target} PROPERTIES VERIFY_INTERFACE_HEADER_SETS ON POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  coppice_warnings(${target})
  coppice_layers_below(below ${M_NAME})
  target_link_libraries(${target} PUBLIC ${below} ${M_LIBRARIES} PRIVATE ${M_PRIVATE_LIBRARIES})
  coppice_install(${M_NAME})
  if(COPPICE_BUILD_TESTS AND M_TESTS)
    list(TRANSFORM M_TESTS PREPEND ${PROJECT_SOURCE_DIR}/tests/${M_NAME}/)
    coppice_test(${M_NAME}_test SOURCES ${M_TESTS} LIBRARIES coppice::${M_NAME} ${M_TEST_LIBRARIES})
  endif()
endfunction()

# coppice_layers_below(VARIABLE NAME): the targets of the modules that NAME may include by layers.txt, base included.
function(coppice_layers_below variable name)
  set(layers ${PROJECT_SOURCE_DIR}/layers.txt)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${layers})
  file(STRINGS ${layers} line REGEX "^${name}:")
  string(REGEX MATCHALL "[a-z_]+" modules "${line}")
  list(REMOVE_AT modules 0)
  if(NOT name STREQUAL base)
    list(PREPEND modules base)
  endif()
  list(TRANSFORM modules PREPEND coppice::)
  set(${variable} ${modules} PARENT_SCOPE)
endfunction()

# coppice_install(NAME): the library and its public headers, as coppice::NAME of the package.
function(coppice_install name)
  set_target_properties(coppice_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS coppice_${name} EXPORT coppice-targets FILE_SET HEADERS)
endfunction()

# coppice_test(NAME SOURCES ... LIBRARIES ...): a GoogleTest program whose cases CTest lists one by one.
function(coppice_test name)
  cmake_parse_arguments(T "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${T_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests ${PROJECT_BINARY_DIR}/tests/include)
  target_link_libraries(${name} PRIVATE ${T_LIBRARIES} GTest::gtest_main)
  coppice_warnings(${name})
  add_dependencies(unit_tests ${name})
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 120 PROPERTIES LABELS unit)
endfunction()
