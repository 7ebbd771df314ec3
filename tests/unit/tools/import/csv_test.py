"""CSV files to messages: times, columns, units, heads with comments, and what is wrong with them."""

import gzip
import json
import math
import os
import pathlib
import unittest

from support import WRENCH, ImportTest

import numpy as np
import palpate

from palpate_import.fields import FORMATS, formats_page
from palpate_import.layouts import TYPES, empty_messages


class Layouts(unittest.TestCase):
    def test_are_those_of_the_generated_types(self):
        random = np.random.default_rng(1)
        for name, kind in TYPES.items():
            made = empty_messages(name, 1)
            for field in made.dtype.names[1:]:
                shape = made[field].shape
                made[field] = (
                    random.normal(size=shape) if made.dtype[field].base.kind == "f" else random.integers(-99, 99, shape)
                )
            message = getattr(palpate.messages, kind).decode(made.tobytes())
            self.assertEqual(message.encode(), made.tobytes(), name)
            for field in made.dtype.names[1:]:
                self.assertEqual(np.ravel(getattr(message, field)).tolist(), made[field].ravel().tolist(), (name, field))


class Csv(ImportTest):
    def test_times_sequence_and_session(self):
        self.write(WRENCH + "0.5,1,2,3,4,5,6\n0.501,-1,0,0,0,0,1e-3\n")
        events = self.imported(*self.of("force_torque", "--start", 10, "--json", self.folder / "out.json"))["CHANNEL"]
        self.assertEqual(len(events), 2)
        utime, message = events[1]
        self.assertEqual((utime, message.utime, message.seq, message.session), (10501000, 10501000, 1, 42))
        self.assertEqual((message.wrench[0], message.wrench[5]), (-1, 1e-3))
        report = json.loads((self.folder / "out.json").read_text())
        self.assertEqual((report["rows"], report["messages"], report["session"]), (2, {"CHANNEL": 2}, 42))
        self.assertEqual(report["channels"]["CHANNEL"]["rate"], 1000)

    def test_columns_units_signs_and_constants(self):
        self.write("stamp,acc_a,acc_b,gyro\n1000,1,-2,90\n")
        utime, message = self.imported(*self.of("imu"), "--time-column", "stamp", "--time-unit", "us", "--column", "ax=-acc_b:g", "--column",
                                       "ay=acc_a:g", "--column", "az==0.5", "--column", "wz=-gyro:deg/s")["CHANNEL"][0]  # fmt: skip
        self.assertEqual(utime, 1000)
        np.testing.assert_allclose(message.acceleration, [2 * 9.80665, 9.80665, 0.5], rtol=1e-14)
        np.testing.assert_allclose(message.angular_velocity, [0, 0, -math.pi / 2], rtol=1e-14)

    def test_a_robot_state(self):
        self.write("t,px,py,pz,qw,qx,qy,qz,vz,wx,j1,j2\n0,1,2,3,0,1,0,0,0.1,0.2,90,-45\n")
        (message,) = self.messages(*self.of("robot_state"), "--column", "q1=j1:deg", "--column", "q2=j2:deg")
        self.assertEqual(message.joint_count, 2)
        self.assertAlmostEqual(message.q[1], -math.pi / 4, 14)
        self.assertEqual((message.position[2], message.quaternion[1], message.twist[2], message.twist[3]), (3, 1, 0.1, 0.2))

    def test_a_biotac_has_what_its_columns_are(self):
        names = [f"e{i}" for i in range(1, 20)]
        row = ",".join(["2030", "2095", "1972", *(str(3000 + i) for i in range(1, 20))])
        self.write(",".join(["pac0", "pac1", "pdc", *names]) + f"\n{row}\n{row}\n")
        events = self.imported(*self.of("biotac"), "--rate", 100)["CHANNEL"]
        self.assertEqual(events[1][0], 10000)
        message = events[0][1]
        self.assertEqual((message.valid, message.pac_count, message.pac[1], message.electrodes[18]), (7, 2, 2095, 3019))
        self.csv.write_text(self.csv.read_text().replace("3019", "40000"))
        self.log.unlink()
        self.assertIn("in.csv:2:e19: 40000 does not fit 16 bits", self.refused(*self.of("biotac"), "--rate", 100))

    def test_only_the_rows_asked_for(self):
        self.write("t,finger,fx,fy,fz,tx,ty,tz\n0,a,1,0,0,0,0,0\n0.1,b,2,0,0,0,0,0\n0.2,a,3,0,0,0,0,0\n")
        self.assertEqual([m.wrench[0] for m in self.messages(*self.of("force_torque", "--where", "finger=a"))], [1, 3])

    def test_compressed_files(self):
        self.csv.write_bytes(gzip.compress((WRENCH + "0,1,2,3,4,5,6\r\n").replace("\n", "\r\n", 1).encode()))
        self.assertEqual(self.messages(*self.of("force_torque"))[0].wrench[5], 6)

    def test_quotes_and_delimiters(self):
        row = '0;1;2;3;4;5;6;"a; b\nc" \n'
        for text in ("\"t\" ;fx;fy;fz;tx;ty;tz;note\n" + row, ("t;fx;fy;fz;tx;ty;tz;note\n" + row).replace(";", "\t").replace("a\t", "a;"),
                     WRENCH.replace(",", " ") + "0  1 2 3 4 5 6 \n"):  # fmt: skip
            self.write(text)
            self.assertEqual(self.messages(*self.of("force_torque"))[0].wrench[5], 6, text)
        self.log.unlink()
        self.write("t;fx\n0;1\n")
        self.assertIn("no columns 't', 'fx'", self.refused(*self.of("force_torque", "--delimiter", "comma")))

    def test_heads_with_comments_and_units(self):
        data = "500,1,2,3,4,5,6\n"
        heads = ["# of the wrist\n\n% made by hand\ntime [ms],fx [mN],fy (mN),fz,tx [N·mm],ty,tz\n# between\n",
                 "time,fx,fy,fz,tx,ty,tz\nms,mN,mN,N,Nmm,Nm,Nm\n", "# time,fx,fy,fz,tx,ty,tz\n# ms,mN,mN,N,Nmm,Nm,Nm\n",
                 "# ms, mN, mN, N, N mm, Nm, Nm\ntime,fx,fy,fz,tx,ty,tz\n"]  # fmt: skip
        for head in heads:
            self.write(head + data)
            utime, message = self.imported(*self.of("force_torque", "--time-column", "time"))["CHANNEL"][0]
            self.assertEqual(utime, 500000, head)
            np.testing.assert_allclose(message.wrench, [1e-3, 2e-3, 3, 4e-3, 5, 6], rtol=1e-14, err_msg=head)
        stated = self.messages(*self.of("force_torque", "--time-column", "time", "--column", "fx=fx:kN"))
        self.assertEqual(stated[0].wrench[0], 1000)  # the command line has precedence
        self.log.unlink()
        self.write(heads[1].replace("mN", "lbf", 1) + data)
        self.assertIn(
            "field fx: 'fx': unit 'lbf' in the head of",
            self.refused(*self.of("force_torque", "--time-column", "time"), code=78),
        )
        self.write("0,1,2\n1,2,3\n")
        self.assertIn("in.csv:1: the first line has numbers only", self.refused(*self.of("force_torque")))

    def test_names_with_brackets_are_elements(self):
        self.write("t, q[0], q[1]\n0,1,2\n")
        self.assertEqual(self.messages(*self.of("hand_state", "--column", "q1=q[1]"))[0].q[0], 2)

    def test_complaints_name_file_line_and_column(self):
        wrench = self.of("force_torque")
        self.assertIn("in.csv: No such file", self.refused(*wrench))
        row = "0,1,2,3,4,5,6\n"
        for text, expected in [
            ("", "in.csv: the file is empty"),
            ("t,fx,fy,fz,tx,ty\n0,1,2,3,4,5\n", "no column 'tz'; the columns are t, fx"),
            (WRENCH + row + "\n0.1,1,2,3,4,five,6\n", "in.csv:4:ty: 'five' is not a number"),
            (WRENCH + row + "0.1,1,nan,3,4,5,6\n", "in.csv:3:fy: 'nan' is not finite"),
            (WRENCH + row + "0.1,1,2,3,4,1_0,6\n", "in.csv:3:ty: '1_0' is not a number"),
            (WRENCH.replace(",", ";") + "0;1,5;2;3;4;5;6\n", "in.csv:2:fx: '1,5' is not a number; decimals have a point"),
            (WRENCH + row + "0.1,1,2,3,4,5\n", "in.csv:3: has 6 cells, the header 7"),
            (WRENCH + row + "-0.1,1,2,3,4,5,6\n", "in.csv:3:t: time goes back by 100000 us"),
            (WRENCH + "-1,1,2,3,4,5,6\n", "in.csv:2:t: time -1 s; allowed: 0 or later"),
            (WRENCH + row + '0.1,"1,2,3,4,5,6\n', "in.csv:3: a quote is not closed"),
            ("t,fx,fx\n", "two columns are named 'fx'"),
            (WRENCH, "no row to import"),
        ]:
            self.write(text)
            self.assertIn(expected, self.refused(*wrench))
        self.csv.write_bytes(b"t,fx\n\xff\xfe\n")
        self.assertIn("in.csv: is not text in UTF-8", self.refused(*wrench))

    def test_mappings_that_make_no_sense(self):
        self.write("t,fx,fy,fz,tx,ty,tz,q\n0,1,2,3,4,5,6,7\n")
        for words, expected in [(["--column", "force=fx"], "no field 'force'; its fields: fx, fy"),
                                (["--column", "fx=fx:deg"], "unknown unit 'deg'; allowed: N, kN, mN"),
                                (["--column", "fx==two"], "field fx: '=two'"), (["--channel", "no spaces"], "channel 'no spaces'")]:  # fmt: skip
            self.assertIn(expected, self.refused(*self.of("force_torque", *words), code=78))
        pose = [word for name, value in zip(["px", "py", "pz", "qw", "qx", "qy", "qz"], ["=0", "=0", "=0", "fx", "fy", "=0", "=0"])
                for word in ("--column", f"{name}={value}")]  # fmt: skip
        self.assertIn("in.csv:2: the quaternion is not of unit length", self.refused(*self.of("robot_state", *pose)))
        for words in (
            [],
            ["--format", "imu"],
            ["--preset", "ur_rtde", "--format", "imu", "--channel", "IMU"],
            ["--format", "force_plate"],
        ):
            self.refused(self.csv, *words, code=64)

    def test_observations(self):
        self.write("t,x,y,z\n0,1,2,3\n0,4,5,6\n0.1,7,8,9\n")
        made = self.messages(*self.of("shape_observation", "--column", "deviation==0.002"))
        self.assertEqual(
            [(m.count, m.deviation, m.points[0][0], m.points[1][2]) for m in made], [(2, 0.002, 1, 6), (1, 0.002, 7, 0)]
        )
        self.write("t,x1,y1,z1,x2,y2,z2\n0,1,2,3,,,\n0.1,1,2,3,4,nan,6\n0.2,1,2,3,4,5,6\n")
        made = self.messages(*self.of("shape_observation", "--column", "deviation==1:mm"[:-3]))
        self.assertEqual([m.count for m in made], [1, 1, 2])
        self.log.unlink()
        self.write("t,x,y,z\n" + "0,1,2,3\n" * 257)
        self.assertIn(
            "in.csv:2: 257 points of one time; allowed: at most 256",
            self.refused(*self.of("shape_observation", "--column", "deviation==1")),
        )
        self.write("t,x1,y1,z2\n0,1,2,3\n")
        self.assertIn("point 1 has no z1", self.refused(*self.of("shape_observation", "--column", "deviation==1"), code=78))

    def test_hands(self):
        self.write("t,f0px,f0py,f0pz,f0qw,f0qx,f0qy,f0qz,q1,grasp\n0,1,2,3,0,1,0,0,5,1\n")
        (message,) = self.messages(*self.of("hand_state"))
        self.assertEqual(
            (message.fingertip_count, message.fingertip_position[0], message.fingertip_quaternion[0]),
            (1, (1, 2, 3), (0, 1, 0, 0)),
        )
        self.assertEqual((message.grasp, message.joint_count, message.q[0]), (1, 1, 5))
        self.log.unlink()
        self.write("t,f1px,grasp\n0,1,1\n")
        self.assertIn("fingertip 1 has no f1py", self.refused(*self.of("hand_state")))
        self.write("t,grasp\n0,4\n")
        self.assertIn("in.csv:2: grasp: 4; allowed: 0, 1, 2", self.refused(*self.of("hand_state")))


