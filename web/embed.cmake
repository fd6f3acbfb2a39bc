# SPDX-License-Identifier: Apache-2.0
# cmake -DASSETS="a;b" -DFOLDER=DIR -DOUTPUT=F.cpp -P embed.cmake: writes the files as a C++ table. Names are relative to
# the folder; of files elsewhere, without theirs.
set(arrays "")
set(rows "")
set(index 0)
foreach(asset ${ASSETS})
  file(READ ${asset} hex HEX)
  file(SHA256 ${asset} hash)
  file(RELATIVE_PATH name ${FOLDER} ${asset})
  if(name MATCHES "^\\.\\.")
    get_filename_component(name ${asset} NAME)
  endif()
  get_filename_component(extension ${asset} LAST_EXT)
  if(extension STREQUAL ".html")
    set(type "text/html; charset=utf-8")
  elseif(extension STREQUAL ".css")
    set(type "text/css; charset=utf-8")
  elseif(extension STREQUAL ".js")
    set(type "text/javascript; charset=utf-8")
  else()
    set(type "image/svg+xml")
  endif()
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  string(APPEND arrays "constexpr unsigned char kFile${index}[] = {${bytes}0};\n")
  string(APPEND rows "    {\"${name}\", \"${type}\", \"${hash}\", Text(kFile${index}, sizeof kFile${index} - 1)},\n")
  math(EXPR index "${index} + 1")
endforeach()

file(WRITE ${OUTPUT} "#include \"web/assets.h\"

namespace floorloc {
namespace {

${arrays}
std::string_view Text(const unsigned char* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace

const std::vector<WebAsset>& AllWebAssets() {
  static const std::vector<WebAsset> assets = {
${rows}  };
  return assets;
}

}  // namespace floorloc
")
