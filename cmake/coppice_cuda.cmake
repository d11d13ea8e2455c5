# The kernels for graphics cards, which nvcc 12 or later compiles, found in the PATH or where its own installer puts it. COPPICE_CUDA is
#   AUTO   where nvcc and a card are found
#   CHECK  where nvcc is found; without a card, kernels are only tested to compile, for one kind of card and hardly optimized
#   ON     always, for COPPICE_CUDA_ARCHITECTURES
#   OFF    never
# Sets COPPICE_HAS_CUDA. A program with kernels also runs where there is no card and no driver.
set(COPPICE_CUDA AUTO CACHE STRING "Compile the kernels for graphics cards: ON, OFF, AUTO = where nvcc and a card are found, CHECK = where nvcc is found")
set(COPPICE_CUDA_ARCHITECTURES 75-real 80-real 90 CACHE STRING "Cards to compile kernels for; later ones take the last")

# coppice_find_card(VARIABLE): whether the driver lists a card.
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

# coppice_cuda_sources(TARGET SOURCE...): kernels that belong to a target.
function(coppice_cuda_sources target)
  target_sources(${target} PRIVATE ${ARGN})
  # CMake 3.25 does not know how this nvcc is asked for C++20. Quotients and roots that are right to the last bit cost more than
  # the field does.
  set(options -std=c++20 --expt-relaxed-constexpr -prec-div=false -prec-sqrt=false -Werror=all-warnings)
  if(quick_kernels AND CMAKE_CUDA_COMPILER_VERSION VERSION_GREATER_EQUAL 12.9)
    list(APPEND options --Ofast-compile=max)
  endif()
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANGUAGE:CUDA>:${options}>")
  set_property(TARGET ${target} PROPERTY CUDA_STANDARD_REQUIRED OFF)
  target_link_libraries(${target} PRIVATE CUDA::cudart_static)
endfunction()
