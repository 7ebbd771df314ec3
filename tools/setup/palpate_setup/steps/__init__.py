"""The steps of a set-up, in their order."""

from __future__ import annotations

from palpate_setup.step import Step
from palpate_setup.steps.channels import Channels
from palpate_setup.steps.machine import Machine
from palpate_setup.steps.material import Material
from palpate_setup.steps.motion import Motion
from palpate_setup.steps.object import Object
from palpate_setup.steps.registration import Registration
from palpate_setup.steps.wrist import Wrist


def all_steps() -> list[Step]:
    """New ones."""
    return [Machine(), Channels(), Wrist(), Object(), Registration(), Material(), Motion()]
