"""palpated whose channels have other names on the bus, commanded by the package and by
palpate-command."""

import subprocess
import unittest

from processes import BAR, BIN, PATIENCE, ProcessTest

NAMES = {"COMPONENT_COMMAND": "LEFT_COMMAND", "COMPONENT_EVENT": "LEFT_EVENT", "HEALTH": "LEFT_HEALTH"}


class RenamedChannels(ProcessTest):
    def command(self, *words: object) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            [str(word) for word in (BIN / "palpate-command", *words)],
            capture_output=True, text=True, timeout=3 * PATIENCE,
        )  # fmt: skip

    def test_both_command_it(self) -> None:
        key = self.folder / "robot.key"
        self.command("--make-key", key)
        configuration = self.folder / "renamed.yaml"
        configuration.write_text(
            f"base: {BAR}\naccess: {{key_file: {key}}}\nbus:\n  control: {self.control}\n"
            f"  housekeeping: {self.housekeeping}\n  channels: {str(NAMES).replace(chr(39), '')}\n"
        )
        self.start_daemon(configuration)
        daemon = self.connect(channels=NAMES, key_file=key)
        self.assertEqual(daemon.start().event, "start")

        done = self.command("--config", configuration, "--timeout", PATIENCE, "stop")
        self.assertEqual((done.returncode, done.stdout.split(":")[0].strip()), (0, "stop"), done.stderr)
        elsewhere = self.command("--config", configuration, "--url", self.housekeeping, "--timeout", 0.5, "stop")
        self.assertEqual(elsewhere.returncode, 1, "the command line takes precedence")
        by_own_names = self.command("--url", self.control, "--url", f"housekeeping={self.housekeeping}",
                                    "--key", key, "--timeout", 0.5, "stop")  # fmt: skip
        self.assertEqual(by_own_names.returncode, 1, by_own_names.stdout)


if __name__ == "__main__":
    unittest.main()
