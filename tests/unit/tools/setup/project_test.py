"""State, outdated steps, answers and the written configuration of palpate-setup."""
import json
import os
import pathlib
import tempfile
import time
import unittest

TOOLS = pathlib.Path(os.environ["PALPATE_SOURCE_DIR"], "tools")
import sys  # noqa: E402

sys.path[:0] = [str(TOOLS / "setup"), str(TOOLS / "common")]

import yaml  # noqa: E402

from palpate_common.input_error import InputError  # noqa: E402
from palpate_setup import configuration  # noqa: E402
from palpate_setup.command import STEPS, status_lines  # noqa: E402
from palpate_setup.guide import Guide, next_step  # noqa: E402
from palpate_setup.person import AnswersFile  # noqa: E402
from palpate_setup.programs import Child, Programs  # noqa: E402
from palpate_setup.project import DONE, FAILED, OPEN, OUTDATED, SKIPPED, Project  # noqa: E402
from palpate_setup.questions import CHOICE, FLAG, NUMBER, NUMBERS, TEXT, Question, asked, asked_keys, with_defaults  # noqa: E402
from palpate_setup.step import Result, Setting, Step  # noqa: E402
from palpate_setup.steps import all_steps  # noqa: E402


class First(Step):
    """Reads a length from a file."""

    name, title, about = "first", "First", "a file"

    def questions(self, project):
        return [Question("file", "file", "text"), Question("factor", "factor", NUMBER, "m", 2.0, 0, 10)]

    def questions_to_skip(self, project):
        return [Question("length", "length", NUMBER, "m", low=0, high=10)]

    def run(self, work):
        path = work.file("file")
        value = float(path.read_text()) * work.answers["factor"]
        if value < 0:
            raise InputError(f"{path.name}: {value:g} m; allowed: 0 or more")
        return Result([f"length {value:g} m"], [Setting("object.length", value, "measured; 95 % +- 1 mm")], [path], [], {"length": value})

    def skip(self, work):
        return Result([], [Setting("object.length", work.answers["length"], "typed")], data={"length": work.answers["length"]})


class Second(Step):
    """Doubles it."""

    name, title, about, needs = "second", "Second", "twice", ("first",)

    def questions(self, project):
        return []

    def run(self, work):
        twice = 2 * work.project.data("first")["length"]
        return Result([], [Setting("gate.force", twice)], data={"twice": twice})


class Third(Second):
    name, needs = "third", ("second",)

    def run(self, work):
        return Result([], [], data={"seen": work.project.data("second")["twice"]})


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name, "cell")
        self.folder.mkdir()
        (self.folder / "length.txt").write_text("1.5")

    def project(self):
        return Project(self.folder, [First(), Second(), Third()])

    def guide(self, answers="first: {file: length.txt, length: 0.5}\n"):
        path = self.folder / "answers.yaml"
        path.write_text(answers)
        person = AnswersFile(path, ["first", "second", "third"])
        person.say = lambda text: None
        return Guide(self.project(), Programs(self.folder), person)

    def done(self):
        guide = self.guide()
        for step in guide.project.steps:
            guide.perform(step)
        return guide


