#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""The faults of doc/faults.md through the nodelets of the shipped launch file: the same results as lio_offline's, to
the bit, so what the tests of test/pipeline/faults_*_test.cpp hold of that one holds here; nothing NaN is published; and
whatever ends the filter, its files are whole."""
import fcntl
import math
import os
import random
import re
import select
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import numpy
import rospy
import rostest
import yaml
from diagnostic_msgs.msg import DiagnosticArray, KeyValue
from nav_msgs.msg import Odometry, Path
from sensor_msgs.msg import PointCloud2, PointField
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from allan_lio.msg import State, Status
from held_master import HeldMaster
from ros_support import TIME_LIMIT, Recorder, Recording, read, run, run_well, wait_until

ROOMS = ['--scene', 'rooms', '--imu', 'mti600', '--lidar', 'velodyne16', '--seed', '1']
# The faults that don't disturb each other.
DATA_FAULTS = ['points_invalid', 'scans_empty', 'scans_thin', 'scans_lie', 'imu_repeated', 'imu_backward',
               'imu_from_the_future', 'lidar_repeated', 'lidar_backward', 'imu_senseless', 'imu_gap_bridged']
F_SETPIPE_SZ = 1031  # Linux; in Python's fcntl from 3.10 on
ROOM_OF_A_ROW = 200  # [bytes] at least, of trajectory.tum
A_WHILE = 2.0  # [s]
FASTEST = 4.0  # [m/s], of one who walks
# nodelet's own manager aborts after it has ended the nodelets, if its bond with their loader is still being made.
FOREIGN_MANAGER_STATUSES = (0, -signal.SIGABRT)
RANDOM = random.Random(1)
# [s] after the first results, of the 3 s or so that the bag is played: when a nodelet is unloaded
UNLOADED_AFTER = [round(RANDOM.uniform(0.0, 1.5), 3) for _ in range(4)]
SILENCES = ['imu_gap_long', 'lidar_gap_long']
# What they have dropped, by the names of ~status.
DROPPED = {'clouds: undecodable', 'scans: not_newer_than_the_last', 'scans: too_few_points', 'imu: dropped_not_newer',
           'imu: dropped_invalid', 'imu: gaps', 'points: invalid', 'points: out_of_range'}
SCANS = 140  # of the bag without faults
NO_TIMES_CLIPPED_GYRO = 'include: [robots/simulated]\nimu: {gyro_range: 1.0}\nlidar: {deskew: false}\n'
AZIMUTH_CLIPPED_ACCEL = ('include: [robots/simulated]\nimu: {accel_range: 12.0}\n'
                         'lidar: {point_time: azimuth_clockwise}\n')
# Faults that leave each other alone, the configuration, and what the summary must count, by the names of ~status.
SURVIVED = [
    (['lidar_from_the_future', 'lidar_gap'], 'simulated',
     {'scans: used': SCANS - 1 - 20, 'scans: not_newer_than_the_last': 1, 'scans: map_restarts': 0}),
    (['imu_gap_long'], 'simulated', {'scans: used': SCANS, 'imu: gaps': 1, 'imu: starts_in_place': 0}),
    (['imu_gap_short', 'imu_saturated', 'no_time_field'], NO_TIMES_CLIPPED_GYRO,
     {'scans: used': SCANS, 'imu: gaps': 0, 'imu: saturated': 65}),
    (['imu_saturated_accel', 'no_time_field'], AZIMUTH_CLIPPED_ACCEL, {'scans: used': SCANS, 'imu: saturated': 600})]
BEFORE_IT_IS_SET = 90  # scans at least, of the 100 before the clock is set
# Everything that the nodelets publish.
TOPICS = {'/lidar_odometry/odometry': Odometry, '/imu_odometry': Odometry, '/lidar_odometry/state': State,
          '/lidar_odometry/status': Status, '/tf': TFMessage, '/lidar_odometry/path': Path,
          '/lidar_odometry/markers': MarkerArray, '/lidar_odometry/points': PointCloud2,
          '/lidar_odometry/map': PointCloud2, '/diagnostics': DiagnosticArray}
EVERY_SCAN = ['/lidar_odometry/odometry', '/lidar_odometry/state', '/lidar_odometry/status', '/tf']


def summary_of(out):
    return yaml.safe_load(read(out, 'summary.yaml'))


def stamps_of(out):
    return [float(row.split()[0]) for row in read(out, 'trajectory.tum').splitlines()]


def count_of(summary, reason):
    """What a summary counts, by its name in ~status."""
    group, name = reason.split(': ')
    if group == 'clouds':
        found = re.search(r'(\d+) messages could not be decoded', '\n'.join(summary['notes']))
        return int(found.group(1)) if found else 0
    return {**summary[group], **summary[group].get('skipped_because', {})}[name]


def as_number(word):
    try:
        return float(word)
    except ValueError:
        return 0.0


def numbers(value):
    """All numbers of a message, whatever their depth; of a cloud of floats one that is NaN or inf if any is."""
    if isinstance(value, PointCloud2):
        assert {f.datatype for f in value.fields} == {PointField.FLOAT32}
        yield float(numpy.abs(numpy.frombuffer(value.data, '<f4')).max(initial=0.0))
    elif isinstance(value, KeyValue):
        yield from map(as_number, value.value.split())
    elif hasattr(value, '__slots__'):
        for name in value.__slots__:
            yield from numbers(getattr(value, name))
    elif isinstance(value, (list, tuple)):
        for item in value:
            yield from numbers(item)
    elif isinstance(value, float):
        yield value


def speed(odometry):
    """[m/s]"""
    v = odometry.twist.twist.linear
    return math.sqrt(v.x ** 2 + v.y ** 2 + v.z ** 2)


class Faults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.mkdtemp(prefix='allan_lio_faults_')
        cls.bag = os.path.join(cls.directory, 'good.bag')
        run_well('rosrun', 'allan_lio', 'simulate_bag', *ROOMS, '--duration', '14', '--out', cls.bag)
        cls.good = cls.offline(cls.bag, 'good')
        rospy.init_node('faults_test')

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.directory, ignore_errors=True)

    @classmethod
    def offline(cls, bag, name, config='simulated'):
        out = os.path.join(cls.directory, name + '_offline')
        run('rosrun', 'allan_lio', 'lio_offline', '--bag', bag, '--config', config, '--out', out)
        return out

    def write(self, name, text):
        path = os.path.join(self.directory, name)
        with open(path, 'w') as file:
            file.write(text)
        return path

    def mutate(self, name, *faults):
        bag = os.path.join(self.directory, name + '.bag')
        run_well('rosrun', 'allan_lio', 'mutate_bag', self.bag, bag, *faults)
        return bag

    def launch(self, bag, name, *arguments):
        out = os.path.join(self.directory, name)
        done = run('roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=' + bag, 'out:=' + out, *arguments)
        return out, done.stdout

    def expect_as_offline(self, bag, name, *arguments, config='simulated'):
        """Returns the summary and what the launch printed."""
        expected = self.offline(bag, name, config)
        out, text = self.launch(bag, name, 'config:=' + config, *arguments)
        for file in ('trajectory.tum', 'states.csv'):
            self.assertEqual(read(out, file), read(expected, file), file + '\n' + text)
        self.expect_same_counts(out, expected, text)
        return summary_of(out), text

    def expect_same_counts(self, out, expected, text):
        summary, same = summary_of(out), summary_of(expected)
        for key in ('status', 'scans', 'points', 'imu'):
            self.assertEqual(summary[key], same[key], text)

    def test_wrong_messages_are_survived_and_said_and_nothing_that_is_not_finite_is_published(self):
        with Recording(TOPICS) as seen:
            # At a rate that leaves time for the diagnostics of every second.
            summary, text = self.expect_as_offline(self.mutate('data', *DATA_FAULTS), 'data', 'rate:=4')
        self.assertEqual(summary['status'], 'complete', text)
        self.assertGreater(summary['scans']['used'], 120)
        for topic in TOPICS:
            self.assertGreater(len(seen[topic]), 50 if topic in EVERY_SCAN else 0, topic)
            for message in seen[topic]:
                self.assertTrue(all(map(math.isfinite, numbers(message))), topic)

        # What the IMU cannot have measured is not integrated, nor a stamp from the future gone to.
        stamps = [message.header.stamp.to_sec() for message in seen['/imu_odometry']]
        self.assertEqual(stamps, sorted(set(stamps)))
        self.assertLess(stamps[-1], A_WHILE + seen['/lidar_odometry/state'][-1].header.stamp.to_sec())
        self.assertLess(max(speed(message) for message in seen['/imu_odometry']), FASTEST)

        states, last = seen['/lidar_odometry/state'], seen['/lidar_odometry/status'][-1]
        self.check_that_the_thin_scan_is_said(seen['/lidar_odometry/status'])
        self.assertIn((State.TOO_FEW_POINTS, 0), {(m.outcome, m.points) for m in states}, 'the empty scans')
        self.assertEqual(last.header.stamp, states[-1].header.stamp)
        self.assertGreater(min(count.count for count in last.dropped), 0)
        self.assertEqual({count.reason for count in last.dropped}, DROPPED)
        for count in last.dropped:
            # After the last status of all one more may have been dropped.
            late = count_of(summary, count.reason) - count.count
            self.assertTrue(0 <= late <= 1, '{}: {} fewer than in the summary'.format(count.reason, late))

    def check_that_the_thin_scan_is_said(self, statuses):
        thin = [m for m in statuses if m.outcome == State.TOO_FEW_POINTS and m.points > 0]
        self.assertGreater(len(thin), 0)
        for message in thin:
            self.assertEqual(message.level, Status.WARN, message.message)
            self.assertIn('the scan has too few points', message.message)

    def test_gaps_limits_and_what_is_switched_off_give_the_results_of_the_offline_runner(self):
        for faults, config, counts in SURVIVED:
            name = '_'.join(faults)
            if config != 'simulated':
                config = self.write(name + '.yaml', config)
            summary, text = self.expect_as_offline(self.mutate(name, *faults), name, config=config)
            self.assertEqual(summary['status'], 'complete', text)
            self.assertEqual({reason: count_of(summary, reason) for reason in counts}, counts, name)

    def test_a_clock_that_is_set_forward_starts_again_in_place_and_is_said(self):
        bag = self.mutate('forward', 'clock_set_forward')
        out, text = self.launch(bag, 'forward')
        expected = self.offline(bag, 'forward')
        self.assertIn('started again where it stood', text)
        self.assertEqual(summary_of(out)['imu']['starts_in_place'], 1)
        # How far the IMU's clock runs ahead of the scans' when it is set is left to the network.
        self.expect_same_counts(out, expected, text)
        rows, same = (read(d, 'trajectory.tum').splitlines() for d in (out, expected))
        self.assertEqual(len(rows), len(same))
        self.assertEqual(rows[:BEFORE_IT_IS_SET], same[:BEFORE_IT_IS_SET])

    def test_an_output_that_cannot_be_written_ends_node_and_launch_with_a_sentence(self):
        said = '/dev/null/out: cannot be created'
        node = run('rosrun', 'allan_lio', 'lidar_odometry_node', '_config:=simulated', '_out:=/dev/null/out')
        self.assertEqual(node.returncode, 1, node.stdout)
        self.assertIn(said, node.stdout)
        launched = run('roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=' + self.bag, 'out:=/dev/null/out')
        self.assertIn(said, launched.stdout)
        self.assertNotIn('samples played', launched.stdout)

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

    def test_a_full_disk_is_said_while_the_filter_goes_on_and_again_at_the_signal_that_ends_it(self):
        out = os.path.join(self.directory, 'full_live')
        os.makedirs(out)
        os.symlink('/dev/full', os.path.join(out, 'trajectory.tum'))
        lost = os.path.join(out, 'trajectory.tum') + ': could not be written'
        diagnostics, states = Recorder('/diagnostics', DiagnosticArray), Recorder('/filter/state', State)
        status = Recorder('/filter/status', Status)
        with open(os.path.join(out, 'log'), 'w') as log:
            node = subprocess.Popen(['rosrun', 'allan_lio', 'lidar_odometry_node', '__name:=filter',
                                     '_config:=simulated', '_out:=' + out], stdout=log, stderr=subprocess.STDOUT)
        # In real time, so that the bag does not end before the filter.
        player = self.start('rosrun', 'allan_lio', 'play_bag', self.bag, '--rate', '1', '--filter', 'filter')
        try:
            status.wait(1, lambda m: lost in m.message)
            reported = diagnostics.wait(1, lambda m: any(lost in v.value for s in m.status for v in s.values))
            # A byte in some versions of the message.
            self.assertEqual({bytes([s.level]) if isinstance(s.level, int) else s.level for s in reported.status},
                             {bytes([Status.ERROR])})
            self.assertEqual(states.wait(5).outcome, State.UPDATED)
            said = read(out, 'log').decode()
            self.assertEqual(said.count(lost + ' (is the disk full?); the odometry goes on'), 1, said)
            node.send_signal(signal.SIGINT)
            self.assertEqual(node.wait(TIME_LIMIT), 0)
        finally:
            self.end([player, node])
            for recorder in (diagnostics, states, status):
                recorder.end()
        at_the_end = read(out, 'log').decode()[len(said):]
        self.assertEqual(at_the_end.count(lost), 1, at_the_end)
        self.assertTrue(summary_of(out)['status'].startswith('incomplete: ' + lost))
        self.assertTrue(read(self.good, 'states.csv').startswith(read(out, 'states.csv')))

    # --- the end of the filter at any moment ---

    @staticmethod
    def start(*command):
        return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def start_node(self, out):
        """The process whose end ends the filter comes first here and below."""
        return [self.start('rosrun', 'allan_lio', 'lidar_odometry_node', '__name:=filter', '_config:=simulated',
                           '_out:=' + out)]

    def start_manager(self, out, manager=('allan_lio', 'nodelet_manager')):
        return [self.start('rosrun', *manager, '__name:=manager'),
                self.start('rosrun', 'nodelet', 'nodelet', 'load', 'allan_lio/LidarOdometry', 'manager',
                           '__name:=filter', '_config:=simulated', '_out:=' + out)]

    def start_foreign_manager(self, out):
        return self.start_manager(out, ('nodelet', 'nodelet', 'manager'))

    def start_nodelet(self, out):
        return self.start_manager(out)[::-1]

    def play(self, bag):
        return self.start('rosrun', 'allan_lio', 'play_bag', bag, '--rate', '4', '--filter', 'filter')

    @staticmethod
    def end(processes):
        for process in processes:
            process.terminate()
            process.wait(TIME_LIMIT)

    def interrupt(self, name, start, stop, delay, statuses=(0,)):
        """`stop` ends the first of the processes of `start`, `delay` [s] after its first results; None: before them."""
        out = os.path.join(self.directory, name)
        processes = start(out)
        waits_for = os.path.join(out, 'states.csv' if delay is None else 'trajectory.tum')
        player = [] if delay is None else [self.play(self.bag)]
        try:
            wait_until(lambda: os.path.exists(waits_for) and os.path.getsize(waits_for) > 0, waits_for)
            time.sleep(delay or 0.0)
            stop(processes[0])
            self.assertIn(processes[0].wait(TIME_LIMIT), statuses, name)
            self.expect_whole(out)
        finally:
            self.end(player + processes)

    def expect_whole(self, out):
        summary = summary_of(out)
        self.assertEqual(summary['status'], 'interrupted')
        rows = read(out, 'trajectory.tum')
        self.assertEqual(rows.count(b'\n'), summary['scans']['used'])
        for file in ('trajectory.tum', 'states.csv'):
            written = read(out, file)
            self.assertIn(written[-1:], (b'', b'\n'), file)
            self.assertTrue(read(self.good, file).startswith(written), file)
            self.assertLess(len(written), len(read(self.good, file)))

    def test_signals_to_the_node_leave_whole_files(self):
        for number, name in ((signal.SIGTERM, 'term'), (signal.SIGINT, 'int')):
            for delay in (0.0, 0.83):
                self.interrupt('node_{}_{}'.format(name, delay), self.start_node,
                               lambda process: process.send_signal(number), delay)

    def test_a_signal_to_the_manager_leaves_whole_files(self):
        for delay in (0.1, 0.57):
            self.interrupt('manager_{}'.format(delay), self.start_manager,
                           lambda process: process.send_signal(signal.SIGTERM), delay)

    def test_a_signal_to_nodelets_own_manager_leaves_whole_files(self):
        self.interrupt('foreign', self.start_foreign_manager,
                       lambda process: process.send_signal(signal.SIGTERM), 0.1, FOREIGN_MANAGER_STATUSES)

    def test_unloading_the_nodelet_leaves_whole_files(self):
        for delay in UNLOADED_AFTER:
            self.interrupt('unload_{}'.format(delay), self.start_nodelet,
                           lambda process: process.send_signal(signal.SIGINT), delay)

    def test_a_signal_before_the_first_scan_leaves_whole_files(self):
        for start in (self.start_node, self.start_manager):
            for number in (signal.SIGINT, signal.SIGTERM):
                self.interrupt('early_{}_{}'.format(start.__name__, int(number)), start,
                               lambda process: process.send_signal(number), None)

    def test_a_signal_while_the_node_makes_its_topics_leaves_whole_files(self):
        # Of what it advertises next, nothing is a topic any more.
        for topic in ('status', 'parameter_descriptions'):
            out = os.path.join(self.directory, 'starts_' + topic)
            master = HeldMaster('/starts/' + topic)
            node = self.start('env', 'ROS_MASTER_URI=' + master.uri, 'rosrun', 'allan_lio', 'lidar_odometry_node',
                              '__name:=starts', '_config:=simulated', '_out:=' + out)
            try:
                wait_until(master.held.is_set, 'the node advertises ' + topic)
                node.send_signal(signal.SIGTERM)
                self.assertEqual(node.wait(TIME_LIMIT), 0, topic)
                self.expect_whole(out)
            finally:
                master.end()
                self.end([node])

    def test_a_signal_while_the_node_waits_for_extrinsics_is_no_error(self):
        config = self.write('waits.yaml', 'include: [robots/simulated]\nframes: {extrinsics_from_tf: true}\n')
        for name in ('lidar_odometry_node', 'imu_propagation_node'):
            tf = rospy.Publisher('/tf_static', TFMessage, queue_size=1)
            node = self.start('rosrun', 'allan_lio', name, '__name:=waits', '_config:=' + config)
            try:
                wait_until(lambda: tf.get_num_connections() > 0, 'the node waits')
                node.send_signal(signal.SIGTERM)
                self.assertEqual(node.wait(TIME_LIMIT), 0, name)
            finally:
                tf.unregister()
                self.end([node])

    def test_rosnode_kill_leaves_whole_files(self):
        for start in (self.start_node, self.start_nodelet):
            self.interrupt('kill_' + start.__name__, start, lambda _: run_well('rosnode', 'kill', '/filter'), 0.3)

    def stop_a_writer(self, name, bag, last_before):
        """Ends the manager while it writes what follows the state of `last_before` [s].

        The trajectory is a pipe with room for its first row: whoever writes the next ones stands still until somebody
        reads. By then the manager has let go of the nodelet: only the nodelet's callback queue keeps it alive.
        """
        out = os.path.join(self.directory, name)
        trajectory = os.path.join(out, 'trajectory.tum')
        os.makedirs(out)
        os.mkfifo(trajectory)
        pipe = os.open(trajectory, os.O_RDWR | os.O_NONBLOCK)
        filler = b'x' * (fcntl.fcntl(pipe, F_SETPIPE_SZ, 4096) - ROOM_OF_A_ROW)
        os.write(pipe, filler)
        states = Recorder('/filter/state', State)
        processes = self.start_manager(out)
        manager = processes[0]
        try:
            wait_until(lambda: states.subscriber.get_num_connections() > 0, 'the filter is connected')
            processes.append(self.play(bag))
            wait_until(lambda: states.messages and states.messages[-1].header.stamp.to_sec() > last_before - 1e-3,
                       'the last state before the writer stands still')
            time.sleep(A_WHILE)  # the next scan's callback begins, or that of the end
            manager.send_signal(signal.SIGTERM)
            time.sleep(A_WHILE)  # the manager has come to delete its nodelets
            self.assertIsNone(manager.poll())
            written, until = b'', time.time() + TIME_LIMIT
            while time.time() < until and (manager.poll() is None or select.select([pipe], [], [], 0.0)[0]):
                if select.select([pipe], [], [], 0.02)[0]:
                    written += os.read(pipe, 65536)
        finally:
            states.end()
            os.close(pipe)
            self.end(processes)
        self.assertEqual(manager.returncode, 0)
        os.remove(trajectory)
        with open(trajectory, 'wb') as file:
            file.write(written[len(filler):])
        self.assertGreater(len(written), len(filler) + 2 * ROOM_OF_A_ROW, 'no callback stood still')
        return out

    def test_a_signal_in_the_midst_of_a_callback_leaves_whole_files(self):
        stamps = stamps_of(self.good)
        # Rows are written out every second of data.
        self.expect_whole(self.stop_a_writer('midst', self.bag, max(t for t in stamps if t < stamps[0] + 1.0)))

    def test_a_signal_while_the_run_ends_leaves_whole_files(self):
        bag = os.path.join(self.directory, 'second.bag')
        run_well('rosrun', 'allan_lio', 'simulate_bag', *ROOMS, '--duration', '1', '--out', bag)
        expected = self.offline(bag, 'second')
        out = self.stop_a_writer('finish', bag, stamps_of(expected)[-1])
        self.assertEqual(summary_of(out)['status'], 'complete')
        for file in ('trajectory.tum', 'states.csv'):
            self.assertEqual(read(out, file), read(expected, file), file)


if __name__ == '__main__':
    rostest.rosrun('allan_lio', 'faults', Faults)
