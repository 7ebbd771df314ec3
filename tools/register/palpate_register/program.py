"""palpate-register: from files to files."""

from __future__ import annotations

import argparse
import sys
from typing import Optional

import numpy as np

from palpate_common.cloud_files import read_cloud
from palpate_common.input_error import InputError
from palpate_common.json_output import write_json
from palpate_common.mesh_files import read_surface
from palpate_common.pose import Pose
from palpate_common.rotations import from_rpy
from palpate_common.surface import Surface, box_surface
from palpate_register.configuration import Configuration, read_configuration
from palpate_register.next_touch import Reach, next_touches
from palpate_register.observations import Cloud, Guess, Observations, Touches, no_touches
from palpate_register.prior import yaml_text
from palpate_register.register import register
from palpate_register.report import as_json, table
from palpate_register.touch_file import read_touches

GUESSED, GLOBAL = 150, 400  # starts


def _guess(options: argparse.Namespace, configuration: Optional[Configuration]) -> Optional[Guess]:
    if options.no_guess:
        return None
    if options.guess:
        pose = Pose(from_rpy(np.radians(options.guess[3:])), np.array(options.guess[:3]))
    elif configuration is not None and configuration.object_in_base is not None:
        pose = configuration.object_in_base
    else:
        return None
    return Guess(pose, options.guess_range[0], float(np.radians(options.guess_range[1])))


def _observed(options: argparse.Namespace, guess: Optional[Guess]) -> Observations:
    touches: Touches = no_touches()
    if options.touches:
        touches = read_touches(options.touches, options.deviation, float(np.radians(options.normal_deviation)),
                               options.probe_radius, options.common_deviation)  # fmt: skip
    cloud = None
    if options.cloud:
        shift, rotation = options.camera_deviation
        cloud = Cloud(read_cloud(options.cloud), options.cloud_deviation, shift_deviation=shift,
                      rotation_deviation=float(np.radians(rotation)))  # fmt: skip
    observed = Observations(touches, cloud, guess)
    least = 1 if guess else 3
    if len(observed.points) < least:
        raise InputError(f"{options.touches}: {len(observed.points)} touches; allowed: {least} or more, "
                         f"{'with' if guess else 'without'} a guess")  # fmt: skip
    return observed


def _surface(options: argparse.Namespace, configuration: Optional[Configuration]) -> Surface:
    if configuration is not None:
        return configuration.surface
    return read_surface(options.mesh) if options.mesh else box_surface(options.box)


def run(options: argparse.Namespace) -> int:
    """Registers and writes. Returns the exit code. Raises InputError and OSError."""
    configuration = read_configuration(options.config) if options.config else None
    surface = _surface(options, configuration)
    guess = _guess(options, configuration)
    observed = _observed(options, guess)
    starts = options.starts or (GUESSED if guess else GLOBAL)
    result = register(surface, observed, starts, seed=options.seed)
    has_normals = not len(observed.touches) or observed.touches.has_normal.any()
    normal = float(np.radians(options.normal_deviation)) if has_normals else np.inf
    reach = Reach(options.table)
    if configuration is not None and configuration.fixed is not None:
        reach.hidden.append(configuration.fixed)
    proposals = next_touches(surface, result.pose, result.covariance, options.deviation, normal, reach,
                             of_position=options.next_for == "position", count=options.next)  # fmt: skip
    if options.json:
        write_json(as_json(result, observed, proposals), options.json)
    if options.json != "-":
        print(table(result, observed, proposals))
    if options.picture:
        from palpate_register.picture import draw

        draw(surface, result, observed, proposals, options.picture)
    if result.verdict.fits is False:
        print("palpate-register: the mesh does not fit; no configuration is written" if options.output else
              "palpate-register: the mesh does not fit", file=sys.stderr)  # fmt: skip
        return 1
    if options.output:
        options.output.write_text(yaml_text(result, configuration, options.output), encoding="utf-8")
    return 0
