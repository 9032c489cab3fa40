# talus_add_plugin(NAME SOURCE): a plugin library NAME.so from one source file with TALUS_PLUGIN(...).
function(talus_add_plugin name source)
  add_library(${name} MODULE ${source})
  target_link_libraries(${name} PRIVATE talus::talus)
  target_compile_definitions(${name} PRIVATE TALUS_PLUGIN_LIBRARY)
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX ".so" CXX_VISIBILITY_PRESET hidden
                        VISIBILITY_INLINES_HIDDEN ON)
endfunction()
