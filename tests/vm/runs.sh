# shellcheck shell=bash
# Sourced after devices.sh by the tests that run the whole program: two vivids are its cameras.
# shellcheck disable=SC2154 # tools is set there

basis=$tools/live/live.inlay
config=tests/vm/live.conf

# run NAME option...: starts inlay run on both cameras; ended by stop_run.
run() {
	local name=$1
	shift
	"$INLAY" run --config $config --set basis.file="$basis" \
		--set camera.fisheye.device="$(video_node vivid-000-vid-cap)" \
		--set camera.background.device="$(video_node vivid-001-vid-cap)" \
		--stats "$VM_OUT/$name.jsonl" "$@" >"$VM_OUT/$name.log" 2>&1 &
	running=$!
}

# Its exit code; a run that does not end within 10 s is killed.
stop_run() {
	kill $running 2>/dev/null
	within_seconds 10 ended || kill -KILL $running
	wait $running
}

ended() {
	! kill -0 $running
}

# stat NAME KEY: a number of the last line of statistics.
stat() {
	tail -n 1 "$VM_OUT/$1.jsonl" | sed "s/.*\"$2\":\([-0-9.]*\).*/\1/"
}

# The last line says that this camera's situation is so.
#     situation NAME CAMERA SITUATION
situation() {
	tail -n 1 "$VM_OUT/$1.jsonl" | grep -q "\"name\":\"$2\",\"situation\":\"$3\""
}
