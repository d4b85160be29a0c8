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

# Every shared library costs each start of the program: 0.05 ms for a small one, 6 ms for the shared HDF5, which pulls in 35
# more (it can read from the web). An archive leaves out what is not called and is relocated with the program.
set(archives sundials_idas sundials_nvecserial sundials_sunlinsoldense sundials_sunmatrixdense sundials_sunlinsolklu
    sundials_sunmatrixsparse sundials_generic klu amd colamd btf suitesparseconfig hdf5_serial sz aec z yaml udunits2 expat)
set(linked_archives)
foreach(archive IN LISTS archives)
    find_library(${archive}_ARCHIVE lib${archive}.a NO_CACHE)
    if(${archive}_ARCHIVE)
        list(APPEND linked_archives ${${archive}_ARCHIVE})
    endif()
endforeach()
list(LENGTH archives wanted)
list(LENGTH linked_archives found)
if(wanted EQUAL found)
    set(solver_libraries ${linked_archives})
else()
    set(solver_libraries SUNDIALS::idas SUNDIALS::nvecserial SUNDIALS::sunlinsoldense SUNDIALS::sunlinsolklu
        PkgConfig::YAML PkgConfig::HDF5 ${UDUNITS_LIBRARY})
endif()

if(missing_packages)
    list(JOIN missing_packages " " missing_packages)
    message(FATAL_ERROR "Debian packages are missing. Install them with `./dev setup`, or by hand:\n"
        "    apt-get install ${missing_packages}\n")
endif()

# ngspice, NLopt and cminpack are not linked: base/library.c loads them when a netlist, a search or a fit needs them.
add_library(deasim_dependencies INTERFACE)
target_include_directories(deasim_dependencies SYSTEM INTERFACE ${UDUNITS_INCLUDE} ${HDF5_INCLUDE_DIRS} ${YAML_INCLUDE_DIRS}
    ${KLU_INCLUDE} ${NGSPICE_INCLUDE_DIRS} ${NLOPT_INCLUDE_DIRS} ${CMINPACK_INCLUDE_DIRS})
target_link_libraries(deasim_dependencies INTERFACE ${solver_libraries} PkgConfig::CJSON Threads::Threads ${CMAKE_DL_LIBS} m)
