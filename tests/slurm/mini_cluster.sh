# Sourced: a private Slurm of two nodes on this machine, everything below $root, on ports of its own.
# Runs as any user and needs no accounting database. cluster_start, cluster_stop, node_stop NODE.
#
# Timeouts are far shorter than a real cluster's: a lost node is noticed after 10 s, and a
# requeued task starts again once its credential has expired, 5 s instead of two minutes.

# wait_until SECONDS COMMAND...: polls until the command succeeds.
wait_until() {
  local end=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    if [ $SECONDS -ge $end ]; then return 1; fi
    sleep 0.2
  done
}

idle_nodes_are() { [ "$(sinfo -h -t idle -o %D | paste -sd+ | sed 's/$/+0/' | bash -c 'read -r sum; echo $((sum))')" -eq "$1" ]; }

cluster_start() {
  local user host port node
  user=$(id -un)
  host=$(hostname -s)
  port=$((21000 + $$ % 20000))
  mkdir -p "$root"/{state,log,munge,spool.n1,spool.n2}
  chmod 755 "$root" "$root/munge"
  (umask 077; head -c 128 /dev/urandom >"$root/munge/key")
  munged --key-file="$root/munge/key" --socket="$root/munge/sock" --pid-file="$root/munge/pid" \
    --log-file="$root/munge/log" --seed-file="$root/munge/seed"
  export SLURM_CONF=$root/slurm.conf
  cat >"$SLURM_CONF" <<CONF
ClusterName=brickbench
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$root/munge/sock,cred_expire=5
CredType=cred/munge
StateSaveLocation=$root/state
SlurmdSpoolDir=$root/spool.%n
SlurmctldPidFile=$root/slurmctld.pid
SlurmdPidFile=$root/slurmd.%n.pid
SlurmctldLogFile=$root/log/slurmctld.log
SlurmdLogFile=$root/log/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=2
SlurmdParameters=config_overrides
ReturnToService=2
SlurmdTimeout=10
SlurmctldTimeout=10
KillWait=2
JobRequeue=1
CONF
  for node in 1 2; do
    echo "NodeName=n$node NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + node)) CPUs=1" \
      "RealMemory=500 State=UNKNOWN" >>"$SLURM_CONF"
  done
  echo "PartitionName=main Nodes=n[1-2] Default=YES MaxTime=INFINITE State=UP" >>"$SLURM_CONF"
  echo "CgroupPlugin=autodetect" >"$root/cgroup.conf"
  slurmctld -f "$SLURM_CONF"
  for node in n1 n2; do slurmd -f "$SLURM_CONF" -N $node; done
  wait_until 20 scontrol ping && wait_until 30 idle_nodes_are 2
}

stop_pid_file() {
  local pid
  if [ -s "$1" ]; then
    pid=$(cat "$1")
    kill -"${2:-TERM}" "$pid" 2>/dev/null || true
  fi
}

node_stop() { stop_pid_file "$root/slurmd.$1.pid" KILL; }
node_start() { slurmd -f "$SLURM_CONF" -N "$1"; }

cluster_stop() {
  local file
  for file in "$root"/slurmd.*.pid "$root/slurmctld.pid" "$root/munge/pid"; do
    stop_pid_file "$file"
  done
}
