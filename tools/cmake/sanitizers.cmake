# Sanitizers must see every object file and the link, so they are set for the whole directory tree.
if(VDB_OFFSET_SANITIZE)
  add_compile_options(-fsanitize=${VDB_OFFSET_SANITIZE} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${VDB_OFFSET_SANITIZE})
endif()

# Run-time options of the sanitizers, for the environment of every test.
set(support ${CMAKE_CURRENT_SOURCE_DIR}/tests/support)
set(VDB_OFFSET_SANITIZER_ENVIRONMENT
  "VDB_OFFSET_SANITIZED=${VDB_OFFSET_SANITIZE}"
  "ASAN_OPTIONS=detect_leaks=1:strict_string_checks=1:detect_stack_use_after_return=1"
  "LSAN_OPTIONS=suppressions=${support}/lsan.supp:print_suppressions=0"
  "UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1:suppressions=${support}/ubsan.supp"
  "TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1:suppressions=${support}/tsan.supp")

# vdb_offset_sanitizer_support(target): what a library needs to be judged fairly.
function(vdb_offset_sanitizer_support target)
  if(VDB_OFFSET_SANITIZE MATCHES "thread")
    target_sources(${target} PRIVATE
      ${PROJECT_SOURCE_DIR}/tests/support/sanitizers/tbb_happens_before.cc)
    target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS})
  endif()
endfunction()
