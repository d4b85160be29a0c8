# shellcheck shell=bash
# An installed tree is complete: the library is found by pkg-config, links, and works from another folder.
. "$ROOT/tests/cli/expect.sh"

expect 0 cmake --install "$(dirname "$DEASIM")" --prefix "$PWD/first"
test -f first/share/doc/deasim/LICENSE
expect 0 "$DEASIM" --version
mv out version
expect 0 first/bin/deasim --version
cmp version out
for folder in models netlists examples; do
    diff -r "$ROOT/$folder" "first/share/deasim/$folder"
done

# moved after the installation: deasim.pc follows
mv first second
cat >use.c <<'C'
#include <deasim/waveform.h>
#include <stdio.h>

int main(void) {
    const struct dea_waveform pulse = {.kind = DEA_WAVE_PULSE, .high = 3300, .rise = 1e-4, .fall = 1e-4, .width = 0.05};
    return printf("%g V\n", dea_waveform_value(&pulse, 5e-5)) < 0;
}
C
PKG_CONFIG_PATH=$(dirname "$(find "$PWD/second" -name deasim.pc)")
export PKG_CONFIG_PATH
expect 0 pkg-config --print-errors --exists deasim
# shellcheck disable=SC2046
expect 0 cc use.c -o use -Wl,--whole-archive $(pkg-config --cflags --libs-only-L deasim) -ldeasim -Wl,--no-whole-archive \
    $(pkg-config --libs deasim)
expect 0 ./use
has out "1650 V"
