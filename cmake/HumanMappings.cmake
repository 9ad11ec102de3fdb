# bodyopt_human_files(FOLDER HEADER NAMESPACE CONSTANT=FILE...): files of rigs/human as text in a header of a room, so
# that the program knows them wherever it runs.
function(bodyopt_human_files FOLDER HEADER NAMESPACE)
  set(text "// Made by cmake/HumanMappings.cmake.\n#pragma once\n\nnamespace ${NAMESPACE} {\n")
  foreach(pair ${ARGN})
    string(REPLACE "=" ";" pair ${pair})
    list(GET pair 0 constant)
    list(GET pair 1 file)
    set(file ${PROJECT_SOURCE_DIR}/rigs/human/${file}.json)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} json)
    string(APPEND text "\nconstexpr const char* ${constant} = R\"json(${json})json\";\n")
  endforeach()
  string(APPEND text "\n}  // namespace ${NAMESPACE}\n")
  file(CONFIGURE OUTPUT ${BODYOPT_GENERATED}/${FOLDER}/${HEADER} CONTENT "${text}" @ONLY)
  bodyopt_target(${FOLDER} target)
  target_include_directories(${target} PRIVATE ${BODYOPT_GENERATED})
endfunction()

bodyopt_human_files(trainer/muscle_models human_mappings.h bodyopt::trainer::muscle_models
                    kGait2392Mapping=gait2392 kMyoArmMapping=myo_arm)
