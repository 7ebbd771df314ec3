"""Standard deviations and ranges where the command line states none."""

import numpy as np

from palpate_calibrate.camera.depth_error import DepthError
from palpate_calibrate.camera.flange_poses import ArmError

DEPTH = DepthError(2e-3, 1.5e-3)  # m at 1 m: a camera of the first Kinect's class
ARM_DEGREES = 0.05
ARM = ArmError(3e-4, float(np.radians(ARM_DEGREES)))  # m, rad: of a flange's pose, the part that varies from pose to pose
TOUCH_DEVIATION = 3e-4  # m, each axis
PICK_RADIUS = 0.01  # m, around a pick, of the cloud's points that give its depth
REACH = 0.1  # m: points farther from the tool, at the guess, are left out
SIDE_ERROR = 0.005  # relative, of a printed marker's side
CORNER_DEVIATION = 0.05  # px
PLACE = (5e-4, 0.1)  # m, degrees: of a marker on a known place
