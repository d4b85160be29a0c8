# shellcheck shell=bash
# Where results go: only files are replaced, and only by whole files; nothing else is touched.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

scene=$ROOT/examples/bidirectional.yaml
pull=$ROOT/tests/data/pull_pure_shear.csv
axes=(--x r_a=0:1 --y lp1=1:2 -n 3)
run=("$DEASIM" run "$scene" --set transient.stop="5 ms" --quiet -o)

# refuse CODE-2-COMMAND... with what stands at the path $1 still there, of the same kind
refuse() { # PATH KIND COMMAND...
    local path=$1 kind=$2 before
    shift 2
    before=$(stat -c '%F %i' "$path")
    expect 2 "$@"
    has err "$path: there is a $kind, which is not replaced by a file"
    [[ ! -s out && $(stat -c '%F %i' "$path") == "$before" ]]
}

# ---- directories and pipes in the place of files ----
expect 0 "${run[@]}" results
rm results/result.h5
mkdir results/result.png results/result.h5 deck
refuse results/result.png directory "$DEASIM" plot results
refuse results/result.h5 directory "${run[@]}" results
rmdir results/result.*[5g]
for name in result.csv result.raw summary.json log.txt; do
    rm -rf "results/$name"
    mkfifo "results/$name"
    refuse "results/$name" pipe timeout 20 "${run[@]}" results
    rm "results/$name"
done
refuse deck directory "$DEASIM" export "$scene" -o deck
for name in map.csv map.gnuplot map.png; do
    mkdir -p "maps/$name"
    refuse "maps/$name" directory "$DEASIM" map "${axes[@]}" -o maps
    [[ $(ls maps) == "$name" ]] # found out before anything is computed
    rmdir "maps/$name"
done
for name in fit.csv fit.gnuplot fit.png; do
    mkdir -p "fits/$name"
    refuse "fits/$name" directory "$DEASIM" fit "$pull" --lam2 2 -o fits
    rmdir "fits/$name"
done

# ---- devices: a link to one, and, where this may be tried, one of its own ----
refuse /dev/null device "$DEASIM" export "$scene" -o /dev/null
ln -s /dev/null null.cir
expect 2 "$DEASIM" export "$scene" -o null.cir
has err "null.cir: there is a device"
if ((EUID == 0)) && mknod null c 1 3 2>tried; then
    expect 0 "${run[@]}" results
    mv null results/result.png
    refuse results/result.png device "$DEASIM" plot results
    refuse results/result.png device "${run[@]}" results
fi

# ---- a deck that cannot be made does not cost the old one; a link stays one ----
printf 'mine\n' >old.cir
ln -s old.cir link.cir
printf 't\nVs s 0 1\nXd s 0 0 0 pos DEA\n.control\nrun\n.endc\n' >broken.cir
printf 'device: %s\ndrive: {netlist: broken.cir}\ntransient: {stop: 1 ms}\n' "$ROOT/models/planar_c_s5.yaml" >broken.yaml
expect 2 "$DEASIM" export broken.yaml -o old.cir
has err "broken.cir:4"
expect 3 bash -c "ulimit -f 1; '$DEASIM' export '$scene' -o link.cir"
has err "link.cir: cannot be written: File too large"
[[ $(cat old.cir) == mine && $(ls ./*.part 2>tried) == "" ]]
expect 0 "$DEASIM" export "$scene" -o link.cir
[[ -L link.cir ]]
has old.cir "written by deasim export"

# ---- answers that do not get out are no success ----
answer() {
    expect 3 bash -c '"$0" "$@" >/dev/full' "$DEASIM" "$@"
    has err "deasim $1: the answer could not be written: No space left on device"
}
answer static "$ROOT/models/planar_c_s5.yaml" --voltage 0:4kV:9
answer fit "$pull" --lam2 2
answer map "${axes[@]}" --no-picture -o maps
answer export "$scene"
answer check "$scene"
answer plot --help
