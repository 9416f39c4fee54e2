# With CMAKE_UNITY_BUILD, source files are compiled several at a time, so that headers are read, and what they define inline
# is compiled, once for all of them. Off, as when one works on the code, each file is compiled by itself.

# Puts those files of a target whose paths begin so, from the folder of its CMakeLists.txt, and which have no group yet,
# into so many groups. A file's group follows from its name alone: a new file moves no other. In a group, anonymous
# namespaces are one: where the names of two files clash, rename.
function(set_unity_groups target prefix count)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  string(MAKE_C_IDENTIFIER "${prefix}" name)
  get_target_property(files ${target} SOURCES)
  foreach(file IN LISTS files)
    get_source_file_property(known ${file} UNITY_GROUP)
    cmake_path(ABSOLUTE_PATH file OUTPUT_VARIABLE absolute)
    cmake_path(RELATIVE_PATH absolute BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE path)
    string(FIND ${path} "${prefix}" at)
    if(NOT known AND at EQUAL 0)
      string(MD5 hash ${path})
      string(SUBSTRING ${hash} 0 7 digits)
      math(EXPR group "0x${digits} % ${count}")
      set_source_files_properties(${file} PROPERTIES UNITY_GROUP ${name}${group})
    endif()
  endforeach()
endfunction()
