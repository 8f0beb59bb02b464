#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Runs the launch file that ships on a small simulated bag, and compares with the offline runner."""
import json
import math
import os
import shutil
import signal
import subprocess
import tempfile
import unittest

import genpy
import numpy
import rosbag
import rosgraph
import rospy
import rostest
from allan_lio.msg import State
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, PointCloud2
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from odometry_reader import Frames, OdometryReader, rotation_of
from ros_support import TIME_LIMIT, Recording, read, run, run_well, wait_until

K_DEFAULT = 1
# Of the propagated pose from the filter's within 3 ms of it [m]; 0.0020 measured, at 1 m/s
PROPAGATION_TOLERANCE = 0.01
FAR_SHARE = 0.05  # of the messages may lie farther off, on a machine that is busy
# T_imu_lidar of the simulated robot, as its configuration has it
EXTRINSICS = ((0.05, 0.02, 0.10), (1.1423103946452845e-05, -0.0026179659660316213, 0.0043632943319299308,
                                   0.99998705380934128))
BASE_TO_IMU = ((0.3, 0.1, 0.2), (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)))
# Errors of the golden bag against its truth [m]: at most the mean and six standard deviations over 30 seeds of it.
# Measured on 2026-11-28: 30 launches at play rates from 1 to 20 and without one, with none, one and two busy processes
# beside, gave the same bits each time (ATE 0.00156, largest error 0.00682); lio_offline on the seeds 1 to 30 gave an
# ATE of 0.00122 to 0.00316, mean 0.00204, standard deviation 0.00050, and a largest error of 0.0027 to 0.0113, mean
# 0.0059, standard deviation 0.0019.
ATE_TOLERANCE = 0.0051
ERROR_TOLERANCE = 0.0174
# T_map_odom, of a consumer whose world is another frame
MAP_TO_ODOM = ((3.0, -2.0, 1.0), (0.5, 0.5, 0.5, 0.5))

SCAN_INTERVAL, IMU_INTERVAL = 100000000, 5000000  # [ns] of the simulated sensors
STAMP_TOLERANCE = 1000  # [ns], of the point times' rounding
UNIT_TOLERANCE = 1e-9  # of a quaternion's length
ROUNDING = 1e-12  # of the largest eigenvalue
SAME = 1e-9  # [m], [rad] and so on: TF carries a rotation to rounding
POSITION_LIMIT = 16.3  # quantile 0.999 of the chi-square distribution with 3 degrees of freedom
TOPICS = {'/lidar_odometry/odometry': Odometry, '/lidar_odometry/state': State, '/imu_odometry': Odometry,
          '/lidar_odometry/points': PointCloud2, '/lidar_odometry/map': PointCloud2, '/tf': TFMessage,
          '/tf_static': TFMessage}


def finite(message):
    numbers = list(message.pose.covariance) + list(message.twist.covariance)
    position, rotation = message.pose.pose.position, message.pose.pose.orientation
    numbers += [position.x, position.y, position.z, rotation.x, rotation.y, rotation.z, rotation.w]
    return all(math.isfinite(n) for n in numbers)


def components(message):
    """Of a point, vector or quaternion."""
    return [getattr(message, name) for name in message.__slots__]


def flat(odometry):
    """All numbers of its pose and twist."""
    pose, twist = odometry.pose.pose, odometry.twist.twist
    return (components(pose.position) + components(pose.orientation) + list(odometry.pose.covariance) +
            components(twist.linear) + components(twist.angular) + list(odometry.twist.covariance))


def stamps_of(messages):
    return [m.header.stamp.to_nsec() for m in messages]


def eigenvalues(covariance):
    """Ascending, of the 36 numbers of a message; None if it is not symmetric."""
    matrix = numpy.reshape(covariance, (6, 6))
    return numpy.linalg.eigvalsh(matrix) if (matrix == matrix.T).all() else None


