"""Expected content of an image of a mesh: visible triangles, and the colours of its nodes."""
import numpy as np

VIRIDIS = np.array([[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
                    [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]])


def viridis(share):
    share = np.clip(share, 0, 1)
    return np.column_stack([np.interp(share, np.linspace(0, 1, 9), VIRIDIS[:, c]) for c in range(3)])


def visible(pixels, triangles):
    """Triangles that are not occluded at their centre, and which are not too small."""
    corners = pixels[triangles]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]

    def cross(u, v):
        return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]

    area = cross(b - a, c - a)
    middle = corners.mean(axis=1)
    found = []
    for t in np.nonzero(np.abs(area) > 120)[0]:
        p = middle[t]
        weights = np.column_stack([cross(b - p, c - p), cross(c - p, a - p), cross(a - p, b - p)])
        with np.errstate(divide="ignore", invalid="ignore"):
            weights = weights / area[:, None]
            inside = (weights > -0.02).all(axis=1)
            depth = (weights * corners[:, :, 2]).sum(axis=1)
        if not (inside & (depth < p[2] - 1e-6)).any():
            found.append(t)
    return np.array(found), middle
