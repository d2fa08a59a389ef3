# SPDX-License-Identifier: GPL-3.0-or-later
"""A Slurm cluster of several nodes on this machine, in a folder that goes away: munged, slurmctld and one slurmd a node."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue", "scancel", "sacct")
PATH = os.environ.get("PATH", "") + ":/usr/sbin:/sbin"

CONFIGURATION = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
MpiDefault=none
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SwitchType=switch/none
ReturnToService=2
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmdSpoolDir={folder}/spool.%n
StateSaveLocation={folder}/state
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
SlurmdParameters=config_overrides
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0
MaxArraySize={array}
KillWait=2
SlurmdTimeout=10
NodeName=n[1-{nodes}] NodeHostname=localhost NodeAddr=127.0.0.1 Port=[{first}-{last}] CPUs=1 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing():
    """What is not installed, or why there can be no cluster."""
    gone = [name for name in PROGRAMS if shutil.which(name, path=PATH) is None]
    if gone:
        return ", ".join(gone) + " missing (Debian: slurm-wlm)"
    return "" if os.geteuid() == 0 else "only root can start a cluster"


def free_ports(count):
    """As many ports in a row that nobody listens on."""
    for first in range(26800, 60000, 50):
        try:
            for port in range(first, first + count):
                with socket.socket() as s:
                    s.bind(("127.0.0.1", port))
            return first
        except OSError:
            continue
    raise RuntimeError("no free ports")


class Cluster:
    """Daemons run in the foreground as children of this program, so that it ends them and no others."""

    def __init__(self, folder, nodes=3, max_array_size=1001):
        self.folder, self.processes = pathlib.Path(folder), []
        (self.folder / "munge").mkdir(parents=True)
        (self.folder / "state").mkdir()
        os.chmod(self.folder, 0o755)  # munged refuses a socket that others could replace
        port = free_ports(nodes + 1)
        self.configuration = self.folder / "slurm.conf"
        self.configuration.write_text(CONFIGURATION.format(
            host=socket.gethostname().partition(".")[0], user="root", folder=self.folder, port=port, nodes=nodes, first=port + 1, last=port + nodes,
            array=max_array_size), encoding="utf-8")
        self.environment = {**os.environ, "SLURM_CONF": str(self.configuration), "PATH": PATH}
        self.nodes = [f"n{n}" for n in range(1, nodes + 1)]

    def start(self):
        munge = self.folder / "munge"
        (munge / "key").write_bytes(os.urandom(1024))
        os.chmod(munge / "key", 0o400)
        self.daemon("munged", "--foreground", "--force", *(f"--{what}={munge / name}" for what, name in (
            ("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("log-file", "log"), ("seed-file", "seed"))))
        self.until(lambda: (munge / "socket").exists(), "munged")
        self.daemon("slurmctld", "-D", "-i", "-f", self.configuration)
        for node in self.nodes:
            (self.folder / f"spool.{node}").mkdir()
            self.daemon("slurmd", "-D", "-N", node, "-f", self.configuration)
        self.until(lambda: self.states() == {node: "IDLE" for node in self.nodes}, "nodes")

    def daemon(self, name, *arguments):
        log = open(self.folder / f"{name}.out", "ab")
        self.processes.append(subprocess.Popen([name, *map(str, arguments)], env=self.environment, stdin=subprocess.DEVNULL, stdout=log,
                                               stderr=subprocess.STDOUT))
        log.close()

    def stop(self):
        for process in reversed(self.processes):
            if process.poll() is None:
                process.send_signal(signal.SIGTERM)
        for process in self.processes:
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def run(self, *command):
        done = subprocess.run([str(c) for c in command], env=self.environment, capture_output=True, text=True, timeout=120, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{command}: exit {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout

    def states(self):
        try:
            out = self.run("sinfo", "--noheader", "--Node", "--format=%N %T")
        except RuntimeError:
            return {}
        return {node: state.rstrip("*").upper() for node, state in (line.split() for line in out.splitlines())}

    def jobs(self):
        """(job's number with its index, state, node) of what is in the queue."""
        return [tuple(line.split("|")) for line in self.run("squeue", "--noheader", "--array", "--format=%A|%F_%K|%T|%N|%j").splitlines()]

    def until(self, good, what, patience=120):
        end = time.monotonic() + patience
        while not good():
            if time.monotonic() > end:
                logs = "".join(f"--- {p.name}\n" + "\n".join(p.read_text(errors="replace").splitlines()[-15:]) + "\n"
                               for p in sorted(self.folder.glob("*.log")) + sorted(self.folder.glob("*.out")))
                raise RuntimeError(f"{what}: waited for {patience} s\n{logs}")
            time.sleep(0.1)
