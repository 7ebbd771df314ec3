"""The true shape, mesh and contact, as palpate-sim publishes them
(sim/scenes/truth_publisher.cpp).
"""

from __future__ import annotations

import hashlib

import numpy as np
from object_mesh import ObjectMesh
from palpate import Bus
from palpate.messages import shape_mesh_t, shape_t, truth_contact_t
from plant import Plant
from rigid import Floats, Pose

_CHUNK_VALUES = 14_000  # of a message, so that it fits one datagram (rt/bus/shape_chunks.hpp)


class TruthPublisher:
    """TRUTH_SHAPE, TRUTH_MESH and TRUTH_CONTACT."""

    def __init__(self, bus: Bus, plant: Plant) -> None:
        self._bus, self._plant = bus, plant
        self._hash = _hash(plant.mesh)

    def publish(self, positions: Floats, wrench_O: Floats, X_OG: Pose, utime: int) -> None:
        """The object's state at `utime`."""
        share = _CHUNK_VALUES // 3
        chunks = -(-len(positions) // share)
        for chunk in range(chunks):
            part = positions[chunk * share : (chunk + 1) * share].ravel()
            shape = shape_t()
            shape.utime, shape.mesh_hash, shape.status = utime, self._hash, shape_t.STATUS_CURRENT
            shape.chunk, shape.chunks = chunk, chunks
            shape.node_count, shape.first_node = len(positions), chunk * share
            shape.xyz, shape.xyz_count = part.tolist(), len(part)
            self._bus.publish("TRUTH_SHAPE", shape)
        contact = truth_contact_t()
        contact.utime, contact.grasp_count = utime, 1
        contact.grasp_position = [X_OG.position.tolist(), [0.0] * 3]
        contact.grasp_quaternion = [X_OG.quaternion(), [1.0, 0.0, 0.0, 0.0]]
        contact.grasp_wrench = [wrench_O.tolist(), [0.0] * 6]
        self._bus.publish("TRUTH_CONTACT", contact)

    def publish_mesh(self, utime: int) -> None:
        """Each chunk holds some of the nodes, elements, triangles and clamped nodes."""
        mesh = self._plant.mesh
        fields = {
            "rest_xyz": (mesh.nodes.ravel(), 3),
            "elements": (mesh.elements.ravel(), mesh.elements.shape[1]),
            "triangles": (mesh.triangles.ravel(), 3),
            "constrained": (np.asarray(self._plant.clamped), 1),
        }
        parts = []
        for name, (values, group) in fields.items():
            size = _CHUNK_VALUES // group * group
            parts += [
                (name, first, values[first : first + size]) for first in range(0, len(values), size)
            ]
        for chunk, (name, first, values) in enumerate(parts):
            message = shape_mesh_t()
            message.utime, message.mesh_hash, message.element_kind = utime, self._hash, mesh.kind
            message.chunk, message.chunks = chunk, len(parts)
            message.node_count, message.element_size = len(mesh.nodes), mesh.elements.shape[1]
            if name == "rest_xyz":
                message.first_node = first // 3
            setattr(message, name, values.tolist())
            message.rest_xyz_count = len(message.rest_xyz)
            message.element_index_count = len(message.elements)
            message.triangle_index_count = len(message.triangles)
            message.constrained_count = len(message.constrained)
            self._bus.publish("TRUTH_MESH", message)


def _hash(mesh: ObjectMesh) -> int:
    """Identifies nodes and elements, as a signed 64-bit number."""
    content = mesh.nodes.tobytes() + mesh.elements.tobytes()
    return int.from_bytes(hashlib.sha256(content).digest()[:8], "big", signed=True)