class Page(unittest.TestCase):
    def test_names_every_fields_unit_and_whether_it_is_required(self):
        page = formats_page()
        for name in FORMATS:
            self.assertIn(f"\n## {name}\n", page)
        for line in (
            "| `fx`, `fy`, `fz` | N (kN, mN) | yes | force",
            "| `q1` to `q16` | rad (deg) | no | joint positions",
            "| `qw`, `qx`, `qy`, `qz` | - | yes | orientation",
            "| `x1` to `x256`, `y1` to `y256`, `z1` to `z256` | m",
        ):
            self.assertIn(line, page)


class FoamBar(ImportTest):
    def test_the_recording(self):
        data = pathlib.Path(os.environ.get("PALPATE_DATA", "../shared/data")) / "biotac_foam_bar/ring_finger_dev.csv"
        if not data.exists():
            self.skipTest(f"{data} is absent")
        made = self.imported(data, "--preset", "biotac_foam_bar")
        table = np.genfromtxt(data, delimiter=",", names=True)
        self.assertEqual([message.electrodes[18] for _, message in made["BIOTAC_0"]], table["e19"].tolist())
        self.assertEqual([message.pdc for _, message in made["BIOTAC_0"]], table["pdc"].tolist())
        self.assertEqual([message.wrench[2] for _, message in made["FT_TRUTH"]], table["fz"].tolist())
        self.assertEqual({message.valid for _, message in made["BIOTAC_0"]}, {15})
        self.assertEqual(
            [event.channel for event, _ in zip(palpate.EventLog(self.log), range(4))], ["BIOTAC_0", "FT_TRUTH"] * 2
        )


if __name__ == "__main__":
    unittest.main(verbosity=2)
