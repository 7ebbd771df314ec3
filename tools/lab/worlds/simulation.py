"""One tick after another: arm, object, sensors, truth."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from typing import Optional

import numpy as np
from arm import Arm
from obstacles import penetrations
from palpate import Bus
from plant import Plant
from publisher import TruthPublisher
from rigid import Floats, Pose
from scene import Scene
from sensors import Reading, SensorSuite

PERIOD = 1e-3  # s, of a tick
PERIOD_US = 1000
_TRUTH_TICKS = 10  # 100 Hz
_MESH_TICKS = 1000  # 1 Hz


class Simulation:
    """The plant takes a step at every `period`-th tick, with the hand where it is then; its wrench
    acts on the sensor until the next step. In the background, the plant's step begins at its tick
    and is taken into account when it has ended; ticks do not wait for it."""

    def __init__(
        self,
        scene: Scene,
        arm: Arm,
        plant: Plant,
        control: Bus,
        housekeeping: Bus,
        background: bool,
    ) -> None:
        self._arm, self._plant = arm, plant
        self._sensors = SensorSuite(scene, arm)
        self._truth = TruthPublisher(housekeeping, plant)
        self._control = control
        self._plant_ticks = round(plant.period / PERIOD)
        self._pool = ThreadPoolExecutor(1) if background else None
        self._running: Optional[tuple[Future[None], int, Pose]] = None
        self._readings: list[Reading] = []
        self._wrench: Floats = np.zeros(6)
        self._settled: tuple[Floats, Pose, int] = (plant.positions, arm.grasp_in_object(), 0)
        self._published = 0  # tick of the last true shape
        self._obstacles = scene.obstacles
        self._free = np.setdiff1d(np.arange(len(plant.mesh.nodes)), [*plant.clamped, *plant.held])
        self.penetrations = np.zeros(len(scene.obstacles))  # m, of free nodes, largest of the run
        self.start_utime = 0
        self.tick = 0
        self.plant_steps = 0
        self.steps_left_out = 0  # because the previous one had not ended

    @property
    def utime(self) -> int:
        return self.start_utime + PERIOD_US * self.tick

    def settle(self, seconds: float = 2.0) -> None:
        """Lets the object come to rest under its weight before the first tick."""
        X_OG = self._arm.grasp_in_object()
        for _ in range(round(seconds / self._plant.period)):
            self._plant.step(X_OG)
        self._accept(X_OG, 0)

    def advance(self) -> None:
        """One tick, without publishing."""
        self._arm.step(PERIOD * self.tick, PERIOD)
        self.tick += 1
        self._step_plant()
        self._readings = self._sensors.sample(PERIOD_US * self.tick, self.utime, self._wrench)

    def publish(self) -> None:
        for channel, message in self._readings:
            if not self._arm.publish(channel, message):
                self._control.publish(channel, message)

    def publish_truth(self) -> None:
        positions, X_OG, tick = self._settled
        if self.tick % _TRUTH_TICKS == 0 and tick > self._published:
            self._published = tick
            utime = self.start_utime + PERIOD_US * tick
            self._truth.publish(positions, self._wrench, X_OG, utime)
        if self.tick % _MESH_TICKS == 1:
            self._truth.publish_mesh(self.utime)

    def close(self) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True)

    def _step_plant(self) -> None:
        if self._running is not None and self._running[0].done():
            step, tick, X_OG = self._running
            step.result()
            self._running = None
            self._accept(X_OG, tick)
        if self.tick % self._plant_ticks != 0:
            return
        X_OG = self._arm.grasp_in_object()
        if self._pool is None:
            self._plant.step(X_OG)
            self._accept(X_OG, self.tick)
        elif self._running is None:
            self._running = (self._pool.submit(self._plant.step, X_OG), self.tick, X_OG)
        else:
            self.steps_left_out += 1

    def _accept(self, X_OG: Pose, tick: int) -> None:
        self.plant_steps += 1
        self._wrench = self._plant.hand_wrench
        positions = self._plant.positions
        self._settled = (positions, X_OG, tick)
        depths = penetrations(self._obstacles, positions[self._free])
        self.penetrations = np.maximum(self.penetrations, depths)
