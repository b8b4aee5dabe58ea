# The two pages (viewer/pages): the live viewer and the run report, each built by npm into one HTML file that
# is embedded in the program. If npm is missing or cannot fetch its packages, the plain pages of
# viewer/pages/plain replace them: everything else works, and `kinloop --version` reports it.
# Sets KINLOOP_PAGES (the folder of viewer.html and report.html), KINLOOP_PAGES_FOUND, target kinloop_pages.
set(KINLOOP_PAGES_SOURCE ${PROJECT_SOURCE_DIR}/viewer/pages)
set(KINLOOP_PAGES ${PROJECT_BINARY_DIR}/pages)
set(KINLOOP_PAGES_FOUND 0)
find_program(NODE_PROGRAM NAMES node nodejs)
find_program(NPM_PROGRAM npm)

# The packages of package-lock.json are fetched once, and again when that file changes.
if(NPM_PROGRAM AND NODE_PROGRAM AND NOT KINLOOP_MINIMAL AND NOT "pages" IN_LIST KINLOOP_WITHOUT)
  set(installed ${KINLOOP_PAGES_SOURCE}/node_modules/.package-lock.json)
  set(KINLOOP_PAGES_FOUND 1)
  if(NOT EXISTS ${installed} OR ${KINLOOP_PAGES_SOURCE}/package-lock.json IS_NEWER_THAN ${installed})
    message(STATUS "Fetching what the viewer and report pages are built with (npm ci)")
    execute_process(COMMAND ${NPM_PROGRAM} ci --no-audit --no-fund --loglevel=error
                    WORKING_DIRECTORY ${KINLOOP_PAGES_SOURCE} RESULT_VARIABLE failed OUTPUT_QUIET)
    if(failed)
      message(WARNING "npm ci failed in ${KINLOOP_PAGES_SOURCE}: the viewer and report pages are off in this build")
      set(KINLOOP_PAGES_FOUND 0)
    endif()
  endif()
endif()

if(KINLOOP_PAGES_FOUND)
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
    configure_file(${KINLOOP_PAGES_SOURCE}/plain/${page}.html ${KINLOOP_PAGES}/${page}.html COPYONLY)
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
