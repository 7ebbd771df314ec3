"""palpate-see: from clouds to observations."""

from __future__ import annotations

import argparse
import sys
import time
from typing import Iterator, Optional

from palpate_common.input_error import WRONG_CONFIGURATION, InputError
from palpate_common.json_output import write_json
from palpate_see.cloud import Cloud
from palpate_see.configuration import Settings, read_settings
from palpate_see.counters import Counters
from palpate_see.file_source import read_clouds, read_images
from palpate_see.log_source import read_joints, read_log
from palpate_see.outputs import BusOutput, Output, file_output
from palpate_see.pipeline import Pipeline
from palpate_see.robot_body import RobotBody

FOREVER = 1e9  # s


def _pipeline(settings: Settings, options: argparse.Namespace) -> tuple[Pipeline, Optional[RobotBody]]:
    """With the robot's body, which knows the states of the logs; None if the robot is not removed."""
    if settings.robot is None:
        return Pipeline(settings), None
    logs = [path for path in (options.log, options.joints) if path]
    body = RobotBody(settings.robot, keeps_all=bool(logs))
    pipeline = Pipeline(settings, body)
    for path in logs:
        pipeline.counters.refused_states += read_joints(path, body, settings.own_names)
    return pipeline, body


def _source(settings: Settings, options: argparse.Namespace) -> Iterator[tuple[Optional[Cloud], Optional[int]]]:
    """Clouds of files, and when each was received, us; None in place of a malformed one."""
    if options.log:
        yield from read_log(options.log, settings.channel)
        return
    if options.images:
        if settings.intrinsics is None:
            raise InputError(f"{options.config}: intrinsics: is absent; required by --images", WRONG_CONFIGURATION)
        clouds = read_images(options.images, settings.intrinsics, settings.edges)
    else:
        clouds = read_clouds(options.clouds)
    for cloud in clouds:
        yield cloud, None


class _Reports:
    """The counters on a terminal, at most once a second, and at the end as JSON."""

    def __init__(self, counters: Counters, json_file: Optional[str]) -> None:
        self._counters, self._json_file = counters, json_file
        self._last = time.monotonic()

    def show(self) -> None:
        print(self._counters.line(), file=sys.stderr if self._json_file == "-" else sys.stdout, flush=True)

    def show_in_turn(self) -> None:
        if time.monotonic() - self._last >= 1:
            self._last = time.monotonic()
            self.show()

    def end(self) -> None:
        self.show()
        if self._json_file:
            write_json(self._counters.as_json(), self._json_file)


def _from_files(settings: Settings, options: argparse.Namespace, pipeline: Pipeline, reports: _Reports) -> None:
    source = _source(settings, options)
    first = next(source, None)  # what cannot be read leaves no empty output
    output = file_output(options.output)
    try:
        while first is not None:
            cloud, received = first
            if cloud is None:
                pipeline.counters.refuse_cloud("malformed")
            else:
                observation = pipeline.process(cloud, received)
                if observation is not None:
                    output.write(observation)
            reports.show_in_turn()
            first = next(source, None)
    finally:
        output.close()


def _from_network(settings: Settings, options: argparse.Namespace, pipeline: Pipeline, body: Optional[RobotBody],
                  reports: _Reports) -> None:  # fmt: skip
    from palpate_see.live import Live

    outputs: list[Output] = [BusOutput(settings.control_url, settings.own_names)]
    if options.output:
        outputs.append(file_output(options.output))
    live = Live(settings, pipeline, body, outputs)
    try:
        live.run(options.seconds or FOREVER, reports.show)
    finally:
        live.close()
        for output in outputs:
            output.close()


def run(options: argparse.Namespace) -> int:
    """Publishes or writes. Returns the exit code. Raises InputError and OSError."""
    settings = read_settings(options.config)
    for obstacle in settings.obstacles:
        if obstacle.is_moved:
            print(f"palpate-see: obstacle {obstacle.name}: messages move it; it is not removed from clouds", file=sys.stderr)
    if options.check:
        print("the configuration is valid")
        return 0
    pipeline, body = _pipeline(settings, options)
    reports = _Reports(pipeline.counters, options.json)
    if options.log or options.clouds or options.images:
        _from_files(settings, options, pipeline, reports)
    else:
        _from_network(settings, options, pipeline, body, reports)
    reports.end()
    return 0
