# The kernels for graphics cards. COPPICE_CUDA is ON, OFF, or AUTO: where nvcc 12 or later is found, in the PATH or where its own
# installer puts it. Sets COPPICE_HAS_CUDA. A program with kernels also runs where there is no card and no driver.
set(COPPICE_CUDA AUTO CACHE STRING "Build the kernels for graphics cards (needs nvcc): ON, OFF, or AUTO = where nvcc is found")
set(COPPICE_CUDA_ARCHITECTURES 75-real 80-real 90 CACHE STRING "Cards to compile kernels for; later ones take the last")

set(COPPICE_HAS_CUDA OFF)
if(COPPICE_CUDA)
  if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
    find_program(COPPICE_NVCC nvcc PATHS /usr/local/cuda/bin)
    if(COPPICE_NVCC)
      set(CMAKE_CUDA_COMPILER ${COPPICE_NVCC})
    endif()
  endif()
  if(CMAKE_CUDA_COMPILER OR DEFINED ENV{CUDACXX} OR COPPICE_CUDA STREQUAL ON)
    set(CMAKE_CUDA_ARCHITECTURES ${COPPICE_CUDA_ARCHITECTURES})
    enable_language(CUDA)
    if(CMAKE_CUDA_COMPILER_VERSION VERSION_LESS 12 AND COPPICE_CUDA STREQUAL AUTO)
      message(STATUS "nvcc ${CMAKE_CUDA_COMPILER_VERSION} is too old for the kernels, which need 12")
    else()
      find_package(CUDAToolkit 12 REQUIRED)
      set(COPPICE_HAS_CUDA ON)
    endif()
  endif()
endif()

# coppice_cuda_sources(TARGET SOURCE...): kernels that belong to a target.
function(coppice_cuda_sources target)
  target_sources(${target} PRIVATE ${ARGN})
  # CMake 3.25 does not know how this nvcc is asked for C++20. Quotients and roots that are right to the last bit cost more than
  # the field does.
  set(options -std=c++20 --expt-relaxed-constexpr -prec-div=false -prec-sqrt=false -Werror=all-warnings)
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CUDA>:${options}>")
  set_property(TARGET ${target} PROPERTY CUDA_STANDARD_REQUIRED OFF)
  target_link_libraries(${target} PRIVATE CUDA::cudart_static)
endfunction()
