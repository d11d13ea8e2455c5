# Compiles the GPU kernels with nvcc 12 or later from the PATH or its default installation folder. Values of COPPICE_CUDA:
#   AUTO   compile them if nvcc and a GPU are found
#   CHECK  compile them if nvcc is found; without a GPU only as a test, for one architecture and with little optimization
#   ON     always compile them, for COPPICE_CUDA_ARCHITECTURES
#   OFF    never compile them
# Sets COPPICE_HAS_CUDA. A program with kernels also runs on a machine without GPU and driver.
set(COPPICE_CUDA AUTO CACHE STRING "Compile the GPU kernels: ON, OFF, AUTO = if nvcc and a GPU are found, CHECK = if nvcc is found")
set(COPPICE_CUDA_ARCHITECTURES 75-real 80-real 90 CACHE STRING "GPU architectures to compile kernels for; later GPUs use the last one")

# coppice_find_card(VARIABLE): sets VARIABLE to true if the driver lists a GPU.
function(coppice_find_card variable)
  find_program(COPPICE_NVIDIA_SMI nvidia-smi PATHS /usr/lib/wsl/lib)
  set(cards "")
  if(COPPICE_NVIDIA_SMI)
    execute_process(COMMAND ${COPPICE_NVIDIA_SMI} -L OUTPUT_VARIABLE cards ERROR_QUIET)
  endif()
  string(REGEX MATCH "GPU 0" found "${cards}")
  set(${variable} "${found}" PARENT_SCOPE)
endfunction()

set(COPPICE_HAS_CUDA OFF)
set(quick_kernels OFF)
if(COPPICE_CUDA STREQUAL AUTO OR COPPICE_CUDA STREQUAL CHECK)
  coppice_find_card(card)
  if(NOT card AND COPPICE_CUDA STREQUAL CHECK)
    set(quick_kernels ON)
  endif()
endif()
if(COPPICE_CUDA AND (card OR NOT COPPICE_CUDA STREQUAL AUTO))
  if(NOT CMAKE_CUDA_COMPILER AND NOT DEFINED ENV{CUDACXX})
    find_program(COPPICE_NVCC nvcc PATHS /usr/local/cuda/bin)
    if(COPPICE_NVCC)
      set(CMAKE_CUDA_COMPILER ${COPPICE_NVCC})
    endif()
  endif()
  if(CMAKE_CUDA_COMPILER OR DEFINED ENV{CUDACXX} OR COPPICE_CUDA STREQUAL ON)
    set(CMAKE_CUDA_ARCHITECTURES ${COPPICE_CUDA_ARCHITECTURES})
    if(quick_kernels)
      set(CMAKE_CUDA_ARCHITECTURES 75)
    endif()
    enable_language(CUDA)
    if(CMAKE_CUDA_COMPILER_VERSION VERSION_LESS 12 AND NOT COPPICE_CUDA STREQUAL ON)
      message(STATUS "nvcc ${CMAKE_CUDA_COMPILER_VERSION} is too old for the kernels, which need 12")
    else()
      find_package(CUDAToolkit 12 REQUIRED)
      set(COPPICE_HAS_CUDA ON)
    endif()
  endif()
endif()

# coppice_cuda_sources(TARGET SOURCE...): adds kernels to a target.
function(coppice_cuda_sources target)
  target_sources(${target} PRIVATE ${ARGN})
  # CMake 3.25 does not know the C++20 option of this nvcc. Correctly rounded quotients and roots need more time than the rest of
  # the field.
  set(options -std=c++20 --expt-relaxed-constexpr -prec-div=false -prec-sqrt=false -Werror=all-warnings)
  if(quick_kernels AND CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 12.9)
    list(APPEND options --Ofast-compile=max)
  endif()
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CUDA>:${options}>")
  set_property(TARGET ${target} PROPERTY CUDA_STANDARD_REQUIRED OFF)
  target_link_libraries(${target} PRIVATE CUDA::cudart_static)
endfunction()
