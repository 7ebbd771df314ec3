"""The page of a study: its tables, and plots and pictures of each method's first seed, from the JSON
file that palpate-evaluate writes.
"""
import json

from page import Markup, curve, document, draw, element, figure, picture, table

ABOUT = """Simulator and daemon run as separate programs over LCM; every figure is taken on the
simulated plant's truth, which the daemon cannot read. Shape error is the distance of the estimate's
nodes from where the plant's material is, over the last half second of a state, in mm, in % of the
object's largest side and of its largest true displacement. Hausdorff: the larger of the largest
distances of either surface from the other. Octree agreement: the share of one surface's points that
lie in cubes which the other's occupy; the thesis gives neither its resolution nor its formula. Pose
error: estimate minus plant, of the frame through the three points that the thesis uses, in the
object's frame. A figure is the median over the seeds, with its 95 % bootstrap interval in brackets
(of shares Wilson's interval); in summaries over the states, medians of means and of maxima. Latency
is that of a whole cycle of palpated; in lock-step none is measured."""

# (title, label of y, least value drawn; None: a linear axis)
SHAPE = ("Mean shape error", "mm", 1e-3)
POSE = ("Distance of the estimated pose from the plant's", "mm", 1e-3)
FEATURE = ("Distance of the feature from its target", "mm", 1e-2)
CURVATURE = ("Curvature from its target", "1/m", 1e-3)
ANGLE = ("Angle from the target", "degrees", 1e-3)
COMMAND = ("Commanded speed", "mm/s", None)
MODULUS = ("Young's modulus, as estimated", "kPa", None)


def first_seeds(runs, application, level):
    """The first run of each method under a model error, in the order of the plan."""
    found = []
    for method in application["methods"]:
        found += [run for run in runs if run["job"]["application"] == application["name"] and
                  run["job"]["method"] == method and run["job"]["model_error"] == level][:1]
    return found


def over_time(data, values, least):
    """(times, values, at least as large as drawn); None if the run has no such curve."""
    if not data or values not in data:
        return None
    floor = 0 if least is None else least
    return data["time_s"], [max(floor, value) for value in data[values]]


def poses(states):
    """The pose's error in one state after the other, as in the thesis' Fig. 4.15."""
    found = [(i, max(POSE[2], state["pose_mm"])) for i, state in enumerate(states, 1) if "pose_mm" in state]
    return tuple(zip(*found)) or None


def curves_of(run):
    """(plot, suffix of the name, (x, y) or None, whether it is dashed) of one run."""
    control = run.get("control") or {}
    yield SHAPE, "", over_time(run.get("shape_error"), "mean_mm", SHAPE[2]), False
    yield POSE, "", poses(run.get("states", [])), False
    for plot, values in ((FEATURE, "mm"), (CURVATURE, "per_m"), (ANGLE, "deg")):
        for side, dashed in (("plant", False), ("estimate", True)):
            if plot is not ANGLE or side == "plant":
                yield plot, f", {side}", over_time(control.get(side), values, plot[2]), dashed
    yield COMMAND, "", over_time(control.get("command"), "mm_per_s", None), False
    yield MODULUS, "", over_time((run.get("belief") or {}).get("curve"), "young_modulus_kpa", None), False


def panels_of(kind, runs, level):
    """The plots of an application under a model error; those without a curve are left out."""
    plots = {plot: [] for plot in ([SHAPE, FEATURE, CURVATURE, ANGLE, COMMAND, MODULUS]
                                   if kind == "control" else [SHAPE, POSE, MODULUS])}
    for colour, run in enumerate(runs):
        for plot, suffix, points, dashed in curves_of(run):
            if points and plot in plots:
                plots[plot].append(curve(run["job"]["method"] + suffix, *points, colour, dashed))
    return [{"title": f"{title}, model error: {level}", "x": "state" if title == POSE[0] else "time, s",
             "y": y, "logarithmic": least is not None, "curves": curves}
            for (title, y, least), curves in plots.items() if curves]


def file_name(title):
    return "".join(c if c.isascii() and c.isalnum() else "_" for c in title)


def pictures_of(runs, folder):
    for run in runs:
        job = run["job"]
        for state in run.get("states", []):
            if state.get("picture"):
                yield picture(folder / job["name"] / state["picture"],
                              f"{state['name']}, {job['method']}, model error: {job['model_error']}, seed "
                              f"{job['seed']}: measured ({state.get('measured', 'not available')}), "
                              "estimate, both")


def section_of(application, study, folder):
    out = [element("h2", application["name"]),
           element("p", f"Kind: {application['kind']}; scene {application['scene']}, configuration "
                        f"{application['configuration']}; octree resolution "
                        f"{study['octree_resolution_mm']:.1f} mm.")]
    if application["note"]:
        out.append(element("p", application["note"]))
    for part in application["tables"]:
        out += [element("h3", part["title"]), table(part["header"], part["rows"], figures=True)]
    for level in application["model_errors"]:
        runs = first_seeds(study["runs"], application, level)
        if panels := panels_of(application["kind"], runs, level):
            drawn = draw(panels)
            (folder / (file_name(f"{application['name']} {level}") + ".svg")).write_bytes(drawn)
            out.append(figure(drawn, "svg+xml", f"Over time, seed {runs[0]['job']['seed']}"))
        out += pictures_of(runs, folder)
    return Markup("").join(out)


def page_of(study, folder):
    """HTML text of a study, with the pictures below its folder; writes its plots there, too."""
    out = [element("p", " ".join(ABOUT.split())), element("h2", "Host")]
    host = [("version", study["version"])]
    host += [(key, value if isinstance(value, str) else json.dumps(value, separators=(",", ":")))
             for key, value in study["host"].items()]
    out.append(table(["", ""], host))
    if study["failures"]:
        out.append(element("h2", "Jobs that failed"))
        out += [element("pre", failure) for failure in study["failures"]]
    overview = study["overview"]
    out += [element("h2", overview["title"]), table(overview["header"], overview["rows"], figures=True)]
    out += [section_of(application, study, folder) for application in study["applications"]]
    return document(f"palpate: {study['title']}", Markup("").join(out))
