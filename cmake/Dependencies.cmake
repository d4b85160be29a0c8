# Everything comes from Debian packages; `./dev setup` installs them.
find_package(PkgConfig REQUIRED)
find_package(SUNDIALS REQUIRED)
pkg_check_modules(CJSON REQUIRED IMPORTED_TARGET libcjson)
pkg_check_modules(YAML REQUIRED IMPORTED_TARGET yaml-0.1)
pkg_check_modules(CMOCKA REQUIRED IMPORTED_TARGET cmocka)
pkg_check_modules(NGSPICE REQUIRED IMPORTED_TARGET ngspice)
pkg_check_modules(HDF5 REQUIRED IMPORTED_TARGET hdf5-serial)
find_path(UDUNITS_INCLUDE udunits2.h REQUIRED)
find_library(UDUNITS_LIBRARY udunits2 REQUIRED)

add_library(deasim_dependencies INTERFACE)
target_include_directories(deasim_dependencies SYSTEM INTERFACE ${UDUNITS_INCLUDE})
target_link_libraries(deasim_dependencies INTERFACE SUNDIALS::idas SUNDIALS::nvecserial SUNDIALS::sunlinsoldense
    SUNDIALS::sunlinsolklu PkgConfig::CJSON PkgConfig::YAML PkgConfig::HDF5 PkgConfig::NGSPICE ${UDUNITS_LIBRARY} m)
