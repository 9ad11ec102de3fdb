# report/page/page.html with the style and the scripts that it names inside, cut where its figures go, as text in a header
# of report: the program writes pages wherever it runs.
set(folder ${CMAKE_CURRENT_LIST_DIR}/../report/page)
file(GLOB parts CONFIGURE_DEPENDS ${folder}/*)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${parts})
file(READ ${folder}/page.html page)
foreach(part ${parts})
  cmake_path(GET part FILENAME name)
  file(READ ${part} text)
  string(REPLACE "<link rel=\"stylesheet\" href=\"${name}\" />" "<style>\n${text}</style>" page "${page}")
  string(REPLACE "<script src=\"${name}\"></script>" "<script>\n${text}</script>" page "${page}")
endforeach()
string(REPLACE "id=\"contents\">" "id=\"contents\">)html\", R\"html(" page "${page}")
file(CONFIGURE OUTPUT ${BODYOPT_GENERATED}/report/page_html.h @ONLY CONTENT "// Made by cmake/Page.cmake.
#pragma once

namespace bodyopt::report {

constexpr const char* kPageHtml[] = {R\"html(${page})html\"};

}  // namespace bodyopt::report
")
target_include_directories(bodyopt_report PRIVATE ${BODYOPT_GENERATED})
