#!/bin/sh
# A Slurm array of 50 tasks, each of which does a shard of a list of meshes, on a cluster of one
# node that lives in a folder of its own while the test runs: some tasks are killed, some requeued,
# and the files of all shards are together the same bytes as that of one run.
#
#     tests/batch/slurm.sh        needs munge and slurm-wlm (make deps with=batch) and to be root
#
# Its daemons listen on this machine, at ports that were free; none of the system's configuration,
# keys or daemons is used or changed.
#
# SPDX-License-Identifier: MIT
. tests/script.sh

query=$SC_BIN/sc-query
needs=
for program in munged mungekey slurmctld slurmd sbatch scancel scontrol sinfo squeue; do
    PATH=$PATH:/usr/sbin
    command -v $program >/dev/null 2>&1 || needs="$needs $program"
done
[ "$(id -u)" -eq 0 ] || needs="$needs root"
[ -x "$query" ] || needs="$needs sc-query"
command -v python3 >/dev/null 2>&1 || needs="$needs python3"
if [ -n "$needs" ]; then
    skip "a Slurm array: needs$needs" 10
    finish
fi
query=$(cd "$SC_BIN" && pwd)/sc-query
top=$(pwd)
# Munge wants that nobody else can write to any folder above its files.
at=$(mktemp -d /run/starcontour-slurm.XXXXXX) || exit 1
chmod 711 "$at"
tasks=50

# ---- a cluster ----

stop() {
    [ -s "$at/slurm.conf" ] && scancel --quiet --user root 2>/dev/null
    for daemon in slurmd slurmctld munged; do
        [ -s "$at/$daemon.pid" ] && kill "$(cat "$at/$daemon.pid")" 2>/dev/null
    done
    sleep 1
    for daemon in slurmd slurmctld munged; do
        [ -s "$at/$daemon.pid" ] && kill -KILL "$(cat "$at/$daemon.pid")" 2>/dev/null
    done
    rm -rf "$at" "$scratch"
}
trap stop EXIT
mkdir -p "$at/spool" "$at/state" "$at/out"
host=$(hostname -s)
# shellcheck disable=SC2046
set -- $(python3 -c 'import socket
sockets = [socket.socket() for _ in range(2)]
for one in sockets: one.bind(("127.0.0.1", 0))
print(*(one.getsockname()[1] for one in sockets))')
cat >"$at/slurm.conf" <<EOT
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$1
SlurmdPort=$2
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$at/munge.socket,cred_expire=10
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_min_interval=100000
ReturnToService=2
JobRequeue=1
KillWait=2
PropagateResourceLimits=NONE
SlurmctldPidFile=$at/slurmctld.pid
SlurmdPidFile=$at/slurmd.pid
SlurmctldLogFile=$at/slurmctld.log
SlurmdLogFile=$at/slurmd.log
StateSaveLocation=$at/state
SlurmdSpoolDir=$at/spool
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOT
echo "CgroupPlugin=cgroup/v1" >"$at/cgroup.conf"
export SLURM_CONF="$at/slurm.conf"
start() {
    mungekey --create --keyfile="$at/munge.key" &&
        munged --key-file="$at/munge.key" --socket="$at/munge.socket" --pid-file="$at/munged.pid" \
            --log-file="$at/munged.log" --seed-file="$at/munged.seed" || return 1
    slurmctld -c || return 1
    slurmd -N "$host" || return 1
    for wait in $(seq 60); do
        [ "$(sinfo --noheader --format=%T 2>/dev/null)" = idle ] && return 0
        sleep 0.5
    done
    echo "no node after $wait tries"
    sinfo
    tail -n 20 "$at"/*.log
    return 1
}
check "a cluster of one node" start
[ "$checks_failed" -eq 0 ] || finish

# ---- a list: for each task six meshes, the last of which takes a second or two where it is ended
# ----

{ printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\n' && yes 'f 1 2 3' | head -n 9000; } >"$at/slow.obj"
for i in $(seq $tasks); do
    for mesh in crossing_cloths sphere folded_sheet moebius absent; do
        echo "$top/meshes/$mesh.obj"
    done
    case $i in
    *3 | *7) echo "$at/slow.obj" ;;
    *) echo "$top/meshes/twisted_strip.obj" ;;
    esac
done >"$at/list"
check "one run" status 2 "$query" --jsonl "$at/whole" --manifest "$at/list"

# ---- the array ----

# Tasks 3, 13, 23, 33 and 43 are requeued by Slurm at their first start, and 7, 17, 27, 37 and 47
# killed with all their processes, before their last line; those that were killed are submitted
# again.
cat >"$at/job" <<EOT
#!/bin/sh
file=$at/out/\$SLURM_ARRAY_TASK_ID
echo x >>"$at/out/starts.\$SLURM_ARRAY_TASK_ID"
run() {
    '$query' --jsonl "\$file" --manifest '$at/list' --shard "\$SLURM_ARRAY_TASK_ID/$tasks" --resume
}
case \$SLURM_ARRAY_TASK_ID in
*3 | *7)
    if [ "\$(wc -l <"$at/out/starts.\$SLURM_ARRAY_TASK_ID")" -eq 1 ]; then
        run &
        until [ "\$(wc -l <"\$file" 2>/dev/null || echo 0)" -ge 5 ]; do sleep 0.02; done
        case \$SLURM_ARRAY_TASK_ID in
        *3) scontrol requeue "\${SLURM_ARRAY_JOB_ID}_\$SLURM_ARRAY_TASK_ID" ;;
        *7) scancel --signal=KILL --full "\${SLURM_ARRAY_JOB_ID}_\$SLURM_ARRAY_TASK_ID" ;;
        esac
        sleep 60
    fi
    ;;
esac
run
EOT
submit() { # TASKS
    sbatch --quiet --array="$1" --requeue --output="$at/out/log.%a" --open-mode=append "$at/job"
}
ended() {
    for wait in $(seq 600); do
        [ -z "$(squeue --noheader --format=%i)" ] && return 0
        sleep 0.5
    done
    echo "waited $wait times"
    squeue
    tail -n 20 "$at"/*.log
    return 1
}
same() {
    for i in $(seq $tasks); do cat "$at/out/$i"; done | cmp - "$at/whole"
}
check "50 tasks are submitted" submit "1-$tasks"
check "and end" ended
check "five of them began twice" test "$(cat "$at"/out/starts.* | wc -l)" -eq 55
check "five were killed before their last line" \
    test "$(cat "$at"/out/7 "$at"/out/17 "$at"/out/27 "$at"/out/37 "$at"/out/47 | wc -l)" -eq 25
check "those that were killed are submitted again" submit 7,17,27,37,47
check "and end" ended
check "five more starts" test "$(cat "$at"/out/starts.* | wc -l)" -eq 60
check "the same bytes as one run" same
finish
