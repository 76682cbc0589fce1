# cmake -DFOLDER=GENERATED -DLIST=FILE -DOUT=FILE -P sources.cmake: C++ with the checksum of the files of a list.
# Line directives and white space do not count: directives change with the prose around the code, and lines are broken and
# indented otherwise around them. So an archive, which has none, has the same checksum.
file(STRINGS ${LIST} files)
cmake_policy(VERSION 3.20)
set(sums)
foreach(file IN LISTS files)
  file(READ ${FOLDER}/${file} text)
  string(REGEX REPLACE "[ \t]*#line [^\n]*\n" "" text "${text}")
  string(REGEX REPLACE "[ \t\n]+" "" text "${text}")
  string(SHA256 sum "${text}")
  string(APPEND sums "${sum} ${file}\n")
endforeach()
string(SHA256 sum "${sums}")
string(SUBSTRING ${sum} 0 12 sum)
file(CONFIGURE OUTPUT ${OUT} CONTENT
"#include <string>
namespace malus {
std::string programSources();
std::string programSources() { return \"${sum}\"; }
}  // namespace malus
" @ONLY)
