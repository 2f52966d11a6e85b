# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # they set and use what is here
# Sourced by the scripts of this folder that hold inlay against path-traced truth: spot in real
# panoramas. They set $work, the folder that all is left in; $quick where they speak TAP.
build=${BUILD:?is not set: expected the folder that holds inlay and inlay-bake}
data=${INLAY_SHARED_DATA:-../shared/data}

# Name, file, and the exposure at which a white ground has radiance 0.6.
panoramas="museum st_fagans_interior_1k 0.585
sunset venice_sunset_1k 0.856
studio studio_small_03_1k 0.136"

# Prints what is wrong where it will be read, and ends.
fail() {
	if [ "${quick:-}" ]; then
		echo "not ok - $1"
		sed 's/^/# /' "$log" | tail -n 20
	else
		echo "${0##*/}: $1" >&2
		tail -n 20 "$log" >&2
	fi
	exit 1
}

prepare() {
	log=$work/log.txt
	mkdir -p "$work"
	: >"$log"
	cp tests/accuracy/spot.scene "$work/spot.scene"
	ln -sfn "$(realpath "$data/mesh/spot.obj")" "$work/spot.obj"
}

# bake NAME [OPTION...]: fNAME.inlay, NAME being its frequency, or beginning with that and a colon
bake() {
	local f=$1
	shift
	"$build/inlay-bake" render --no-preview --frequency "${f%%:*}" "$@" \
		-o "$work/f$f.inlay" "$work/spot.scene" \
		>>"$log" 2>&1 || [ $? -eq 3 ] || fail "inlay-bake render --frequency $f failed"
}

# trace NAME FILE EXPOSURE [OPTION...]: NAME-truth.pfm, NAME-background.png, NAME-fisheye.pfm
trace() {
	local name=$1 file=$2 exposure=$3
	shift 3
	"$build/inlay-bake" truth --panorama "$data/hdri/$file.hdr" --exposure "$exposure" "$@" \
		--background-out "$work/$name-background.png" \
		--fisheye-out "$work/$name-fisheye.pfm" \
		-o "$work/$name-truth.pfm" "$work/spot.scene" \
		>>"$log" 2>&1 || fail "inlay-bake truth in $file failed"
}

# composite NAME BAKE OUT [OPTION...]
composite() {
	local name=$1 f=$2 out=$3
	shift 3
	"$build/inlay" still --basis "$work/f$f.inlay" --background "$work/$name-background.png" \
		--fisheye "$work/$name-fisheye.pfm" "$@" \
		-o "$out" >>"$log" 2>&1 || fail "inlay still with f=$f in $name failed"
}

compare() {
	"$build/tests/accuracy/compare" "$@" 2>>"$log" || fail "compare $* failed"
}
