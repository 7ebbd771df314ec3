"""The studies of published methods from a single command; and in shards by GNU parallel over hosts that
are network namespaces.

studies_test.py BIN_FOLDER SOURCE_FOLDER
"""
import os
import shutil
import unittest

from study_case import EVALUATE, ROOT, StudyTest, run

HOSTS = [f"palpate{os.getpid() % 10000}{letter}" for letter in "ab"]

SENSING = """octree_resolution: 0.02
applications:
  - name: bar seen
    kind: force
    scene: {folder}/scene.yaml
    configuration: rt/config/examples/bar_long_soft.yaml
    method_file: tools/lab/studies/published_sensing_methods.yaml
    methods: ["palpate, pose and wrench, blind", "[31] spline fit, Jordt"]
    mismatch_file: tools/lab/studies/published_sensing_vision.yaml
    mismatch: [noisy vision]
    seeds: [1]
"""
SCENE = """base: {root}/sim/scenes/bar_long_soft_six_poses.yaml
motion:
  start_delay: 0.2
  poses: [{{name: up, move: 0.5, hold: 0.6, translation: [0, 0, 0.03], rotation_deg: [0, 0, 0]}}]
"""

# A host for GNU parallel's --sshlogin: a command that receives a name and the command to run there.
# That command expects the variable SHELL as set by sshd: without it GNU parallel runs nothing,
# without a message.
SSH = """#!/bin/sh
host=$1
shift
[ "$1" = -- ] && shift
echo "$host" >> "{folder}/hosts"
SHELL=/bin/sh exec ip netns exec "$host" sh -c "$*"
"""


def make_hosts():
    """Two namespaces with a multicast-capable loopback. False if that is not permitted."""
    for host in HOSTS:
        for command in (["ip", "netns", "add", host],
                        ["ip", "-n", host, "link", "set", "lo", "up", "multicast", "on"],
                        ["ip", "-n", host, "route", "add", "224.0.0.0/4", "dev", "lo"]):
            try:
                if run(command).returncode != 0:
                    return False
            except FileNotFoundError:
                return False
    return True


def remove_hosts():
    for host in HOSTS:
        if shutil.which("ip"):
            run(["ip", "netns", "del", host])


class Studies(StudyTest):
    def test_one_command_runs_everything_once(self):
        (self.path / "scene.yaml").write_text(SCENE.format(root=ROOT), encoding="utf-8")
        (self.path / "sensing.yaml").write_text(SENSING.format(folder=self.path), encoding="utf-8")
        command = [ROOT / "tools/lab/report/report_baselines", "--run", "--program", EVALUATE,
                   "--control-plan", self.path / "plan.yaml", "--sensing-plan",
                   self.path / "sensing.yaml", self.path / "out"]
        said = run(command)
        self.assertEqual(said.returncode, 0, said.stdout)
        self.assertIn("4 jobs run, 0 kept, 0 failed", said.stdout)
        self.assertIn("methods on recordings: 2 run, 0 kept, 0 failed", said.stdout)
        page = (self.path / "out/baselines.html").read_text(encoding="utf-8")
        for text in ("Table 2.2", "Table 2.1", "<h2>kinematic only</h2>",
                     "<h2>[31] spline fit, Jordt</h2>", "data:image/png"):
            self.assertIn(text, page)
        # As after an interruption: only the missing jobs are run.
        shutil.rmtree(self.path / "out/control" / self.results()[0]["job"]["name"])
        again = run(command)
        self.assertEqual(again.returncode, 0, again.stdout)
        self.assertIn("1 jobs run, 3 kept, 0 failed", again.stdout)
        self.assertIn("methods on recordings: 0 run, 2 kept, 0 failed", again.stdout)
        self.check_report()

    def test_gnu_parallel_over_hosts(self):
        if shutil.which("parallel") is None:
            self.skipTest("GNU parallel is not installed")
        self.addCleanup(remove_hosts)
        if not make_hosts():
            self.skipTest("network namespaces are not permitted here")
        ssh = self.path / "ssh"
        ssh.write_text(SSH.format(folder=self.path), encoding="utf-8")
        ssh.chmod(0o755)
        logins = self.path / "hosts.txt"
        logins.write_text("".join(f"1/{ssh} {host}\n" for host in HOSTS), encoding="utf-8")
        said = run([ROOT / "tools/lab/report/run_shards", "2", *self.study],
                   PALPATE_HOSTS=f"--sshloginfile {logins}", PALPATE_SHARDS_AT_ONCE="1")
        self.assertEqual(said.returncode, 0, said.stdout)
        for shard in ("1/2", "2/2"):
            self.assertIn(f"shard {shard}: 2 of 4 jobs", said.stdout)
        used = set((self.path / "hosts").read_text(encoding="utf-8").split())
        self.assertEqual(used, set(HOSTS), f"each host has had its share; {said.stdout}")
        self.assertEqual(len(self.results()), 4, said.stdout)
        self.assertIn("4 kept", run([EVALUATE, "--root", ROOT, *self.study]).stdout)
        self.check_report()


if __name__ == "__main__":
    unittest.main()
