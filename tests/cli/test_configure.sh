# shellcheck shell=bash
# A configure run names all missing Debian packages at once, the first time as well as in a tree that had them before.
. "$ROOT/tests/cli/expect.sh"

expect 1 env PKG_CONFIG_LIBDIR=/nonexistent cmake -S "$ROOT" -B fresh -G Ninja
has err "Install them with \`./dev setup\`"
has err "libcjson-dev libyaml-dev libcmocka-dev libngspice0-dev libhdf5-dev libnlopt-dev"

expect 0 cmake -S "$ROOT" -B used -G Ninja
expect 1 env PKG_CONFIG_LIBDIR=/nonexistent cmake -S "$ROOT" -B used -G Ninja
has err "libcjson-dev"
expect 0 cmake -S "$ROOT" -B used -G Ninja

expect 1 cmake -S "$ROOT" -B no_sundials -G Ninja -DCMAKE_DISABLE_FIND_PACKAGE_SUNDIALS=ON
has err "apt-get install libsundials-dev"

# every package that can be asked for is one that setup installs
for package in $(grep -oE 'lib[a-z0-9.+-]+-dev' "$ROOT/cmake/Dependencies.cmake"); do
    has "$ROOT/cmake/packages.txt" "$package"
done
