#!/usr/bin/env python3
"""The channel table is complete and consistent, and docs/messages.md is generated from it.

usage: channels_test.py ROOT
"""
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(ROOT / "lcmtypes"))
import generate_channels  # noqa: E402

HEADER = ",".join(generate_channels.COLUMNS)
ROW = "FT_WRENCH,arm,ft_wrench_t,control,1000 Hz,sensor,daemon,no,Wrench"


class Channels(unittest.TestCase):
    def test_every_message_type_has_a_channel(self):
        used = {row["type"] for row in generate_channels.read_table()}
        used |= {former for kind in used for former in generate_channels.former_types(kind)}
        self.assertEqual(used, {path.stem for path in (ROOT / "lcmtypes").glob("*_t.lcm")})

    def test_the_page_is_current(self):
        page = (ROOT / "docs" / "messages.md").read_text()
        made = generate_channels.markdown(generate_channels.read_table())
        self.assertEqual(page, made, "run lcmtypes/generate_channels.py --markdown docs/messages.md")

    def test_signed_types_have_a_code(self):
        for row in generate_channels.read_table():
            fields = {name for _, name, _ in generate_channels.fields(row["type"])}
            self.assertEqual("authentication[32]" in fields, row["signed"] == "yes", row["channel"])

    def test_wrong_values_are_named_with_line_and_choices(self):
        right = generate_channels.FOLDER
        cases = {
            "bus: 'radio'; allowed: control": ROW.replace(",control,", ",radio,"),
            "number: 'leg'; allowed": ROW.replace(",arm,", ",leg,"),
            "type: ft_wrong_t": ROW.replace("ft_wrench_t", "ft_wrong_t"),
            "channel: 'ft wrench'": ROW.replace("FT_WRENCH", "ft wrench"),
        }
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "ft_wrench_t.lcm").touch()
            generate_channels.FOLDER = pathlib.Path(folder)
            try:
                for message, row in cases.items():
                    (generate_channels.FOLDER / "channels.csv").write_text(f"{HEADER}\n{ROW}\n{row}\n")
                    with self.assertRaisesRegex(ValueError, "channels.csv:3: " + message):
                        generate_channels.read_table()
            finally:
                generate_channels.FOLDER = right


unittest.main()
