"""Common parts of the Python package's tests."""

import os
import random
import unittest

import palpate

SOURCE = os.environ["PALPATE_SOURCE_DIR"]


def private_url() -> str:
    """A multicast group that no other test uses at this time, limited to this machine."""
    generator = random.SystemRandom()
    return f"udpm://239.255.{generator.randint(160, 250)}.{generator.randint(1, 250)}:" \
           f"{generator.randint(10000, 32000)}?ttl=0"  # fmt: skip


def require_multicast() -> None:
    """Skips the test if this machine has no multicast."""
    try:
        with palpate.Bus(private_url()) as bus:
            subscription = bus.subscribe("SIM_TICK")
            bus.publish("SIM_TICK", palpate.messages.sim_tick_t())
            subscription.get(2)
    except OSError as error:
        raise unittest.SkipTest(f"multicast does not work here: {error}") from None


def tetrahedra(size: float = 1.0) -> palpate.Mesh:
    """A cube of five tetrahedra."""
    import numpy as np

    nodes = size * np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    elements = np.array([[0, 1, 2, 4], [3, 2, 1, 7], [5, 4, 7, 1], [6, 7, 4, 2], [1, 2, 4, 7]])
    return palpate.Mesh(7, 0, nodes, elements, np.zeros((0, 3), int), np.zeros(0, int))
