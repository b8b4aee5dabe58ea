# Language level, warnings, sanitizers and the compiler cache: what every target of the project shares.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

add_compile_options(-Wall -Wextra -Wconversion -Wshadow)
if(KINLOOP_WERROR)
  add_compile_options(-Werror)
endif()

# Fused multiply-add would make the same formula round differently in code compiled for different instruction
# sets; results must not depend on which one runs.
add_compile_options(-ffp-contract=off)

if(KINLOOP_SANITIZE)
  add_compile_options(-fsanitize=${KINLOOP_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${KINLOOP_SANITIZE})
endif()
