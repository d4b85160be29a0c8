# shellcheck shell=bash
# docs/scenes.md is true: its examples are read, and every key the program allows is described.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"
page=$ROOT/docs/scenes.md

for name in scene device material; do
    awk -v first="# $name.yaml" '/^```/ { inside = 0; fresh = /yaml/; next } fresh { inside = $0 == first; fresh = 0 } inside' \
        "$page" >$name.yaml
    [[ -s $name.yaml ]] || { echo "no example of $name.yaml in $page"; exit 1; }
done
expect 0 "$DEASIM" check scene.yaml
expect 0 "$DEASIM" run scene.yaml --json -o run
jq -e '.status == "done"' out >tested

# the keys of a mapping, as a refusal lists them
documented=0
allowed() { # KEY: the mapping
    local key
    expect 2 "$DEASIM" check scene.yaml --set "$1${1:+.}nosuchkey=1"
    for key in $(sed -nE 's/.*allowed: (.*)$/\1/p' err | head -n 1 | tr -d ,); do
        has "$page" "\`$key\`"
        documented=$((documented + 1))
    done
}
for mapping in '' drive drive.left drive.left.amplifier transient initial events output expect.0 device device.geometry \
    device.zones device.zones.left device.zones.left.electrode device.platform device.options device.material \
    device.material.elastic device.material.branches.0 device.material.dielectric device.material.dielectric.breakdown; do
    allowed "$mapping"
done
for type in dc pulse trapezoid pwl sine chirp file; do
    expect 2 "$DEASIM" check scene.yaml --set "drive.left.waveform={type: $type, nosuchkey: 1}"
    for key in $(sed -nE 's/.*allowed: (.*)$/\1/p' err | head -n 1 | tr -d ,); do
        grep -E "^\| \`$type\` \|" "$page" >line || grep -F '| type |' "$page" >line
        [[ $key == type ]] || has line "\`$key\`"
        documented=$((documented + 1))
    done
done
for law in gent neo_hookean yeoh ogden arruda_boyce; do
    expect 2 "$DEASIM" check scene.yaml --set "device.material.elastic={law: $law, nosuchkey: 1}"
    grep -E "^\| \`$law\` \|" "$page" >line
    for key in $(sed -nE 's/.*allowed: (.*)$/\1/p' err | head -n 1 | tr -d ,); do
        [[ $key == law ]] || has line "\`$key\`"
        documented=$((documented + 1))
    done
done
((documented > 100)) || { echo "only $documented keys were found"; exit 1; }

# the keys of the summary
for key in $(jq -r 'keys[], (.energy | keys[]), (.coupling | keys[]), (.stats | keys[]), (.signals.x | keys[])' run/summary.json); do
    has "$page" "\`$key\`"
done
for signal in $(jq -r '.signals | keys[]' run/summary.json); do
    grep -qF "\`$signal\`" "$page" || has "$page" "\`.${signal#*.}\`"
done
