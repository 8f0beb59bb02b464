#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""The faults of doc/faults.md through the nodelets of the shipped launch file: the same results as lio_offline's, to
the bit, so what the tests of test/pipeline/faults_*_test.cpp hold of that one holds here; nothing NaN is published; and
whatever ends the filter, its files are whole."""
import fcntl
import math
import os
import select
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import rospy
import rostest
import yaml
from nav_msgs.msg import Odometry

from allan_lio.msg import State

TIME_LIMIT = 60 * float(os.environ.get('ALLAN_LIO_SLOWER', 1))  # [s], of an ordinary build; scripts/test raises it for sanitized ones
# The faults that don't disturb each other.
DATA_FAULTS = ['points_invalid', 'scans_empty', 'scans_thin', 'scans_lie', 'imu_repeated', 'imu_backward',
               'imu_from_the_future', 'lidar_repeated', 'lidar_backward', 'imu_senseless', 'imu_gap_bridged']
F_SETPIPE_SZ = 1031  # Linux; in Python's fcntl from 3.10 on
ROOM_OF_A_ROW = 200  # [bytes] at least, of trajectory.tum
A_WHILE = 2.0  # [s]
SILENCES = ['imu_gap_long', 'lidar_gap_long']


def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
                          timeout=TIME_LIMIT)


def run_well(*command):
    done = run(*command)
    assert done.returncode == 0, done.stdout
    return done


def read(*path):
    with open(os.path.join(*path), 'rb') as file:
        return file.read()


def summary_of(out):
    return yaml.safe_load(read(out, 'summary.yaml'))


def numbers(value):
    """All numbers of a message, whatever their depth."""
    if hasattr(value, '__slots__'):
        for name in value.__slots__:
            yield from numbers(getattr(value, name))
    elif isinstance(value, (list, tuple)):
        for item in value:
            yield from numbers(item)
    elif isinstance(value, float):
        yield value


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.mkdtemp(prefix='allan_lio_faults_')
        cls.bag = os.path.join(cls.directory, 'good.bag')
        run_well('rosrun', 'allan_lio', 'simulate_bag', '--scene', 'rooms', '--imu', 'mti600', '--lidar', 'velodyne16',
                 '--seed', '1', '--duration', '14', '--out', cls.bag)
        cls.good = cls.offline(cls.bag, 'good')
        rospy.init_node('faults_test')

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.directory, ignore_errors=True)

    @classmethod
    def offline(cls, bag, name):
        out = os.path.join(cls.directory, name + '_offline')
        run('rosrun', 'allan_lio', 'lio_offline', '--bag', bag, '--config', 'simulated', '--out', out)
        return out

    def mutate(self, name, *faults):
        bag = os.path.join(self.directory, name + '.bag')
        run_well('rosrun', 'allan_lio', 'mutate_bag', self.bag, bag, *faults)
        return bag

    def launch(self, bag, name):
        out = os.path.join(self.directory, name)
        done = run('roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=' + bag, 'out:=' + out)
        return out, done.stdout

    def expect_as_offline(self, bag, name):
        """Returns the summary and what the launch printed."""
        expected = self.offline(bag, name)
        out, text = self.launch(bag, name)
        for file in ('trajectory.tum', 'states.csv'):
            self.assertEqual(read(out, file), read(expected, file), file + '\n' + text)
        summary, same = summary_of(out), summary_of(expected)
        for key in ('status', 'scans', 'points', 'imu'):
            self.assertEqual(summary[key], same[key], text)
        return summary, text

    def test_wrong_messages_are_survived_and_nothing_that_is_not_finite_is_published(self):
        seen = {'odometry': [], 'imu': [], 'state': []}
        subscribers = [
            rospy.Subscriber('/lidar_odometry/odometry', Odometry, seen['odometry'].append, queue_size=1000),
            rospy.Subscriber('/imu_odometry', Odometry, seen['imu'].append, queue_size=10000),
            rospy.Subscriber('/lidar_odometry/state', State, seen['state'].append, queue_size=1000)]
        summary, text = self.expect_as_offline(self.mutate('data', *DATA_FAULTS), 'data')
        for subscriber in subscribers:
            subscriber.unregister()
        self.assertEqual(summary['status'], 'complete', text)
        self.assertGreater(summary['scans']['used'], 120)
        self.assertGreater(min(summary['points'].values()), 0)
        self.assertGreater(summary['imu']['dropped_invalid'], 0)
        self.assertGreater(summary['imu']['dropped_not_newer'], 0)
        for name, messages in seen.items():
            self.assertGreater(len(messages), 50, name)
            for message in messages:
                self.assertTrue(all(map(math.isfinite, numbers(message))), name)

    def test_a_long_silence_starts_again_in_place_and_is_said(self):
        summary, text = self.expect_as_offline(self.mutate('silence', *SILENCES), 'silence')
        self.assertEqual(summary['imu']['starts_in_place'], 1)
        self.assertIn('started again where it stood', text)

    def test_a_loop_starts_again_and_is_said_once(self):
        bag = self.mutate('loop', 'looped')
        out, text = self.launch(bag, 'loop')
        self.assertEqual(text.count('the stamps went back by'), 1, text)
        # Which of the scans and samples around the jump comes first is left to the network.
        rows, expected = (read(d, 'trajectory.tum').splitlines() for d in (out, self.offline(bag, 'loop')))
        scans = len(expected) // 2
        self.assertEqual(rows[:scans - 5], expected[:scans - 5])
        self.assertGreater(len(rows), len(expected) - 5)
        self.assertEqual(summary_of(out)['status'], 'complete')

    def test_clocks_that_lie_apart_end_the_launch_with_both_ranges(self):
        _, text = self.launch(self.mutate('clocks', 'lidar_clock_off'), 'clocks')
        self.assertIn('LiDAR and IMU go by different clocks: the IMU\'s stamps run from 17000000', text)

    def test_a_missing_time_field_ends_the_launch_with_a_sentence(self):
        _, text = self.launch(self.mutate('time', 'no_time_field'), 'time')
        self.assertIn('no field for the points\' times', text)

    def test_a_bag_that_is_cut_off_is_played_as_far_as_it_goes(self):
        bag = os.path.join(self.directory, 'cut.bag')
        whole = read(self.bag)
        with open(bag, 'wb') as file:
            file.write(whole[:len(whole) * 6 // 10])
        summary, text = self.expect_as_offline(bag, 'cut')
        self.assertIn('incomplete: ', summary['status'])
        self.assertGreater(summary['scans']['used'], 50)

    def test_a_full_disk_is_said(self):
        out = os.path.join(self.directory, 'full')
        os.makedirs(out)
        os.symlink('/dev/full', os.path.join(out, 'trajectory.tum'))
        out, text = self.launch(self.bag, 'full')
        self.assertIn('trajectory.tum: could not be written', text)
        self.assertIn('incomplete: ', summary_of(out)['status'])
        self.assertEqual(read(out, 'states.csv'), read(self.good, 'states.csv'))

    # --- the end of the filter at any moment ---

    def interrupt(self, name, start, stop, delay):
        """`start` makes the filter's processes, `stop` ends the filter `delay` [s] after its first results."""
        out = os.path.join(self.directory, name)
        processes = start(out)
        player = subprocess.Popen(['rosrun', 'allan_lio', 'play_bag', self.bag, '--rate', '4', '--filter', 'filter'],
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            trajectory, until = os.path.join(out, 'trajectory.tum'), time.time() + TIME_LIMIT
            while time.time() < until and not (os.path.exists(trajectory) and os.path.getsize(trajectory) > 0):
                time.sleep(0.02)
            time.sleep(delay)
            stop(processes)
            while time.time() < until and not os.path.exists(os.path.join(out, 'summary.yaml')):
                time.sleep(0.02)
        finally:
            for process in [player] + processes:
                process.terminate()
                process.wait(TIME_LIMIT)
        self.expect_whole(out)

    def expect_whole(self, out):
        summary = summary_of(out)
        self.assertEqual(summary['status'], 'interrupted')
        rows = read(out, 'trajectory.tum')
        self.assertEqual(rows.count(b'\n'), summary['scans']['used'])
        for file in ('trajectory.tum', 'states.csv'):
            written = read(out, file)
            self.assertTrue(written.endswith(b'\n'), file)
            self.assertTrue(read(self.good, file).startswith(written), file)
            self.assertLess(len(written), len(read(self.good, file)))

    @staticmethod
    def start(*command):
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def start_node(self, out):
        return [self.start('rosrun', 'allan_lio', 'lidar_odometry_node', '__name:=filter', '_config:=simulated',
                           '_out:=' + out)]

    def start_nodelet(self, out):
        manager = self.start('rosrun', 'nodelet', 'nodelet', 'manager', '__name:=manager')
        return [manager, self.start('rosrun', 'nodelet', 'nodelet', 'load', 'allan_lio/LidarOdometry', 'manager',
                                    '__name:=filter', '_config:=simulated', '_out:=' + out)]

    def test_signals_to_the_node_leave_whole_files(self):
        for number, name in ((signal.SIGTERM, 'term'), (signal.SIGINT, 'int')):
            for delay in (0.0, 0.83):
                self.interrupt('node_{}_{}'.format(name, delay), self.start_node,
                               lambda processes: processes[0].send_signal(number), delay)

    def test_a_signal_to_the_manager_leaves_whole_files(self):
        for delay in (0.1, 0.57):
            self.interrupt('manager_{}'.format(delay), self.start_nodelet,
                           lambda processes: processes[0].send_signal(signal.SIGTERM), delay)

    def test_unloading_the_nodelet_leaves_whole_files(self):
        for delay in (0.2, 0.71):
            self.interrupt('unload_{}'.format(delay), self.start_nodelet,
                           lambda processes: processes[1].send_signal(signal.SIGINT), delay)

    def test_a_signal_in_the_midst_of_a_callback_leaves_whole_files(self):
        # The trajectory is a pipe with room for its first row: the callback that writes the next ones, a second of data
        # later, stands still until somebody reads. By then the manager has let go of the nodelet: only the nodelet's
        # callback queue keeps it alive.
        out = os.path.join(self.directory, 'midst')
        trajectory = os.path.join(out, 'trajectory.tum')
        os.makedirs(out)
        os.mkfifo(trajectory)
        pipe = os.open(trajectory, os.O_RDWR | os.O_NONBLOCK)
        filler = b'x' * (fcntl.fcntl(pipe, F_SETPIPE_SZ, 4096) - ROOM_OF_A_ROW)
        os.write(pipe, filler)
        seen = []
        subscriber = rospy.Subscriber('/filter/state', State, seen.append, queue_size=1000)
        stamps = [float(row.split()[0]) for row in read(self.good, 'trajectory.tum').splitlines()]
        last_before = max(t for t in stamps if t < stamps[0] + 1.0)

        processes = self.start_nodelet(out)
        manager = processes[0]
        processes.append(self.start('rosrun', 'allan_lio', 'play_bag', self.bag, '--rate', '4', '--filter', 'filter'))
        try:
            until = time.time() + TIME_LIMIT
            while time.time() < until and not (seen and seen[-1].header.stamp.to_sec() > last_before - 1e-3):
                time.sleep(0.02)
            time.sleep(A_WHILE)  # the next scan's callback begins
            manager.send_signal(signal.SIGTERM)
            time.sleep(A_WHILE)  # the manager has come to delete its nodelets
            self.assertIsNone(manager.poll())
            written = b''
            while time.time() < until and (manager.poll() is None or select.select([pipe], [], [], 0.0)[0]):
                if select.select([pipe], [], [], 0.02)[0]:
                    written += os.read(pipe, 65536)
        finally:
            subscriber.unregister()
            os.close(pipe)
            for process in processes:
                process.terminate()
                process.wait(TIME_LIMIT)
        self.assertEqual(manager.returncode, 0)
        os.remove(trajectory)
        with open(trajectory, 'wb') as file:
            file.write(written[len(filler):])
        self.expect_whole(out)
        self.assertGreater(len(written), len(filler) + 2 * ROOM_OF_A_ROW, 'no callback stood still')


if __name__ == '__main__':
    rostest.rosrun('allan_lio', 'faults', Faults)
