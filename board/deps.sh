#!/bin/bash
# SPDX-License-Identifier: MIT
# Installs the Debian packages that a purpose needs, and nothing when all of them are there.
#     board/deps.sh build|demo|film|package|image|test|deep ...
# Debian 12 has all of them; Debian 13 those for build, demo and package.
# Root is asked for only when something is missing.
set -eu

build="gcc g++ make pkg-config libdrm-dev libgpiod-dev libyuv-dev libinih-dev libsdl2-dev
	libcamera-dev libavcodec-dev libcairo2-dev libsystemd-dev libpng-dev
	libjpeg62-turbo-dev libopenexr-dev libwebp-dev libxxhash-dev libzstd-dev libembree-dev
	libtiff-dev libstb-dev nlohmann-json3-dev libmeshoptimizer-dev libdraco-dev
	liblapacke-dev libopenblas-dev libcminpack-dev libexif-dev libyaml-dev libopencv-calib3d-dev
	libopencv-contrib-dev libopencv-video-dev"
demo="ffmpeg fonts-dejavu-core"
film="opencv-doc"
package="dpkg-dev xz-utils"
# What compiles the kernel of the simulated machine, a user-mode Linux.
kernel="linux-source-6.1 flex bison bc kmod xz-utils"
# What builds images and boots them: tools, firmware and emulators of other machines, the Arm compiler.
image="$kernel mmdebstrap uidmap fakeroot e2fsprogs dosfstools mtools fdisk systemd fontconfig binutils
	dpkg-dev libelf-dev libssl-dev cpio qemu-system-x86 qemu-system-arm ovmf qemu-user-static arch-test
	gcc-aarch64-linux-gnu g++-aarch64-linux-gnu"
test="libcmocka-dev libturbojpeg0-dev clang-format git python3-minimal busybox-static v4l-utils
	libcamera-ipa udev"
# For the deep tests alone.
deep="shellcheck poppler-utils clang clang-tidy libclang-rt-dev cppcheck valgrind opencv-doc parallel
	slurmctld slurmd slurm-client man-db mandoc lintian bash-completion zsh blender python3-numpy"

wanted=""
for purpose in "$@"; do
	case "$purpose" in
	build) wanted="$wanted $build" ;;
	demo) wanted="$wanted $build $demo" ;;
	film) wanted="$wanted $build $demo $film" ;;
	package) wanted="$wanted $build $package" ;;
	image) wanted="$wanted $build $image" ;;
	test) wanted="$wanted $build $demo $kernel $test" ;;
	deep) wanted="$wanted $build $demo $package $image $test $deep" ;;
	*)
		echo "deps: unknown purpose \"$purpose\", expected build, demo, film, package, image, test or deep" >&2
		exit 2
		;;
	esac
done

missing=""
for package in $wanted; do
	status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
	case "$status" in
	"install ok installed") ;;
	*) missing="$missing $package" ;;
	esac
done
[ -n "$missing" ] || exit 0

echo "deps: installing$missing"
as_root=""
if [ "$(id -u)" != 0 ]; then
	if ! command -v sudo >/dev/null; then
		echo "deps: these packages are missing and there is no sudo; as root, run:" >&2
		echo "    apt-get install --no-install-recommends$missing" >&2
		exit 1
	fi
	as_root="sudo"
fi
export DEBIAN_FRONTEND=noninteractive
$as_root apt-get update -q
# apt-get would take a name that it does not know for a pattern, and install what fits.
for package in $missing; do
	if ! apt-cache pkgnames "$package" | grep -qxF "$package"; then
		echo "deps: this system has no package $package, expected Debian 12" >&2
		exit 1
	fi
done
# shellcheck disable=SC2086 # a list of words
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
