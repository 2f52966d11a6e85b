#!/bin/bash
# SPDX-License-Identifier: MIT
# A bake shared out: shards made one by one, by GNU parallel and by a Slurm array are the same file as one run.
set -u
# shellcheck source=tests/cli/tools/scene.sh
. "$(dirname "$0")/tools/scene.sh"

bake=$INLAY_BAKE
whole="$work/whole.inlay"
render=("$bake" render --exact --frequency 4 "$work/box.scene")

skip() {
	count=$((count + 1))
	echo "ok $count - $1 # SKIP $2"
}
# unmerged NAME WORDS COMMAND...: exits with 1 and one sentence, and writes no file.
unmerged() {
	local name=$1 words=$2 is
	shift 2
	rm -f "$work/no.inlay"
	"$@" >/dev/null 2>"$work/stderr" </dev/null
	is=$?
	if [ $is -ne 1 ] || [ -e "$work/no.inlay" ] || [ "$(wc -l <"$work/stderr")" != 1 ] ||
		! grep -qF -- "$words" "$work/stderr"; then
		fail "$name" < <(printf '%s\n' "exit code $is, expected 1 with \"$words\": $*" \
			"$(cat "$work/stderr")")
	else
		pass "$name"
	fi
}

"${render[@]}" -o "$whole" >/dev/null || exit 1

# OpenBLAS's own choice of kernels differs from one processor to the next, and so do sums.
if grep -qw avx2 /proc/cpuinfo 2>/dev/null && grep -qw fma /proc/cpuinfo; then
	OPENBLAS_CORETYPE=Haswell "${render[@]}" -o "$work/haswell.inlay" >/dev/null
	same "all processors with AVX2 make the same file" "$whole" "$work/haswell.inlay"
fi

for k in 1 2 3; do
	check "shard $k of 3" "${render[@]}" --shard $k/3 --threads $k -o "$work/$k.shard"
done
check "merge, in any order" "$bake" merge "$work"/{3,1,2}.shard -o "$work/merged.inlay"
same "three shards are one run, bit for bit" "$whole" "$work/merged.inlay"

"${render[@]}" --shard 1/1 -o "$work/all.shard" >/dev/null
check "merge of one" "$bake" merge "$work/all.shard" -o "$work/merged.inlay"
same "one shard is one run" "$whole" "$work/merged.inlay"

# More shards than tiles: some hold none.
for ((k = 1; k <= 40; k++)); do
	"${render[@]}" --shard $k/40 --quiet -o "$work/many.$k" || break
done
check "merge of more shards than tiles" "$bake" merge "$work"/many.* -o "$work/merged.inlay"
same "as one run" "$whole" "$work/merged.inlay"

# ---- what does not belong together ----
cp "$whole" "$work/other.shard"
"$bake" render --frequency 4 "$work/box.scene" --seed 7 --exact --shard 3/3 -o "$work/seed.shard" >/dev/null
head -c $(($(stat -c %s "$work/3.shard") - 100)) "$work/3.shard" >"$work/cut.shard"
cp "$work/3.shard" "$work/flipped.shard"
flip "$work/flipped.shard" $(($(stat -c %s "$work/3.shard") / 2))
cp "$work/3.shard" "$work/older.shard"
printf '\7' | dd of="$work/older.shard" bs=1 seek=40 conv=notrunc status=none
merge=("$bake" merge -o "$work/no.inlay" "$work/1.shard" "$work/2.shard")
unmerged "one is missing" "one of 3 shards, expected one of the 2 given" "${merge[@]}"
unmerged "one is there twice" "expected each once" "${merge[@]}" "$work/2.shard"
unmerged "one of another seed" "of another bake" "${merge[@]}" "$work/seed.shard"
unmerged "one of an older basis format" "for basis files of version 7" "${merge[@]}" "$work/older.shard"
unmerged "a basis file" "is no shard" "${merge[@]}" "$work/other.shard"
unmerged "one cut off" "ends too early" "${merge[@]}" "$work/cut.shard"
unmerged "one with a wrong byte" "is damaged" "${merge[@]}" "$work/flipped.shard"
unmerged "one that is not there" "No such file" "${merge[@]}" "$work/none.shard"
wrong() { # NAME COMMAND...
	local name=$1
	shift
	"$@" >/dev/null 2>&1 </dev/null
	equal "$name" 2 $?
}
wrong "merge without shards" "$bake" merge -o "$work/no.inlay"
wrong "merge without -o" "$bake" merge "$work/1.shard"
for which in 0/3 4/3 1 1/ /3 1/3x -1/3 1/99999; do
	wrong "--shard $which" "${render[@]}" --shard "$which" -o "$work/no.inlay"
done

# ---- the recipes of bake/README.md ----
cd "$work" || exit 1
if command -v parallel >/dev/null; then
	PARALLEL_HOME=$work/parallel parallel --will-cite --quote --jobs 2 "$bake" render --exact --frequency 4 \
		box.scene --quiet --shard {}/4 -o part.{}.shard ::: 1 2 3 4
	check "merge of what GNU parallel made" "$bake" merge part.?.shard -o parallel.inlay
	same "GNU parallel: as one run" "$whole" parallel.inlay
else
	skip "GNU parallel" "it is not installed"
fi

# Slurm on this machine alone, its daemons on ports of their own. Its paths may hold no blank.
slurm=
slurm_pids=()
start_slurm() {
	local host control daemon # ports that nobody else has
	read -r control daemon < <(python3 -c 'import socket
s = [socket.create_server(("127.0.0.1", 0)) for _ in "ab"]
print(*[x.getsockname()[1] for x in s])')
	host=$(hostname -s)
	slurm=$(mktemp -d "${TMPDIR:-/tmp}/inlay-slurm.XXXXXX")
	mkdir "$slurm/state" "$slurm/spool"
	export SLURM_CONF=$slurm/slurm.conf
	cat >"$SLURM_CONF" <<END
ClusterName=inlay
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/none
CredType=cred/none
SlurmUser=root
SlurmctldPort=$control
SlurmdPort=$daemon
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES State=UP
END
	slurmctld -D >"$slurm/log" 2>&1 &
	slurm_pids+=($!)
	slurmd -D >>"$slurm/log" 2>&1 &
	slurm_pids+=($!)
	until_true eval 'sinfo --noheader --states=idle 2>/dev/null | grep -q all'
}
stop_slurm() {
	[ ${#slurm_pids[@]} = 0 ] || kill "${slurm_pids[@]}" 2>/dev/null
	wait
	[ -z "$slurm" ] || rm -rf "$slurm"
}
trap 'stop_slurm; rm -rf "$work"' EXIT

if command -v slurmctld slurmd sbatch >/dev/null && [ "$(id -u)" = 0 ]; then
	cat >array.sh <<'END'
#!/bin/sh
#SBATCH --array=1-4
exec "$INLAY_BAKE" render --exact --frequency 4 box.scene --quiet --threads 1 \
	--shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" -o "array.$SLURM_ARRAY_TASK_ID.shard"
END
	start_slurm || fail "Slurm starts" <"$slurm/log"
	check "a Slurm array" timeout 600 sbatch --wait --output="$slurm/job.%a" array.sh
	[ -e array.4.shard ] || sed 's/^/# /' "$slurm"/job.*
	check "merge of what Slurm made" "$bake" merge array.?.shard -o array.inlay
	same "Slurm: as one run" "$whole" array.inlay
else
	skip "a Slurm array" "it is not installed, or this is not root"
fi
finish
