#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""The reader that bag_launch_test.py judges the odometry by: messages of a made-up motion pass, wrong ones don't."""
import math
import unittest

import genpy
import numpy
import rostest
from geometry_msgs.msg import Point, Quaternion, Transform, TransformStamped, Vector3
from nav_msgs.msg import Odometry
from std_msgs.msg import Header

from odometry_reader import Frames, OdometryReader, log, rotation_of

SECOND, PERIOD_NS = 1700000000, 5000000
LENGTH = 4.0  # [s]
H = 1e-4  # [s] of the central differences that make the truth's twist
TILT = (0.5, 0.5, 0.5, 0.5)  # a third of a turn about (1, 1, 1)
LEVER = (0.3, 0.1, 0.2)  # [m]
SPREAD = numpy.array([4.0, 1.0, 9.0, 1e-2, 4e-2, 9e-2])  # of the variances, no axis like another
POSE_COVARIANCE, TWIST_COVARIANCE = numpy.diag(1e-5 * SPREAD), numpy.diag(1e-4 * SPREAD)


def position(t):
    return numpy.array([2.0 * math.cos(0.6 * t), 2.0 * math.sin(0.6 * t), 0.05 * math.sin(9.0 * t)])


def quaternion(t):
    """Heading from 1.5 rad on, and a nodding pitch."""
    yaw, pitch = 0.5 * (1.5 + 0.6 * t), 0.1 * math.sin(4.0 * t)
    a, b = (math.cos(yaw), math.sin(yaw)), (math.cos(pitch), math.sin(pitch))
    return -a[1] * b[1], a[0] * b[1], a[1] * b[0], a[0] * b[0]


def rotation(t):
    return rotation_of(*quaternion(t))


def odometry(k):
    """As nav_msgs/Odometry documents it."""
    t = 1e-9 * PERIOD_NS * k
    message = Odometry(header=Header(frame_id='odom', stamp=genpy.Time(SECOND, 0) + genpy.Duration(0, PERIOD_NS * k)))
    message.child_frame_id = 'base_link'
    message.pose.pose.position, message.pose.pose.orientation = Point(*position(t)), Quaternion(*quaternion(t))
    linear = rotation(t).T @ (position(t + H) - position(t - H)) / (2 * H)
    angular = log(rotation(t - H).T @ rotation(t + H)) / (2 * H)
    message.twist.twist.linear, message.twist.twist.angular = Vector3(*linear), Vector3(*angular)
    message.pose.covariance, message.twist.covariance = list(POSE_COVARIANCE.flat), list(TWIST_COVARIANCE.flat)
    return message


def transform(parent, child, translation, turn):
    return TransformStamped(Header(frame_id=parent), child, Transform(Vector3(*translation), Quaternion(*turn)))


FRAMES = Frames([transform('map', 'odom', (3, -2, 1), TILT), transform('base_link', 'imu', LEVER, TILT)])
READERS = OdometryReader('odom', 'base_link'), OdometryReader('map', 'imu', FRAMES)


def array(vector):
    return numpy.array([vector.x, vector.y, vector.z])


class ReaderOfOdometry(unittest.TestCase):
    def complaints(self, change=lambda message, turn: None):
        """Of both readers, of messages that are changed; `turn` is R_odom_base."""
        messages = [odometry(k) for k in range(int(LENGTH * 1e9 / PERIOD_NS))]
        for k, message in enumerate(messages):
            change(message, rotation(1e-9 * PERIOD_NS * k))
        return [reader.complaints(messages) for reader in READERS]

    def expect_refused(self, change, *sentences):
        for said in self.complaints(change):
            self.assertEqual(len(said), len(sentences), said)
            for complaint, sentence in zip(said, sentences):
                self.assertIn(sentence, complaint)

    def test_messages_as_they_are_documented_pass_in_all_frames(self):
        self.assertEqual(self.complaints(), [[], []])

    def test_a_twist_in_the_world_frame_is_refused(self):
        def linear(message, turn):
            message.twist.twist.linear = Vector3(*(turn @ array(message.twist.twist.linear)))

        def angular(message, turn):
            message.twist.twist.angular = Vector3(*(turn @ array(message.twist.twist.angular)))

        self.expect_refused(linear, 'do not lead from pose to pose', 'median linear')
        for said in self.complaints(angular):
            self.assertTrue(any('median angular' in complaint for complaint in said), said)
            self.assertIn('do not lead from pose to pose', said[0])

    def test_an_angular_rate_of_the_wrong_sign_is_refused(self):
        def change(message, _):
            message.twist.twist.angular = Vector3(*(-array(message.twist.twist.angular)))

        for said in self.complaints(change):
            self.assertTrue(any('median angular' in complaint for complaint in said), said)
            self.assertIn('do not lead from pose to pose', said[0])

    def test_a_velocity_of_another_point_than_the_bases_origin_is_refused(self):
        def change(message, _):
            of_imu = numpy.cross(array(message.twist.twist.angular), LEVER)
            message.twist.twist.linear = Vector3(*(array(message.twist.twist.linear) + of_imu))

        self.expect_refused(change, 'do not lead from pose to pose', 'median linear')

    def test_a_speed_that_is_a_little_off_is_refused_though_the_covariances_allow_it(self):
        def change(message, _):
            message.twist.twist.linear = Vector3(*(1.01 * array(message.twist.twist.linear)))

        self.expect_refused(change, 'median linear')

    def test_covariances_that_no_filter_can_use_are_refused(self):
        def entries(of, *changes):
            def change(message, _):
                for at, value in changes:
                    of(message)[at] = value
            return change

        for name, of in (('pose', lambda m: m.pose.covariance), ('twist', lambda m: m.twist.covariance)):
            for change, sentence in ((entries(of, (0, math.nan)), 'is not finite'),
                                     (entries(of, (1, 1e-6)), 'is not symmetric'),
                                     (entries(of, (0, 0.0)), 'cannot be inverted'),
                                     (entries(of, (7, -1e-5)), 'cannot be inverted'),
                                     (entries(of, (0, 1e12)), 'cannot be inverted')):
                for said in self.complaints(change):
                    self.assertEqual(set(said), {'a covariance of the {} {}'.format(name, sentence)})

    def test_the_pose_of_the_first_message_alone_may_have_no_covariance(self):
        def change(message, _):
            if message.header.stamp == genpy.Time(SECOND, 0):
                message.pose.covariance = [0.0] * 36

        self.assertEqual(self.complaints(change), [[], []])

    def test_covariances_are_rotated_with_their_frames(self):
        reading = READERS[1].read(odometry(0))
        for covariance, turn, made in (
                (POSE_COVARIANCE, rotation_of(*TILT), reading.pose_covariance),
                (TWIST_COVARIANCE, rotation_of(*TILT).T, reading.twist_covariance)):
            for at in (0, 3):
                block = turn @ covariance[at:at + 3, at:at + 3] @ turn.T
                numpy.testing.assert_allclose(made[at:at + 3, at:at + 3], block, atol=1e-12)
                self.assertNotAlmostEqual(block[0, 0], covariance[at, at], delta=1e-8)

    def test_frames_that_tf_does_not_join_are_an_error(self):
        with self.assertRaises(LookupError):
            OdometryReader('earth', 'base_link', FRAMES).read(odometry(0))

    def test_too_short_a_run_is_no_proof(self):
        self.assertIn('are too few', READERS[0].complaints([odometry(k) for k in range(100)])[0])


if __name__ == '__main__':
    rostest.rosrun('allan_lio', 'odometry_reader', ReaderOfOdometry)
