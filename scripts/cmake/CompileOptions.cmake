# Compile options of kinloop's own code. Nothing here affects projects that link kinloop.
if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
  find_program(CCACHE_PROGRAM ccache)
  if(CCACHE_PROGRAM)
    set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
  endif()
endif()

# kinloop_compile_options(TARGET): language level, warnings and sanitizers.
function(kinloop_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  # Fused multiply-add would make the same formula round differently in code compiled for different
  # instruction sets; results must not depend on which one runs.
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wconversion -Wshadow -ffp-contract=off)
  if(CMAKE_UNITY_BUILD)  # gcc attributes anonymous namespaces of included sources to a header
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  if(KINLOOP_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(KINLOOP_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${KINLOOP_SANITIZE} -fno-omit-frame-pointer
                                             -fno-sanitize-recover=all)
    target_link_options(${target} PUBLIC -fsanitize=${KINLOOP_SANITIZE})
  endif()
endfunction()
