"""palpate-view --foxglove, read by Foxglove's own client of its WebSocket protocol.

usage: foxglove_test.py BINARIES SOURCE
"""
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

try:
    from cell import Cell
except ImportError as missing:
    print(f"skipped: {missing}; tools/packaging/packages.txt names what is needed")
    sys.exit(77)

BINARIES, SOURCE = sys.argv[1:3]
CLIENT = pathlib.Path(__file__).with_name("follow_by_foxglove.cjs")
SECONDS = 5.0  # of reading
MOST_AGE = 2.0  # s, on a busy machine
SCHEMAS = {"FT_WRENCH": "palpate.ft_wrench_t", "SHAPE": "palpate.shape_t", "HEALTH": "palpate.health_t",
           "ROBOT_STATE": "palpate.robot_state_t", "/shape/estimate": "foxglove.SceneUpdate",
           "/shape/truth": "foxglove.SceneUpdate", "/flange": "foxglove.PoseInFrame",
           "/tf/object": "foxglove.FrameTransform", "/tf/flange": "foxglove.FrameTransform"}


class FoxgloveTest(unittest.TestCase):
    def setUp(self):
        self.cell = Cell(BINARIES, SOURCE)
        self.addCleanup(self.cell.close)

    def read(self):
        environment = {**os.environ, "NODE_PATH": f"{SOURCE}/build/foxglove/node_modules"}
        done = subprocess.run(["node", CLIENT, f"ws://127.0.0.1:{self.cell.port}", str(SECONDS), *SCHEMAS],
                              capture_output=True, text=True, timeout=120, env=environment, check=False)
        if done.returncode == 77:
            print(done.stderr)
            sys.exit(77)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_sends_messages_and_scenes(self):
        self.cell.start_simulator()
        self.cell.start_daemon()
        self.cell.start_view("--foxglove")
        subprocess.run([f"{BINARIES}/palpate-command", "start", "--timeout", "60", "--url", self.cell.url(0),
                        "--url", "housekeeping=" + self.cell.url(1)], check=True)
        found = self.read()
        self.assertRegex(found["server"], "^palpate-view ")
        self.assertEqual(found["problems"], [])
        channels = found["channels"]
        for topic, schema in SCHEMAS.items():
            self.assertIn(topic, channels)
            self.assertEqual(channels[topic]["schema"], schema)
            self.assertGreater(channels[topic]["messages"], 0, topic)
            self.assertLess(abs(channels[topic]["age"]), MOST_AGE, topic)
        self.assertGreater(channels["FT_WRENCH"]["messages"], 5 * SECONDS)
        force = channels["FT_WRENCH"]["last"]["wrench"][:3]
        self.assertGreater(math.hypot(*force), 10, "N: the weight of the hand")
        self.assertEqual(self.cell.stop("palpate-view"), 0)


if __name__ == "__main__":
    if shutil.which("node") is None:
        print("skipped: node is not installed")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
