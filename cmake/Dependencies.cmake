# Everything comes from Debian packages; `./dev setup` installs them. All that is missing is collected and named by its
# package at once.
set(missing_packages)

# find_pkgconfig(PREFIX module package): target PkgConfig::PREFIX. The check is made anew in every configure run, so
# that a package removed since the last one is noticed here and not by the compiler.
macro(find_pkgconfig prefix module package)
    unset(__pkg_config_checked_${prefix} CACHE)
    if(PKG_CONFIG_FOUND)
        pkg_check_modules(${prefix} QUIET IMPORTED_TARGET ${module})
    endif()
    if(NOT ${prefix}_FOUND)
        list(APPEND missing_packages ${package})
    endif()
endmacro()

find_package(PkgConfig QUIET)
if(NOT PKG_CONFIG_FOUND)
    list(APPEND missing_packages pkg-config)
endif()
find_pkgconfig(CJSON libcjson libcjson-dev)
find_pkgconfig(YAML yaml-0.1 libyaml-dev)
find_pkgconfig(CMOCKA cmocka libcmocka-dev)
find_pkgconfig(NGSPICE ngspice libngspice0-dev)
find_pkgconfig(HDF5 hdf5-serial libhdf5-dev)
find_pkgconfig(NLOPT nlopt libnlopt-dev)
find_pkgconfig(CMINPACK cminpack libcminpack-dev)

# The configuration of SUNDIALS stops by itself when KLU is not there, so KLU is looked for first.
find_path(KLU_INCLUDE klu.h PATH_SUFFIXES suitesparse NO_CACHE)
if(KLU_INCLUDE)
    find_package(SUNDIALS QUIET)
else()
    list(APPEND missing_packages libsuitesparse-dev)
endif()
if(NOT TARGET SUNDIALS::idas)
    list(APPEND missing_packages libsundials-dev)
endif()
find_path(UDUNITS_INCLUDE udunits2.h NO_CACHE)
find_library(UDUNITS_LIBRARY udunits2 NO_CACHE)
if(NOT UDUNITS_INCLUDE OR NOT UDUNITS_LIBRARY)
    list(APPEND missing_packages libudunits2-dev)
endif()
find_package(Threads REQUIRED)

# The shared HDF5 of Debian pulls in 35 more libraries (it can read from the web): loading them takes 6 of 10 ms of every
# start. Its archive leaves out what is not called.
find_library(HDF5_ARCHIVE libhdf5_serial.a NO_CACHE)
find_library(SZIP_LIBRARY sz NO_CACHE)
find_library(ZLIB_LIBRARY z NO_CACHE)
if(HDF5_ARCHIVE AND SZIP_LIBRARY AND ZLIB_LIBRARY)
    set(hdf5_libraries ${HDF5_ARCHIVE} ${SZIP_LIBRARY} ${ZLIB_LIBRARY} ${CMAKE_DL_LIBS})
else()
    set(hdf5_libraries PkgConfig::HDF5)
endif()

if(missing_packages)
    list(JOIN missing_packages " " missing_packages)
    message(FATAL_ERROR "Debian packages are missing. Install them with `./dev setup`, or by hand:\n"
        "    apt-get install ${missing_packages}\n")
endif()

add_library(deasim_dependencies INTERFACE)
target_include_directories(deasim_dependencies SYSTEM INTERFACE ${UDUNITS_INCLUDE} ${HDF5_INCLUDE_DIRS})
target_link_libraries(deasim_dependencies INTERFACE SUNDIALS::idas SUNDIALS::nvecserial SUNDIALS::sunlinsoldense
    SUNDIALS::sunlinsolklu PkgConfig::CJSON PkgConfig::YAML ${hdf5_libraries} PkgConfig::NGSPICE PkgConfig::NLOPT
    PkgConfig::CMINPACK Threads::Threads ${UDUNITS_LIBRARY} m)
