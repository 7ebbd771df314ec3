"""A study in shards on clusters that run on this machine: a Slurm array, and Dask's workers, one of which is
killed.

clusters_test.py BIN_FOLDER SOURCE_FOLDER
"""
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import subprocess
import time
import unittest

from study_case import EVALUATE, ROOT, StudyTest, run

PATIENCE = 60  # s, on a busy machine
SLURM = ("munged", "slurmctld", "slurmd", "sbatch", "scontrol", "sinfo")
SLURM_CONF = """ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
SlurmdPort={other_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
MailProg=/bin/true
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def wait_for(condition, what):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"not within {PATIENCE} s: {what}")
        time.sleep(0.1)


def has(programs):
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    return all(shutil.which(program, path=path) for program in programs)


class Clusters(StudyTest):
    def start(self, *words, **variables):
        """In the foreground; ends with the test."""
        log = (self.path / f"{pathlib.Path(str(words[0])).name}_{random.randrange(10**6)}.log").open("w+")
        self.addCleanup(log.close)
        process = subprocess.Popen(["setpriv", "--pdeathsig", "KILL", *map(str, words)], stdout=log, stderr=subprocess.STDOUT,
                                   env={**os.environ, "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin", **variables})
        self.addCleanup(lambda: (process.terminate(), process.wait(PATIENCE)))
        return process, lambda: pathlib.Path(log.name).read_text(encoding="utf-8")

    def merge(self):
        merged = run([EVALUATE, "--root", ROOT, *self.study, "--report-only"])
        self.assertEqual(merged.returncode, 0, merged.stdout)
        self.assertEqual(len(self.results()), 4)
        self.check_report()

    @unittest.skipUnless(has(SLURM), "Slurm is not installed: slurmctld, slurmd, slurm-client, munge")
    def test_slurm_array(self):
        folder = self.path / "slurm"
        for name in ("", "state", "spool"):
            (folder / name).mkdir()
        folder.chmod(0o755)  # of the temporary folder, which only its owner enters
        self.path.chmod(0o755)
        key, socket_path = folder / "munge.key", folder / "munge.socket"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        self.start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={socket_path}", f"--pid-file={folder}/munged.pid",
                   f"--log-file={folder}/munged.log", f"--seed-file={folder}/munged.seed")
        wait_for(socket_path.exists, "munged listens")
        port = random.randint(20000, 32000)
        configuration = folder / "slurm.conf"
        configuration.write_text(SLURM_CONF.format(
            host=socket.gethostname().split(".")[0], folder=folder, port=port, other_port=port + 1, processors=os.cpu_count(),
            user=pathlib.Path("/proc/self").owner()))
        self.start("slurmctld", "-D", "-f", configuration)
        self.start("slurmd", "-D", "-f", configuration)
        wait_for(lambda: "idle" in run(["sinfo"], SLURM_CONF=str(configuration)).stdout, "the node is idle")
        said = run(["sbatch", "--wait", "--array=1-2", "--cpus-per-task=1", "--output", self.path / "shard-%a.txt",
                    ROOT / "tools/lab/report/shards.sbatch", *self.study], SLURM_CONF=str(configuration), PALPATE_ROOT=str(ROOT))
        tasks = [self.path / f"shard-{task}.txt" for task in (1, 2)]
        printed = [task.read_text(encoding="utf-8") if task.exists() else "" for task in tasks]
        self.assertEqual(said.returncode, 0, [said.stdout, *printed])
        for number, text in enumerate(printed, 1):
            self.assertIn(f"shard {number}/2: 2 of 4 jobs", text)
        self.merge()

    def test_slurm_script_without_slurm(self):
        outside = run(["sh", ROOT / "tools/lab/report/shards.sbatch", *self.study])
        self.assertNotEqual(outside.returncode, 0)
        self.assertIn("SLURM_ARRAY_TASK_ID", outside.stdout)

    @unittest.skipUnless(has(["dask-scheduler", "dask-worker"]), "Dask is not installed: python3-distributed")
    def test_dask_survives_a_killed_worker(self):
        _, scheduler = self.start("dask-scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        wait_for(lambda: re.search(r"Scheduler at: +(\S+)", scheduler()), "the scheduler listens")
        address = re.search(r"Scheduler at: +(\S+)", scheduler()).group(1)
        workers = [self.start("dask-worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--name", name,
                              "--local-directory", self.path) for name in ("one", "two")]
        for _, said in workers:
            wait_for(lambda said=said: "Registered to" in said(), "a worker is registered")
        _, said = self.start(ROOT / "tools/lab/report/run_shards_dask", "--scheduler", address, "4", *self.study,
                             PALPATE_EVALUATE=str(EVALUATE))
        wait_for(lambda: "4 shards on 2 workers" in said() and list((self.path / "out/control").glob("*")), "a shard runs")
        workers[0][0].send_signal(signal.SIGKILL)
        wait_for(lambda: "times as fast as one worker" in said(), said())
        self.assertEqual({int(n) for n in re.findall(r"of 4: shard (\d), \d+ s\n", said())}, {1, 2, 3, 4}, said())
        self.merge()


if __name__ == "__main__":
    unittest.main()