def tum(*path):
    """Stamps [ns], positions and rotations of a trajectory."""
    rows = [row.split() for row in read(*path).decode().splitlines() if not row.startswith('#')]
    stamps = [int(seconds) * 10**9 + int(part.ljust(9, '0')) for seconds, part in (row[0].split('.') for row in rows)]
    poses = [(numpy.array(row[1:4], float), rotation_of(*map(float, row[4:8]))) for row in rows]
    return stamps, poses


def transform(parent, child, pose):
    return TransformStamped(Header(frame_id=parent), child, Transform(Vector3(*pose[0]), Quaternion(*pose[1])))


class BagLaunch(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.mkdtemp(prefix='allan_lio_bag_launch_')
        cls.bag = os.path.join(cls.directory, 'small.bag')
        run_well('rosrun', 'allan_lio', 'simulate_bag', '--scene', 'rooms', '--imu', 'mti600', '--lidar', 'velodyne16',
                 '--seed', '1', '--duration', '12', '--out', cls.bag)
        cls.offline = os.path.join(cls.directory, 'offline')
        run_well('rosrun', 'allan_lio', 'lio_offline', '--bag', cls.bag, '--config', 'simulated', '--out', cls.offline)
        cls.expected_scans = len(read(cls.offline, 'trajectory.tum').splitlines())
        rospy.init_node('bag_launch_test')

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.directory, ignore_errors=True)

    def launch(self, name, *arguments):
        out = os.path.join(self.directory, name)
        return out, run('roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=' + self.bag, 'out:=' + out, *arguments)

    def test_results_equal_those_of_the_offline_runner_to_the_bit(self):
        for rate in ('0', '8'):
            out, launched = self.launch('rate_' + rate, 'rate:=' + rate)
            self.assertTrue(os.path.exists(os.path.join(out, 'summary.yaml')), launched.stdout)
            self.assertIn(b'complete', read(out, 'summary.yaml').splitlines()[0], launched.stdout)
            self.assertGreater(self.expected_scans, 50)
            for file in ('trajectory.tum', 'states.csv'):
                self.assertEqual(read(out, file), read(self.offline, file), file + '\n' + launched.stdout)

    def test_the_error_stays_within_what_thirty_runs_spread(self):
        out, launched = self.launch('error')
        made = run_well('rosrun', 'allan_lio', 'evaluate_trajectory', '--reference', self.bag[:-4] + '.tum',
                        '--estimate', os.path.join(out, 'trajectory.tum'), '--align', 'se3', '--json')
        error = json.loads(made.stdout)
        self.assertEqual(error['matched'], self.expected_scans)
        self.assertLess(error['ate']['rmse'], ATE_TOLERANCE)
        self.assertLess(error['ate']['max'], ERROR_TOLERANCE)

    def test_topics_and_transforms_are_published_as_who_fuses_them_needs_them(self):
        with Recording(TOPICS) as seen:
            _, launched = self.launch('topics', 'rate:=4')
        odometry, imu = seen['/lidar_odometry/odometry'], seen['/imu_odometry']
        # The first messages may come before a subscriber has connected.
        self.assertGreater(len(odometry), self.expected_scans // 2, launched.stdout)
        self.assertGreater(len(seen['/lidar_odometry/state']), self.expected_scans // 2)
        self.assertGreater(len(seen['/lidar_odometry/points']), self.expected_scans // 2)
        self.assertGreater(len(imu), 10 * self.expected_scans)
        self.assertGreater(len(seen['/lidar_odometry/map']), 0)
        scans, _ = tum(self.offline, 'trajectory.tum')
        self.check_odometry(odometry, SCAN_INTERVAL, scans[0])
        self.check_odometry(imu, IMU_INTERVAL, scans[0])
        self.assertEqual(len(scans), self.expected_scans)
        self.assertEqual(stamps_of(odometry), scans[-len(odometry):], 'one message a scan')
        self.check_error(odometry[-1])
        self.check_error(imu[-1])
        self.check_transforms(seen['/tf'] + seen['/tf_static'], odometry)
        self.check_propagation(odometry, imu)
        self.assertEqual(OdometryReader('odom', 'base_link').complaints(imu), [])

    def check_odometry(self, messages, interval, first):
        stamps = stamps_of(messages)
        for before, now in zip(stamps, stamps[1:]):
            self.assertLessEqual(abs(now - before - interval), STAMP_TOLERANCE)
        for message in messages:
            self.assertTrue(finite(message))
            self.assertEqual((message.header.frame_id, message.child_frame_id), ('odom', 'base_link'))
            self.assertAlmostEqual(numpy.linalg.norm(components(message.pose.pose.orientation)), 1.0,
                                   delta=UNIT_TOLERANCE)
            pose, twist = eigenvalues(message.pose.covariance), eigenvalues(message.twist.covariance)
            self.assertIsNotNone(pose)
            if message.header.stamp.to_nsec() == first:  # no error since itself
                self.assertFalse(any(message.pose.covariance))
            else:
                self.assertGreater(pose[0], 0.0)
            self.assertIsNotNone(twist)
            self.assertGreater(twist[0], -ROUNDING * twist[-1])
            self.assertGreater(min(numpy.diag(numpy.reshape(message.twist.covariance, (6, 6)))), 0.0)

    def check_error(self, last):
        """The covariance is that of the whole error since the first pose, which the truth is laid on."""
        stamps, truth = tum(self.bag[:-4] + '.tum')
        begins, poses = tum(self.offline, 'trajectory.tum')
        way = numpy.transpose([position for position, _ in truth])
        begin, end = (numpy.array([numpy.interp(t - stamps[0], numpy.array(stamps) - stamps[0], axis) for axis in way])
                      for t in (begins[0], last.header.stamp.to_nsec()))
        turn = poses[0][1] @ truth[0][1].T  # it starts at rest
        error = components(last.pose.pose.position) - poses[0][0] - turn @ (end - begin)
        covariance = numpy.reshape(last.pose.covariance, (6, 6))[:3, :3]
        self.assertLess(error @ numpy.linalg.solve(covariance, error), POSITION_LIMIT)

    def check_transforms(self, messages, odometry):
        transforms = [transform for message in messages for transform in message.transforms]
        self.assertEqual({(t.header.frame_id, t.child_frame_id) for t in transforms}, {('odom', 'base_link')})
        stamps = stamps_of(transforms)
        self.assertEqual(stamps, sorted(set(stamps)))
        poses = {m.header.stamp: m.pose.pose for m in odometry}
        common = [t for t in transforms if t.header.stamp in poses]
        self.assertGreater(len(common), self.expected_scans // 2)
        for t in common:
            pose = poses[t.header.stamp]
            self.assertEqual(components(t.transform.translation), components(pose.position))
            self.assertEqual(components(t.transform.rotation), components(pose.orientation))

    def check_propagation(self, odometry, propagated):
        """The propagated pose stays with the filter's: both are of the same moment within an IMU interval.

        How long the propagation goes on alone depends on the machine's load, so a few messages may lie farther off;
        a pose that was stale would be off by the walking speed times its age in all of them.
        """
        filtered = {m.header.stamp.to_nsec(): m.pose.pose.position for m in odometry}
        nearest = sorted(filtered)
        distances = []
        for message in propagated:
            stamp = message.header.stamp.to_nsec()
            close = [t for t in nearest if abs(t - stamp) < 3e6]
            if not close:
                continue
            a, b = filtered[close[0]], message.pose.pose.position
            distances.append(math.dist((a.x, a.y, a.z), (b.x, b.y, b.z)))
        far = sum(d > PROPAGATION_TOLERANCE for d in distances)
        self.assertLess(far, FAR_SHARE * len(distances), 'worst of {}: {} m'.format(len(distances), max(distances)))
        self.assertLess(max(distances), 10 * PROPAGATION_TOLERANCE)

    def test_a_bad_configuration_ends_the_launch_with_a_sentence(self):
        out, launched = self.launch('bad', 'k_gb:=-1')
        self.assertIn('imu/k_gb', launched.stdout)
        self.assertFalse(os.path.exists(os.path.join(out, 'summary.yaml')))

    def test_an_interrupted_launch_leaves_whole_files(self):
        out = os.path.join(self.directory, 'interrupted')
        process = subprocess.Popen(['roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=' + self.bag, 'out:=' + out,
                                    'rate:=2'], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        trajectory = os.path.join(out, 'trajectory.tum')
        wait_until(lambda: os.path.exists(trajectory) and os.path.getsize(trajectory) > 1000, 'the first rows')
        process.send_signal(signal.SIGINT)
        process.wait(TIME_LIMIT)
        self.assertIn(b'interrupted', read(out, 'summary.yaml').splitlines()[0])
        self.assertIn(self.bag.encode(), read(out, 'summary.yaml'))
        for file in ('trajectory.tum', 'states.csv'):
            written = read(out, file)
            self.assertTrue(written.endswith(b'\n'))
            self.assertTrue(read(self.offline, file).startswith(written), file)
            self.assertLess(len(written), len(read(self.offline, file)))

    def write_config(self, name, text):
        path = os.path.join(self.directory, name)
        with open(path, 'w') as file:
            file.write('include: [robots/simulated]\n' + text)
        return path

    def launch_with_extrinsics_from_tf(self, name):
        config = self.write_config(name + '.yaml', 'frames: {extrinsics_from_tf: true, publish_tf: false}\n'
                                   'extrinsics: {T_imu_lidar: {translation: [9, 9, 9], rotation: [0, 0, 0, 1]}}\n')

        static = rospy.Publisher('/tf_static', TFMessage, queue_size=1, latch=True)
        static.publish(TFMessage([transform('base_link', 'imu', BASE_TO_IMU), transform('imu', 'lidar', EXTRINSICS)]))
        with Recording({'/imu_odometry': Odometry, '/lidar_odometry/odometry': Odometry, '/tf': TFMessage}) as seen:
            out, launched = self.launch(name, 'config:=' + config, 'rate:=4')
        static.unregister()
        return seen, out, launched

    def test_extrinsics_come_from_tf_and_a_filter_that_shall_not_adds_nothing_to_it(self):
        seen, out, launched = self.launch_with_extrinsics_from_tf('from_tf')
        self.assertEqual(read(out, 'trajectory.tum'), read(self.offline, 'trajectory.tum'), launched.stdout)
        in_force = rosgraph.Master('/bag_launch_test').getParam('/lidar_odometry/in_force/extrinsics')
        self.assertEqual(in_force['T_imu_lidar']['translation'], list(EXTRINSICS[0]))
        self.assertEqual(in_force['T_base_imu']['translation'], list(BASE_TO_IMU[0]))
        self.assertEqual(seen['/tf'], [])
        self.assertGreater(len(seen['/imu_odometry']), 10 * self.expected_scans)
        self.check_twist(seen['/imu_odometry'])

    def check_twist(self, odometry):
        """Of a base that lies off the IMU and is turned against it: neither lever arm nor axes can be mistaken."""
        frames = Frames([transform('base_link', 'imu', BASE_TO_IMU), transform('map', 'odom', MAP_TO_ODOM)])
        for consumer in (OdometryReader('odom', 'base_link', frames), OdometryReader('map', 'imu', frames)):
            self.assertEqual(consumer.complaints(odometry), [])

    def test_the_base_of_the_configuration_is_the_base_of_tf(self):
        from_tf, _, _ = self.launch_with_extrinsics_from_tf('base_from_tf')
        told_so = 'extrinsics: {{T_base_imu: {{translation: {}, rotation: {}}}}}\n'
        config = self.write_config('base.yaml', told_so.format(*map(list, BASE_TO_IMU)))
        with Recording({'/imu_odometry': Odometry, '/lidar_odometry/odometry': Odometry, '/tf': TFMessage}) as told:
            out, launched = self.launch('base', 'config:=' + config, 'rate:=4')
        self.assertEqual(read(out, 'trajectory.tum'), read(self.offline, 'trajectory.tum'), launched.stdout)
        expected = {m.header.stamp: m for m in from_tf['/lidar_odometry/odometry']}
        common = [m for m in told['/lidar_odometry/odometry'] if m.header.stamp in expected]
        self.assertGreater(len(common), self.expected_scans // 2, launched.stdout)
        for message in common:
            other = expected[message.header.stamp]
            self.assertEqual(message.child_frame_id, other.child_frame_id)
            numpy.testing.assert_allclose(flat(message), flat(other), rtol=0.0, atol=SAME)
        self.check_twist(told['/imu_odometry'])
        self.check_transforms(told['/tf'], told['/lidar_odometry/odometry'])
        position = common[0].pose.pose.position
        self.assertGreater(numpy.linalg.norm(numpy.array(components(position)) - self.imu_at(common[0].header.stamp)),
                           0.9 * numpy.linalg.norm(BASE_TO_IMU[0]))

    def imu_at(self, stamp):
        """The IMU's position at a scan's end [m]."""
        stamps, poses = tum(self.offline, 'trajectory.tum')
        return poses[stamps.index(stamp.to_nsec())][0]

    def test_extrinsics_that_nobody_publishes_end_the_launch_with_a_sentence(self):
        config = self.write_config('no_tf.yaml', 'frames: {extrinsics_from_tf: true}\n')
        out, launched = self.launch('no_tf', 'config:=' + config)
        self.assertIn("no transform from 'lidar' to 'imu'", launched.stdout)
        self.assertFalse(os.path.exists(os.path.join(out, 'summary.yaml')))

    def test_a_message_recorded_in_another_century_holds_nothing_up(self):
        bag = os.path.join(self.directory, 'wild.bag')
        shutil.copy(self.bag, bag)
        with rosbag.Bag(bag, 'a') as more:
            imu = Imu()
            imu.header.stamp = genpy.Time(2 ** 32 - 1, 5)
            more.write('/imu/data', imu, imu.header.stamp)
        out, launched = self.launch('wild', 'bag:=' + bag, 'rate:=20')
        self.assertIn('all of them taken', launched.stdout)
        self.assertEqual(read(out, 'trajectory.tum'), read(self.offline, 'trajectory.tum'), launched.stdout)

    def test_a_missing_bag_ends_the_launch_with_a_sentence(self):
        launched = run('roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=/nowhere/none.bag')
        self.assertIn('/nowhere/none.bag', launched.stdout)

    def test_parameters_in_force_are_on_the_server(self):
        self.launch('in_force', 'k_gb:=1.5')
        master = rosgraph.Master('/bag_launch_test')
        self.assertEqual(master.getParam('/lidar_odometry/in_force/imu/k_gb'), 1.5)
        self.assertEqual(master.getParam('/lidar_odometry/in_force/imu/k_ab'), K_DEFAULT)
        # The multipliers and limits that the propagation works with come with ~state: it shows none of its own.
        propagation = master.getParam('/imu_propagation/in_force')
        self.assertEqual(set(propagation['imu']), {'noise', 'bias_model', 'discretization', 'accel_unit', 'gravity'})
        self.assertEqual(propagation['frames'], master.getParam('/lidar_odometry/in_force/frames'))
        self.assertNotIn('k_r', propagation['lidar'])


if __name__ == '__main__':
    rostest.rosrun('allan_lio', 'bag_launch', BagLaunch)
