#!/bin/sh
# Runs the script that `etalon farm --slurm` writes on a real Slurm of one machine, and compares the picture with that of one render.
# As root on Debian or Ubuntu; installs slurm-wlm and munge, and starts daemons of its own that end with it.
#   tests/farm-slurm.sh [path of etalon]
set -eu

here=$(cd "$(dirname "$0")/.." && pwd)
etalon=$(realpath "${1:-$here/target/release/etalon}")
command -v slurmctld >/dev/null && command -v munged >/dev/null || {
    apt-get update -q
    DEBIAN_FRONTEND=noninteractive apt-get install -y -q slurm-wlm munge
}

work=$(mktemp -d)
host=$(hostname -s)
started=
finish() {
    status=$?
    for pid in $started; do kill "$pid" 2>/dev/null && wait "$pid" || true; done
    [ "$status" = 0 ] || tail -n 20 "$work"/*.log
    rm -rf "$work"
    exit "$status"
}
trap finish EXIT

# munge refuses folders that others may write to, and keys of others.
mkdir -p "$work/munge" "$work/state" "$work/spool"
chmod 755 "$work"
dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 2>/dev/null
chown -R munge:munge "$work/munge"
chmod 700 "$work/munge" && chmod 400 "$work/munge/key" && chmod 711 "$work/munge"
runuser -u munge -- munged --foreground --key-file="$work/munge/key" --socket="$work/munge/socket" \
    --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" >"$work/munged.log" 2>&1 &
started="$started $!"

cat >"$work/slurm.conf" <<END
ClusterName=one
SlurmctldHost=$host
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SlurmctldPort=26817
SlurmdPort=26818
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SchedulerParameters=bf_interval=1,sched_interval=1
NodeName=$host CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
# Slurm from 23.11 on can do without control groups; before, it makes its own without systemd.
case "$(slurmd -V)" in
    *" "2[012].* | *" 23.02"*) printf 'CgroupPlugin=autodetect\nIgnoreSystemd=yes\n' ;;
    *) echo "CgroupPlugin=disabled" ;;
esac >"$work/cgroup.conf"
export SLURM_CONF="$work/slurm.conf"
slurmctld -D >"$work/slurmctld.log" 2>&1 &
started="$started $!"
slurmd -D >"$work/slurmd.log" 2>&1 &
started="$started $!"

waited=0
until sinfo --noheader --format=%T 2>/dev/null | grep -q idle; do
    waited=$((waited + 1))
    [ "$waited" -lt 60 ] || { echo "Slurm does not start" >&2; exit 1; }
    sleep 1
done

options="--size 96x72 --spp 16 --seed 3"
scene="$here/scenes/cornell-glass.json"
"$etalon" render "$scene" $options --quiet -o "$work/whole.exr"
"$etalon" farm "$scene" $options --shards 5 --threads 1 --slurm --picture "$work/it's merged.exr" -o "$work/farm.sh"
sh "$work/farm.sh"

waited=0
until [ -e "$work/it's merged.exr" ]; do
    waited=$((waited + 1))
    [ "$waited" -lt 300 ] || { squeue; echo "the job does not end" >&2; exit 1; }
    sleep 1
done
ls "$work" | grep -c 'of-5.part$' | grep -qx 5
# All but the four bytes of the time that it took.
differing=$(cmp -l "$work/whole.exr" "$work/it's merged.exr" | wc -l)
[ "$differing" -le 4 ] || { echo "$differing bytes differ" >&2; exit 1; }
echo "the picture of $(sinfo --version) is that of one machine"