class State(Case):
    def test_a_new_folder_is_open_and_a_step_needs_those_before(self):
        guide = self.guide()
        self.assertEqual([guide.project.status(step) for step in guide.project.steps], [OPEN] * 3)
        with self.assertRaisesRegex(InputError, "second needs first"):
            guide.perform(guide.project.steps[1])

    def test_it_is_read_back(self):
        self.done()
        again = self.project()
        self.assertEqual([again.status(step) for step in again.steps], [DONE] * 3)
        self.assertEqual(again.data("third")["seen"], 6.0)
        self.assertIsNone(next_step(again))
        self.assertIn("first", status_lines(again)[0])

    def test_a_changed_file_makes_all_later_steps_outdated_and_names_it(self):
        self.done()
        (self.folder / "length.txt").write_text("2.5")
        project = self.project()
        self.assertEqual([project.status(step) for step in project.steps], [OUTDATED] * 3)
        self.assertIn("length.txt has changed", project.why_outdated(project.steps[2]))
        self.assertEqual(next_step(project).name, "first")

    def test_a_repeated_step_with_the_same_result_leaves_the_others_as_they_are(self):
        guide = self.done()
        guide.perform(guide.project.steps[0])
        self.assertEqual([guide.project.status(step) for step in guide.project.steps], [DONE] * 3)

    def test_a_repeated_step_with_another_result_makes_the_others_outdated(self):
        self.done()
        guide = self.guide("first: {file: length.txt, factor: 3}\n")
        guide.perform(guide.project.steps[0])
        self.assertEqual([guide.project.status(step) for step in guide.project.steps], [DONE, OUTDATED, OUTDATED])
        self.assertIn("first has another result", guide.project.why_outdated(guide.project.steps[2]))

    def test_a_step_that_stops_keeps_the_earlier_result_and_its_reason(self):
        self.done()
        (self.folder / "length.txt").write_text("-1")
        guide = self.guide()
        with self.assertRaisesRegex(InputError, "allowed: 0 or more"):
            guide.perform(guide.project.steps[0])
        project = self.project()
        self.assertEqual(project.status(project.steps[0]), FAILED)
        self.assertIn("-2 m", project.entry("first")["reason"])
        self.assertIn(Setting("object.length", 3.0, "measured; 95 % +- 1 mm"), project.settings())
        self.assertIn("-2 m", (self.folder / "report.html").read_text())

    def test_a_skipped_step_has_typed_values(self):
        guide = self.guide()
        guide.perform(guide.project.steps[0], skip=True)
        self.assertEqual(guide.project.status(guide.project.steps[0]), SKIPPED)
        self.assertEqual(yaml.safe_load((self.folder / "palpate.yaml").read_text()), {"object": {"length": 0.5}})

    def test_a_state_of_another_kind_is_refused(self):
        (self.folder / "setup.json").write_text(json.dumps({"version": 99, "steps": {}}))
        with self.assertRaisesRegex(InputError, "version 99; allowed: 1"):
            self.project()


class Configuration(Case):
    def test_comments_state_where_each_number_comes_from(self):
        self.done()
        text = (self.folder / "palpate.yaml").read_text()
        self.assertIn("All steps are done.", text)
        self.assertRegex(text, r"  # measured; 95 % \+- 1 mm\n  length: 3.0\n")
        self.assertEqual(yaml.safe_load(text), {"object": {"length": 3.0}, "gate": {"force": 6.0}})

    def test_own_keys_win_and_are_named(self):
        (self.folder / "own.yaml").write_text("object: {length: 7}\nloop: {cpu: 1}\nframes: {a: {position: [1, 2, 3]}}\n")
        self.done()
        text = (self.folder / "palpate.yaml").read_text()
        self.assertEqual(yaml.safe_load(text), {"loop": {"cpu": 1}, "frames": {"a": {"position": [1, 2, 3]}},
                                                "object": {"length": 7}, "gate": {"force": 6.0}})
        self.assertIn("# own.yaml\n  length: 7", text)

    def test_a_later_pose_replaces_all_of_an_earlier_one(self):
        text = configuration.text_of([Setting("frames.x", {"position": [0, 0, 1], "rpy_deg": [0, 0, 9]}, "typed"),
                                      Setting("frames.x", {"position": [0, 0, 2], "quaternion": [1, 0, 0, 0]}, "measured")], "h")
        self.assertEqual(yaml.safe_load(text), {"frames": {"x": {"position": [0, 0, 2], "quaternion": [1, 0, 0, 0]}}})

    def test_an_empty_value_removes_what_was_there(self):
        text = configuration.text_of([Setting("estimation.a", 1), Setting("estimation.b", 2), Setting("estimation", None),
                                      Setting("estimation.component", "pose_driven")], "h")
        self.assertEqual(yaml.safe_load(text), {"estimation": {"component": "pose_driven"}})

    def test_numbers_survive(self):
        values = {"sensing": [{"payload": {"mass": 4.8, "bias": [1e-7, -2.0]}, "use_imu": True}], "loop": {"a": 1e-9, "b": 3.0e10}}
        settings = [Setting("sensing", values["sensing"], "a"), Setting("loop.a", 1e-9, "b"), Setting("loop.b", 3.0e10, "b")]
        self.assertEqual(yaml.safe_load(configuration.text_of(settings, "h")), values)


