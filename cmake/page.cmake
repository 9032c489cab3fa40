# The page of --html: its scripts are bundled by esbuild, which scripts/setup fetches with the
# libraries that they use (framework/page/package.json), into one template, which becomes part of
# the library. Without esbuild the library is built all the same, and --html says how to get it.
file(GLOB esbuild CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/framework/page/node_modules/@esbuild/*/bin/esbuild)
file(GLOB page_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/framework/page/*.js ${PROJECT_SOURCE_DIR}/framework/page/*.css
                                         ${PROJECT_SOURCE_DIR}/framework/page/*.html)
set(page_folder ${PROJECT_BINARY_DIR}/page)
set(page_template ${page_folder}/template.cpp)
set(embed ${CMAKE_COMMAND} -DFOLDER=${page_folder} -DTEMPLATE=${PROJECT_SOURCE_DIR}/framework/page/page.html
          -P ${CMAKE_CURRENT_LIST_DIR}/embed_page.cmake)
if(esbuild)
  add_custom_command(
    OUTPUT ${page_template}
    COMMAND ${esbuild} ${PROJECT_SOURCE_DIR}/framework/page/main.js --bundle --minify --format=iife --target=es2020
            --legal-comments=none --log-level=warning --outfile=${page_folder}/page.js
    COMMAND ${embed}
    DEPENDS ${page_sources} ${PROJECT_SOURCE_DIR}/framework/page/package-lock.json ${CMAKE_CURRENT_LIST_DIR}/embed_page.cmake
    COMMENT "Bundling the page" VERBATIM)
else()
  file(WRITE ${page_template} "#include \"framework/page/template.h\"\n
namespace talus {\nconst std::string_view page_template;\n}  // namespace talus\n")
endif()
target_sources(talus PRIVATE ${page_template})
