#!/bin/bash
# SPDX-License-Identifier: MIT
# Meshes that have no end, or ask for far more than they hold: each is refused in one sentence that names the
# file, in little time and memory.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

# mesh FILE: a scene of it, in its own materials.
mesh() {
	sed -e "s|^file = .*|file = $1|" -e '/^\[material/,$d' "$work/box.scene" >"$work/$1.scene"
}
# bomb FILE WORDS [NAME]: is refused with WORDS, by the name of FILE or NAME.
bomb() {
	mesh "$1"
	refused "$1" 1 "${3:-$1}: $2" timeout 120 bash -c 'ulimit -t 10 -v 4000000; exec "$@"' bash \
		"$INLAY_BAKE" render "$work/$1.scene" -o "$work/none.inlay"
}
# repeat COUNT TEXT
repeat() {
	printf "$2%.0s" $(seq "$1")
}
# number32 N...: each as four bytes, the least first.
number32() {
	local n
	for n in "$@"; do
		printf '%b' "$(printf '\\x%02x\\x%02x\\x%02x\\x%02x' $((n & 255)) $((n >> 8 & 255)) \
			$((n >> 16 & 255)) $((n >> 24 & 255)))"
	done
}
cd "$work" || exit 1

# ---- no plain files ----
mkfifo pipe.obj pipe.ply pipe.mtl pipe.png
ln -s /dev/zero zero.obj
ln -s /dev/zero zero.mtl
for file in pipe.obj pipe.ply zero.obj; do
	bomb $file "not a regular file"
done
for kind in pipe zero; do
	{
		echo "mtllib $kind.mtl"
		cat box.obj
	} >$kind-library.obj
	bomb $kind-library.obj "not a regular file" $kind.mtl
done
printf 'newmtl paint\nKd 1 1 1\nmap_Kd pipe.png\n' >paint.mtl
{
	printf 'mtllib paint.mtl\nusemtl paint\nvt 0 0\n'
	sed 's|\([0-9]\)\( \|$\)|\1/1\2|g; /^v/s|/1||g' box.obj
} >texture.obj
bomb texture.obj "not a regular file" pipe.png

# ---- longer than any ----
truncate -s 5G long.obj
bomb long.obj "more than 4294967296 bytes long"
truncate -s 5G long.mtl
{
	echo "mtllib long.mtl"
	cat box.obj
} >long-library.obj
bomb long-library.obj "more than 67108864 bytes long" long.mtl

# ---- numbers and depths that are not meant ----
deep=$(repeat 200000 '[')
echo "{\"asset\":{\"version\":\"2.0\"},\"extras\":$deep" >deep.gltf
bomb deep.gltf "JSON nested more than"
echo "$deep" >brackets.gltf
bomb brackets.gltf "JSON nested more than"
cp deep.gltf deep.mesh
bomb deep.mesh "JSON nested more than"
{
	printf 'glTF'
	number32 2 $((20 + $(stat -c %s deep.gltf))) "$(stat -c %s deep.gltf)"
	printf 'JSON'
	cat deep.gltf
} >deep.glb
bomb deep.glb "JSON nested more than"
{
	printf 'glTF'
	number32 2 0xffffffff 0xfffffff0
	printf 'JSON{}'
} >header.glb
bomb header.glb "its header says that it has 4294967295 bytes, but there are 22"
{
	printf 'glTF'
	number32 2 22 0xfffffff0
	printf 'JSON{}'
} >chunk.glb
bomb chunk.glb "its chunk says that it has 4294967280 bytes, but there are 2"
{
	printf 'glTF'
	number32 1 22 0xfffffff0 0
	printf '{}'
} >older.glb
bomb older.glb "a GLB of version 1, expected 2"
# accessor NAME WORDS JSON: one, of positions.
accessor() {
	printf '{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":%s' \
		'{"POSITION":0}}]}],"buffers":[{"byteLength":12,"uri":"data:,abcdefghijkl"}],' >"$1"
	echo "$3}" >>"$1"
	bomb "$1" "$2"
}
accessor zeros.gltf "/accessors/0/count: 4000000000" \
	'"accessors":[{"componentType":5126,"type":"VEC3","count":4000000000}]'
