# What `cmake --install --component program` gives: the program, the rigs, and completion for bash.
install(TARGETS bodyopt COMPONENT program)
install(DIRECTORY rigs COMPONENT program DESTINATION ${CMAKE_INSTALL_DATADIR}/bodyopt)
install(FILES cli/completion.bash COMPONENT program DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME bodyopt)
