# Warnings for our own targets; errors only when this is the top-level project.
function(coppice_warnings target)
  # Option structs are made by designated initialisers that leave out what stays at its default.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Wpedantic
                                           -Wno-missing-field-initializers)
  if(PROJECT_IS_TOP_LEVEL)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