accessor beyond.gltf "/accessors/0: 90000000 elements from byte 0 end after bufferView 0" \
	'"bufferViews":[{"buffer":0,"byteLength":12}],"accessors":[{"bufferView":0,
	"componentType":5126,"type":"VEC3","count":90000000}]'
accessor packed.gltf "it would take 960 MB of memory, expected at most 269 MB" \
	'"bufferViews":[{"buffer":0,"byteLength":12,"extensions":{"EXT_meshopt_compression":{"buffer":0,
	"byteLength":12,"byteStride":12,"count":80000000,"mode":"ATTRIBUTES"}}}],"accessors":[{
	"bufferView":0,"componentType":5126,"type":"VEC3","count":80000000}]'
# ---- little that would be much ----
# claim NAME WORDS MEMBERS: a glTF.
claim() {
	echo "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0$4}],$3}" >"$1"
	bomb "$1" "$2"
}
zeros='{"componentType":5126,"type":"VEC3","count":4194304}'
three='{"componentType":5121,"type":"SCALAR","count":3}'
joints=
for set in $(seq 0 15); do
	joints+=",\"JOINTS_$set\":2,\"WEIGHTS_$set\":2"
done
claim joints.gltf "it would take" "\"accessors\":[$zeros,$three,{\"componentType\":5121,\"type\":\"VEC4\",
	\"count\":4194304}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0$joints},\"indices\":1}]}]" ""
claim copies.gltf "it would take" "\"accessors\":[$zeros,$three],\"meshes\":[{\"primitives\":[{
	\"attributes\":{\"POSITION\":0}}]}]" ',"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}'
# draco NAME: a primitive of what is on stdin
draco() {
	cat >packed
	claim "$1" "it would take" "\"buffers\":[{\"byteLength\":$(stat -c %s packed),\"uri\":\"data:;base64,$(
		base64 -w 0 packed)\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":$(stat -c %s packed)}],\"accessors\":[
	$zeros],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"extensions\":{
	\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}}]}]" ""
}
# 715827882 faces and points, each number as it is packed
draco faces.gltf < <(printf 'DRACO\x02\x02\x01\x01\0\0\0\xaa\xd5\xaa\xd5\x02\xaa\xd5\xaa\xd5\x02')
# 20000 faces and 60000 points, whose indices are there, with 8 attributes of 255 doubles each
{
	printf 'DRACO\x02\x02\x01\0\0\0\xa0\x9c\x01\xe0\xd4\x03\x01'
	head -c 120000 /dev/zero
	printf '\x01\x08'
	for id in 0 1 2 3 4 5 6 7; do
		printf '%b' "\x04\x0a\xff\0\x0$id"
	done
	head -c 8 /dev/zero
} >attributes.drc
draco attributes.gltf <attributes.drc
# libraries that are named again and again
for name in one two; do
	repeat 20000 'newmtl a\n' >$name.mtl
done
{
	repeat 1000 'mtllib one.mtl\nmtllib two.mtl\n'
	cat box.obj
} >again.obj
bomb again.obj "it would take" one.mtl
# two pictures of one line each, which are stretched to the size of both
python3 -c "$(
	cat <<'END'
import zlib, struct
def chunk(kind, data):
    return struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
for name, w, h in (('wide', 30000, 1), ('tall', 1, 30000)):
    rows = zlib.compress((b'\0' + b'\0' * w) * h)
    head = struct.pack('>IIBBBBB', w, h, 8, 0, 0, 0, 0)
    open(name + '.png', 'wb').write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', head) + chunk(b'IDAT', rows) + chunk(b'IEND', b''))
END
)"
printf 'newmtl paint\nmap_Kd wide.png\nmap_d tall.png\n' >paint.mtl
cp texture.obj stretched.obj
bomb stretched.obj "it would take"
for vertices in 1099511627776 2147483647; do
	printf 'ply\nformat ascii 1.0\nelement vertex %s\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n' $vertices \
		>$vertices.ply
done
bomb 1099511627776.ply "element vertex \"1099511627776\", expected a number" 1099511627776.ply:3
bomb 2147483647.ply "it ends in vertex 2, expected 2147483647 of them" 2147483647.ply
absent "nothing is left" none.inlay
finish
