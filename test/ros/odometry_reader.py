# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Takes nav_msgs/Odometry as robot_localization does, which is not packaged here, and judges whether pose, twist and
covariances belong together.

What it does of robot_localization's ways (its pose_use_child_frame on): the pose goes from header.frame_id to the
consumer's world frame and the twist from child_frame_id to its base frame, each by TF; a twist's linear part moves over
the lever arm; covariances are rotated, without the lever arm's part; variances below 1e-9 are raised to that.
"""
import collections

import numpy

LEAST_VARIANCE = 1e-9
STRETCH = 0.5  # [s] over which twists are integrated
LONGEST_STEP = 0.021  # [s] from one message to the next in a stretch
FEWEST_STRETCHES = 5
# Quantile 0.999 of the chi-square distribution with 6 degrees of freedom. 0.95 measured of the worst stretch of 12 s in
# the rooms: the covariance of a difference of poses is not in the messages, twice the sum of both bounds it.
LIMIT = 22.46
WORST_CONDITION = 1e12  # of a covariance, for doubles to invert it
# Medians of the twist less the derivative of the pose over two steps [m/s], [rad/s]; 0.0005 and 0.0017 measured, at
# 200 Hz, where the gyro's noise is 0.0017 rad/s.
LINEAR_TOLERANCE, ANGULAR_TOLERANCE = 0.005, 0.005

Reading = collections.namedtuple(
    'Reading', ('stamp',  # [s] from a second of the clock on
                'position', 'rotation',  # T_world_base
                'pose_covariance',  # position, then rotation about the world's axes
                'linear', 'angular', 'twist_covariance'))  # of the base along its axes


def rotation_of(x, y, z, w):
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def skew(v):
    return numpy.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def exp(angle):
    """The rotation about a vector by its length [rad]."""
    length = numpy.linalg.norm(angle)
    axis = skew(angle / max(length, 1e-300))
    return numpy.eye(3) + numpy.sin(length) * axis + (1.0 - numpy.cos(length)) * axis @ axis


def log(rotation):
    """The inverse of exp(), for angles below pi."""
    sine_axis = 0.5 * numpy.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0],
                                   rotation[1, 0] - rotation[0, 1]])
    sine = numpy.linalg.norm(sine_axis)
    return sine_axis * (numpy.arctan2(sine, 0.5 * (numpy.trace(rotation) - 1.0)) / sine if sine > 0.0 else 1.0)


def components(message):
    """Of a point, vector or quaternion."""
    return numpy.array([getattr(message, name) for name in message.__slots__])


def turned(covariance, rotation):
    both = numpy.kron(numpy.eye(2), rotation)
    return both @ covariance @ both.T


class Frames:
    """What TF knows, of geometry_msgs/TransformStamped."""

    def __init__(self, transforms=()):
        self.parents = {t.child_frame_id: (t.header.frame_id, rotation_of(*components(t.transform.rotation)),
                                           components(t.transform.translation)) for t in transforms}

    def to_root(self, frame):
        """The root's name and T_root_frame."""
        rotation, translation = numpy.eye(3), numpy.zeros(3)
        while frame in self.parents:
            frame, above, offset = self.parents[frame]
            rotation, translation = above @ rotation, above @ translation + offset
        return frame, rotation, translation

    def look_up(self, target, source):
        """T_target_source as a rotation matrix and a translation [m]."""
        (root, to_root, offset), (other, from_source, begin) = self.to_root(target), self.to_root(source)
        if root != other:
            raise LookupError('no transform from {} to {}'.format(source, target))
        return to_root.T @ from_source, to_root.T @ (begin - offset)


