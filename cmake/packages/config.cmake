# Read by cpack itself: one date for every file, so that two runs give equal bytes. It is the last commit's; a tree
# without history has the date of its change log.
if(NOT DEFINED ENV{SOURCE_DATE_EPOCH})
  execute_process(COMMAND git -C ${CPACK_UNDERBODY_SOURCE} log -1 --format=%ct
    OUTPUT_VARIABLE date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT date)
    file(TIMESTAMP ${CPACK_UNDERBODY_SOURCE}/CHANGELOG.md date %s UTC)
  endif()
  set(ENV{SOURCE_DATE_EPOCH} ${date})
endif()
