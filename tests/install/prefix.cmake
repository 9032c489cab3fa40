# cmake -DBUILD=folder -DPREFIX=folder -P prefix.cmake: installs afresh, so that nothing old is found.
file(REMOVE_RECURSE ${PREFIX})
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX} COMMAND_ERROR_IS_FATAL ANY)
