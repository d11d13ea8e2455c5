# Enables warnings for a target of this project, as errors only if this is the top-level project.
function(coppice_warnings target)
  # Designated initialisers of option structs omit members that keep their default.
  set(options -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wpedantic -Wno-missing-field-initializers)
  if(PROJECT_IS_TOP_LEVEL)
    list(APPEND options -Werror)
  endif()
  # The host code that nvcc generates from kernels causes warnings.
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CXX>:${options}>")
endfunction()

# coppice_optimize_lightly(TARGET): compiles with -O1, in two thirds of the time; for targets that mostly call other modules or wait for
# files or the user.
function(coppice_optimize_lightly target)
  target_compile_options(${target} PRIVATE "$<$<AND:$<CONFIG:Release>,$<COMPILE_LANGUAGE:CXX>>:-O1>")
endfunction()