class OdometryReader:
    """Of a consumer with these frames of its own."""

    def __init__(self, world, base, frames=Frames()):
        self.world, self.base, self.frames = world, base, frames

    def read(self, message, second=0):
        """A Reading, its time counted from a second of the clock."""
        to_world, origin = self.frames.look_up(self.world, message.header.frame_id)
        to_base, lever = self.frames.look_up(self.base, message.child_frame_id)
        rotation = to_world @ rotation_of(*components(message.pose.pose.orientation))
        position = origin + to_world @ components(message.pose.pose.position)
        angular = to_base @ components(message.twist.twist.angular)
        linear = to_base @ components(message.twist.twist.linear) + numpy.cross(lever, angular)
        stamp = message.header.stamp.secs - second + 1e-9 * message.header.stamp.nsecs
        return Reading(stamp, position - rotation @ to_base.T @ lever, rotation @ to_base.T,
                       self.usable(message.pose.covariance, to_world), linear, angular,
                       self.usable(message.twist.covariance, to_base))

    @staticmethod
    def usable(covariance, rotation):
        covariance = turned(numpy.reshape(covariance, (6, 6)), rotation)
        numpy.fill_diagonal(covariance, numpy.maximum(numpy.diag(covariance), LEAST_VARIANCE))
        return covariance

    def complaints(self, messages):
        """What is wrong with them, as sentences."""
        covariances = [(name, numpy.reshape(of(m), (6, 6))) for m in messages[1:]
                       for name, of in (('pose', lambda m: m.pose.covariance), ('twist', lambda m: m.twist.covariance))]
        said = [complaint for name, matrix in covariances for complaint in complaints_of(name, matrix)]
        if said:
            return said
        readings = [self.read(m, messages[0].header.stamp.secs) for m in messages]
        return judge_stretches(readings) + judge_medians(readings)


def complaints_of(name, covariance):
    if not numpy.isfinite(covariance).all():
        return ['a covariance of the {} is not finite'.format(name)]
    if (covariance != covariance.T).any():
        return ['a covariance of the {} is not symmetric'.format(name)]
    values = numpy.linalg.eigvalsh(covariance)
    if values[0] * WORST_CONDITION < values[-1] or values[0] <= 0.0:
        return ['a covariance of the {} cannot be inverted'.format(name)]
    return []


def integrate(readings):
    """Position and rotation at the end of a stretch by its first pose and its twists."""
    position, rotation = readings[0].position, readings[0].rotation
    for a, b in zip(readings, readings[1:]):
        step = b.stamp - a.stamp
        after = rotation @ exp(0.5 * step * (a.angular + b.angular))
        position = position + 0.5 * step * (rotation @ a.linear + after @ b.linear)
        rotation = after
    return position, rotation


def mismatch(stretch):
    """Squared length, in sigmas, of the last pose less what the twists make of the first."""
    first, last = stretch[0], stretch[-1]
    position, rotation = integrate(stretch)
    difference = numpy.concatenate([last.position - position, log(last.rotation @ rotation.T)])
    twists = 0.5 * (turned(first.twist_covariance, first.rotation) + turned(last.twist_covariance, last.rotation))
    covariance = 2.0 * (first.pose_covariance + last.pose_covariance) + (last.stamp - first.stamp) ** 2 * twists
    return difference @ numpy.linalg.solve(covariance, difference)


def stretches(readings):
    begin = 1
    for end in range(1, len(readings)):
        if readings[end].stamp - readings[end - 1].stamp > LONGEST_STEP:
            begin = end
        elif readings[end].stamp - readings[begin].stamp >= STRETCH:
            yield readings[begin:end + 1]
            begin = end


def judge_stretches(readings):
    sizes = [mismatch(stretch) for stretch in stretches(readings)]
    if len(sizes) < FEWEST_STRETCHES:
        return ['{} stretches without a gap are too few'.format(len(sizes))]
    if max(sizes) < LIMIT:
        return []
    return ['the twists do not lead from pose to pose: {} of {} stretches are beyond {}, the worst {:.0f}'.format(
        sum(size >= LIMIT for size in sizes), len(sizes), LIMIT, max(sizes))]


def judge_medians(readings):
    linear, angular = [], []
    for before, now, after in zip(readings, readings[1:], readings[2:]):
        interval = after.stamp - before.stamp
        speed = now.rotation.T @ (after.position - before.position) / interval
        linear.append(numpy.linalg.norm(now.linear - speed))
        angular.append(numpy.linalg.norm(now.angular - log(before.rotation.T @ after.rotation) / interval))
    return ['the median {} twist is {:.4f} off the derivative of the pose'.format(name, numpy.median(errors))
            for name, errors, tolerance in (('linear', linear, LINEAR_TOLERANCE),
                                            ('angular', angular, ANGULAR_TOLERANCE))
            if not numpy.median(errors) < tolerance]
