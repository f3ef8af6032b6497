# Writes OUTPUT, the source of build_info(), at every build; it changes only when the revision or the flags do.
execute_process(COMMAND git describe --always --dirty
  WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT revision)
  set(revision unknown)
endif()
configure_file(${SOURCE_DIR}/common/build_info.cpp.in ${OUTPUT} @ONLY)
