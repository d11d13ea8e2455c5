# Warnings for our own targets; errors only when this is the top-level project.
function(coppice_warnings target)
  # Option structs are made by designated initialisers that leave out what stays at its default.
  set(options -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wpedantic -Wno-missing-field-initializers)
  if(PROJECT_IS_TOP_LEVEL)
    list(APPEND options -Werror)
  endif()
  # What nvcc makes of kernels for the compiler of the host has no manners.
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${options}>")
endfunction()

# coppice_optimize_lightly(TARGET): for what spends its time in other modules, in files or in the user; compiles in two thirds of the time.
function(coppice_optimize_lightly target)
  target_compile_options(${target} PRIVATE "$<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-O1>")
endfunction()