class Answers(Case):
    def refused(self, text, *parts):
        guide = self.guide(text)
        with self.assertRaises(InputError) as caught:
            guide.perform(guide.project.steps[0])
        for part in ("answers.yaml", *parts):
            self.assertIn(part, str(caught.exception))
        self.assertEqual(caught.exception.exit_code, 78)

    def test_wrong_ones_are_named_with_file_line_key_and_range(self):
        self.refused("first:\n  file: length.txt\n  factor: 11\n", ":3", "first.factor", "11", "0 to 10")
        self.refused("first: {file: length.txt, fctor: 1}\n", "first.fctor", "unknown", "factor")
        self.refused("first: {}\n", "first.file", "required")

    def test_unknown_steps_are_errors(self):
        (self.folder / "answers.yaml").write_text("frist: {}\n")
        with self.assertRaisesRegex(InputError, "frist"):
            AnswersFile(self.folder / "answers.yaml", ["first"])

    def test_commands_are_read(self):
        (self.folder / "answers.yaml").write_text("commands: {first: sleep 9}\n")
        person = AnswersFile(self.folder / "answers.yaml", ["first", "second"])
        self.assertEqual((person.command("first"), person.command("second")), ("sleep 9", None))

    def test_typed_answers(self):
        number = Question("n", "n", NUMBER, "m", 2.0, 0, 10)
        self.assertEqual((number.parse(""), number.parse(" 3e0 ")), (2.0, 3.0))
        for text in ("eleven", "11", "1 2"):
            self.assertRaises(InputError, number.parse, text)
        self.assertEqual(Question("v", "v", NUMBERS, "m", low=-1, high=1).parse("0, 0.5 -1"), [0.0, 0.5, -1.0])
        self.assertIs(Question("f", "f", FLAG, default=False).parse("yes"), True)
        self.assertRaises(InputError, Question("f", "f", FLAG, default=False).parse, "perhaps")
        self.assertRaises(InputError, Question("c", "c", CHOICE, choices=("a", "b")).parse, "c")
        self.assertIsNone(Question("o", "o", NUMBER, "m", None, 0, 1).parse(""))
        self.assertRaises(InputError, Question("r", "r", NUMBER, "m", low=0, high=1).parse, "")

    def test_conditions_and_earlier_answers(self):
        questions = [Question("a", "a", CHOICE, default="x", choices=("x", "y")),
                     Question("b", "b", NUMBER, "m", 1.0, 0, 2, when=lambda a: a["a"] == "y")]
        self.assertEqual(asked(questions, lambda question: question.parse("")), {"a": "x"})
        for typed, keys in (({}, ["a"]), ({"a": "y", "b": "much"}, ["a", "b"]), ({"a": "nonsense", "b": "1"}, ["a"])):
            self.assertEqual(asked_keys(questions, typed), keys, typed)
        of_file = [Question("file", "file", TEXT), Question("edge", "edge", NUMBER, "m", None, 0, 1, when=lambda a: a["file"].endswith(".stl"))]
        self.assertEqual(asked_keys(of_file, {}), ["file"])
        self.assertEqual(asked_keys(of_file, {"file": "a.stl"}), ["file", "edge"])
        known = with_defaults(questions, {"a": "y", "b": 5})  # 5 is no longer allowed
        self.assertEqual(asked(known, lambda question: question.parse("")), {"a": "y", "b": 1.0})


def runs(number):
    """Whether a process exists and is no zombie."""
    try:
        return pathlib.Path(f"/proc/{number}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


class Interface(unittest.TestCase):
    def test_the_command_line_names_all_steps_in_their_order(self):
        self.assertEqual(tuple(step.name for step in all_steps()), STEPS)

    def test_steps_need_earlier_ones_only(self):
        for number, step in enumerate(all_steps()):
            self.assertLessEqual(set(step.needs), set(STEPS[:number]), step.name)
            self.assertTrue(step.title and step.about, step.name)

    def test_a_child_ends_with_what_it_started(self):
        with tempfile.TemporaryDirectory() as folder:
            log = pathlib.Path(folder, "log")
            with Child(["sleep 60 & echo begun $!; wait"], log, shell=True) as child:
                child.wait_for("begun")
                number = int(child.said().split()[1])
            self.assertFalse(child.is_running())
            end = time.monotonic() + 20
            while runs(number) and time.monotonic() < end:
                time.sleep(0.02)
            self.assertFalse(runs(number))
            ended = Child(["echo wrong; exit 3"], log, shell=True)
            with self.assertRaisesRegex(InputError, "(?s)ended with 3.*wrong"):
                ended.wait_for("never", 10)


if __name__ == "__main__":
    unittest.main()
