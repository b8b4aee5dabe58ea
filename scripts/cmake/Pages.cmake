# The two pages (viewer/pages): the live viewer and the run report, each built by npm into one HTML file that
# is embedded in the program. An archive of sources has them built (scripts/build_source_archive.sh). If npm is missing or
# cannot fetch its packages, the plain pages of viewer/pages/plain replace them: everything else works, and
# `kinloop --version` reports it.
# Sets KINLOOP_PAGES (the folder of viewer.html and report.html), KINLOOP_PAGES_FOUND, target kinloop_pages.
set(KINLOOP_PAGES_SOURCE ${PROJECT_SOURCE_DIR}/viewer/pages)
set(KINLOOP_PAGES ${PROJECT_BINARY_DIR}/pages)
find_program(NODE_PROGRAM NAMES node nodejs)
find_program(NPM_PROGRAM npm)
set(npm ${NPM_PROGRAM})
if(NOT npm AND EXISTS ${PROJECT_SOURCE_DIR}/build/npm/fetched)  # by scripts/install_npm.sh
  set(npm ${NODE_PROGRAM} ${PROJECT_SOURCE_DIR}/build/npm/bin/npm-cli.js)
endif()

# Where the pages are, or nothing if they are to be built.
set(ready_pages ${KINLOOP_PAGES_SOURCE}/plain)
if(KINLOOP_MINIMAL OR "pages" IN_LIST KINLOOP_WITHOUT)
  # plain ones
elseif(EXISTS ${KINLOOP_PAGES_SOURCE}/built/report.html)
  set(ready_pages ${KINLOOP_PAGES_SOURCE}/built)
elseif(npm AND NODE_PROGRAM)
  # The packages of package-lock.json are fetched once, and again when that file changes.
  set(installed ${KINLOOP_PAGES_SOURCE}/node_modules/.package-lock.json)
  set(failed 0)
  if(NOT EXISTS ${installed} OR ${KINLOOP_PAGES_SOURCE}/package-lock.json IS_NEWER_THAN ${installed})
    message(STATUS "Fetching what the viewer and report pages are built with (npm ci)")
    execute_process(COMMAND ${npm} ci --no-audit --no-fund --no-update-notifier --loglevel=error
                    WORKING_DIRECTORY ${KINLOOP_PAGES_SOURCE} RESULT_VARIABLE failed OUTPUT_QUIET)
  endif()
  if(failed)
    message(WARNING "npm ci failed in ${KINLOOP_PAGES_SOURCE}: the viewer and report pages are off in this build")
  else()
    set(ready_pages)
  endif()
endif()
set(KINLOOP_PAGES_FOUND 1)
if(ready_pages STREQUAL ${KINLOOP_PAGES_SOURCE}/plain)
  set(KINLOOP_PAGES_FOUND 0)
endif()
set(KINLOOP_PAGES_FOUND ${KINLOOP_PAGES_FOUND} CACHE INTERNAL "For scripts/build_source_archive.sh")

if(NOT ready_pages)
  file(GLOB_RECURSE pages_files CONFIGURE_DEPENDS ${KINLOOP_PAGES_SOURCE}/src/*)
  foreach(page viewer report)
    add_custom_command(
      OUTPUT ${KINLOOP_PAGES}/${page}.html
      COMMAND ${NODE_PROGRAM} node_modules/vite/bin/vite.js build --mode ${page} --outDir ${KINLOOP_PAGES}
              --logLevel warn
      WORKING_DIRECTORY ${KINLOOP_PAGES_SOURCE}
      DEPENDS ${pages_files} ${KINLOOP_PAGES_SOURCE}/${page}.html ${KINLOOP_PAGES_SOURCE}/vite.config.js
              ${KINLOOP_PAGES_SOURCE}/package-lock.json
      COMMENT "Building the ${page} page"
      VERBATIM)
  endforeach()
else()
  foreach(page viewer report)
    configure_file(${ready_pages}/${page}.html ${KINLOOP_PAGES}/${page}.html COPYONLY)
  endforeach()
endif()
add_custom_target(kinloop_pages DEPENDS ${KINLOOP_PAGES}/viewer.html ${KINLOOP_PAGES}/report.html)
message(STATUS "kinloop optional part pages: ${KINLOOP_PAGES_FOUND}")

# kinloop_embed_page(TARGET SOURCE PAGE): the source embeds the page as KINLOOP_PAGE.
function(kinloop_embed_page target source page)
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS ${KINLOOP_PAGES}/${page}.html
                                                   COMPILE_DEFINITIONS KINLOOP_PAGE="${KINLOOP_PAGES}/${page}.html")
  add_dependencies(${target} kinloop_pages)
endfunction()
