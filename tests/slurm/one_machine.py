"""A real Slurm on this machine: a controller and two nodes of one core each, on loopback.

Needs root and the Debian packages slurm-wlm and munge, but not systemd. An installed Slurm is left
alone.
"""

from __future__ import annotations

import os
import secrets
import shutil
import signal
import socket
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

NODES = ("n1", "n2")
NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol")


def missing() -> str:
    """Returns the reason why Slurm cannot run here, or an empty string."""
    if os.geteuid() != 0:
        return "it needs root"
    lacking = [name for name in NEEDED if not shutil.which(name)]
    return (
        f"not on the PATH: {', '.join(lacking)} (`make test-slurm` installs slurm-wlm and munge)"
        if lacking
        else ""
    )


def free_ports(count: int) -> list[int]:
    held = [socket.socket() for _ in range(count)]
    for listener in held:
        listener.bind(("127.0.0.1", 0))
    ports = [int(listener.getsockname()[1]) for listener in held]
    for listener in held:
        listener.close()
    return ports


def wait_until(event: str, holds: Callable[[], bool], seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > end:
            raise TimeoutError(f"{event}: not within {seconds:.0f} s")
        time.sleep(0.1)


def configuration(folder: Path) -> str:
    host = socket.gethostname().split(".")[0]
    controller, *ports = free_ports(1 + len(NODES))
    lines = [
        "ClusterName=hausbench",
        f"SlurmctldHost={host}(127.0.0.1)",
        "AuthType=auth/munge",
        f"AuthInfo=socket={folder}/munge/socket,cred_expire=5",
        "CredType=cred/munge",
        "SlurmUser=root",
        "SlurmdUser=root",
        f"SlurmctldPort={controller}",
        f"StateSaveLocation={folder}/state",
        f"SlurmdSpoolDir={folder}/%n",
        f"SlurmctldPidFile={folder}/slurmctld.pid",
        f"SlurmdPidFile={folder}/%n.pid",
        f"SlurmctldLogFile={folder}/slurmctld.log",
        f"SlurmdLogFile={folder}/%n.log",
        "ProctrackType=proctrack/linuxproc",
        "TaskPlugin=task/none",
        "JobAcctGatherType=jobacct_gather/none",
        "AccountingStorageType=accounting_storage/none",
        "SelectType=select/cons_tres",
        "SelectTypeParameters=CR_Core",
        "ReturnToService=2",
        "SchedulerParameters=sched_interval=2,bf_interval=2",
        "SlurmdTimeout=5",
        "MpiDefault=none",
        "KillWait=2",
    ]
    lines += [
        f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=1 State=UNKNOWN"
        for node, port in zip(NODES, ports)
    ]
    return "\n".join(
        [
            *lines,
            f"PartitionName=all Nodes={','.join(NODES)} Default=YES MaxTime=INFINITE State=UP",
            "",
        ]
    )


class Slurm:
    """A running Slurm: `with Slurm(folder) as slurm` starts it, and leaving the block stops it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.environment = {**os.environ, "SLURM_CONF": str(folder / "slurm.conf")}
        self._daemons: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> Slurm:
        for name in ("munge", "state", *NODES):
            (self.folder / name).mkdir(mode=0o700)
        (self.folder / "munge" / "key").write_bytes(secrets.token_bytes(1024))
        (self.folder / "munge" / "key").chmod(0o600)
        (self.folder / "slurm.conf").write_text(configuration(self.folder))
        munge = self.folder / "munge"
        try:
            self._start(
                "munged",
                "munged",
                "--foreground",
                "--force",
                f"--key-file={munge}/key",
                f"--socket={munge}/socket",
                f"--pid-file={munge}/pid",
                f"--log-file={munge}/log",
                f"--seed-file={munge}/seed",
            )
            wait_until("munged", (munge / "socket").exists)
            self._start("slurmctld", "slurmctld", "-D", "-f", self.environment["SLURM_CONF"])
            for node in NODES:
                self.start_node(node)
            wait_until("both nodes idle", lambda: self.states() == dict.fromkeys(NODES, "idle"))
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        for node in NODES:
            self.end_tasks(node)
        for daemon in reversed(self._daemons.values()):
            daemon.terminate()
        for daemon in self._daemons.values():
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def _start(self, name: str, *command: str) -> None:
        with (self.folder / f"{name}.out").open("ab") as out:
            self._daemons[name] = subprocess.Popen(
                command, env=self.environment, stdin=subprocess.DEVNULL, stdout=out, stderr=out
            )

    def start_node(self, node: str) -> None:
        self._start(node, "slurmd", "-D", "-N", node, "-f", self.environment["SLURM_CONF"])

    def lose_node(self, node: str) -> None:
        """Kills the node's daemon and all its tasks at once, like a power failure."""
        daemon = self._daemons[node]
        daemon.send_signal(signal.SIGKILL)
        daemon.wait()
        self.end_tasks(node)

    def end_tasks(self, node: str) -> None:
        for step in self.steps(node):
            for pid in [step, *descendants(step)]:
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass

    def steps(self, node: str) -> list[int]:
        """Returns Slurm's processes that supervise the node's tasks; each has the node's spool
        folder or log open."""
        pids = []
        for process in Path("/proc").iterdir():
            if not process.name.isdecimal():
                continue
            try:
                if (process / "comm").read_text().strip() != "slurmstepd":
                    continue
                opened = [os.readlink(link) for link in (process / "fd").iterdir()]
            except OSError:
                continue
            if any(
                name.startswith((f"{self.folder}/{node}.log", f"{self.folder}/{node}/"))
                for name in opened
            ):
                pids.append(int(process.name))
        return pids

    def states(self) -> dict[str, str]:
        """Returns the state of each node: `idle`, `mixed`, `down*`, ..."""
        done = subprocess.run(
            ["sinfo", "--noheader", "--Node", "--format=%N %T"],
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
        )
        return dict(line.split() for line in done.stdout.splitlines())

    def queue(self) -> list[str]:
        done = subprocess.run(
            ["squeue", "--noheader", "--array", "--format=%j %K %T"],
            env=self.environment,
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.splitlines()


def descendants(pid: int) -> list[int]:
    pids = [pid]
    for process in pids:
        for thread in Path(f"/proc/{process}/task").glob("*/children"):
            try:
                pids += [int(child) for child in thread.read_text().split()]
            except OSError:
                pass
    return pids[1:]
