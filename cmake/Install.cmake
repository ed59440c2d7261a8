# Installing: the program with its plans and references, and the engine as a library (ourengine/).
# cpack -G DEB makes a package of the program from a finished build.
include(GNUInstallDirs)
set(brickbench_data ${CMAKE_INSTALL_DATADIR}/brickbench)
install(TARGETS brickbench RUNTIME COMPONENT brickbench)
install(DIRECTORY experiments/plans experiments/scenes DESTINATION ${brickbench_data}/experiments
        COMPONENT brickbench FILES_MATCHING PATTERN "*.toml")
install(DIRECTORY adapters/engines adapters/starter DESTINATION ${brickbench_data}/adapters
        COMPONENT brickbench)
install(DIRECTORY reference_data/baseline DESTINATION ${brickbench_data}/reference_data
        COMPONENT brickbench)
install(FILES README.md LICENSE CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT brickbench)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME brickbench)
set(CPACK_PACKAGE_CONTACT "brickbench developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL brickbench)
set(CPACK_DEBIAN_BRICKBENCH_PACKAGE_NAME brickbench)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# Which packages hold the libraries that the program is linked with.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
include(CPack)
