#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the shipped launch file shows in rviz with the shipped configuration, on a screen of its own."""
import json
import os
import shutil
import subprocess
import tempfile
import unittest

import rostest

TIME_LIMIT = 600  # [s]
SCRIPT = os.path.join(os.path.dirname(os.path.realpath(__file__)), '..', '..', 'scripts', 'take_rviz_picture')
# What each display must fill of the 3D view: a third of the least of what was measured [pixels]; of the weak axes less,
# since the ellipsoid grows over them: half of what is left where the picture comes ten seconds late
LEAST = {'scan': 6000, 'map': 6000, 'path': 350, 'weak axes': 60, 'ellipsoid': 130, 'colours': 1500}


def missing_program():
    return next((name for name in ('rviz', 'Xvfb') if shutil.which(name) is None), None)


class Rviz(unittest.TestCase):
    def picture(self, *arguments):
        with tempfile.TemporaryDirectory(prefix='allan_lio_rviz_test_') as folder:
            out = os.path.join(folder, 'rviz.png')
            done = subprocess.run(['/usr/bin/python3', SCRIPT, '--json', '--out', out] + list(arguments),
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True,
                                  timeout=TIME_LIMIT)
            self.assertEqual(done.returncode, 0, done.stderr)
            with open(out, 'rb') as file:
                self.assertEqual(file.read(4), b'\x89PNG')
            return json.loads(done.stdout)

    @unittest.skipIf(missing_program(), '{} is not installed'.format(missing_program()))
    def test_scan_map_path_ellipsoid_and_weak_axis_are_to_be_seen(self):
        seen = self.picture()
        for topic in ('map', 'points', 'path', 'markers', 'odometry'):
            self.assertIn('/lidar_odometry/' + topic, seen['topics'])
        self.assertIn('/tf', seen['topics'])
        for what, least in LEAST.items():
            self.assertGreater(seen['pixels'][what], least, '{} of {}'.format(what, seen['pixels']))

    @unittest.skipIf(missing_program(), '{} is not installed'.format(missing_program()))
    def test_in_the_hall_no_axis_is_weak(self):
        seen = self.picture('--at', '8')
        self.assertLess(seen['pixels']['weak axes'], LEAST['weak axes'], seen['pixels'])


if __name__ == '__main__':
    rostest.rosrun('allan_lio', 'rviz', Rviz)
