#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a field engineer does to the nodelets while they run: other parameters, services, status, several of them."""
import math
import operator
import os
import re
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
import xmlrpc.client

import dynamic_reconfigure.client
import rosbag
import rospy
import rostest
import yaml
from allan_lio.msg import State, Status
from allan_lio.srv import SaveMap, SetPose
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, PointCloud2
from std_srvs.srv import Trigger
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray

from ros_support import SLOWER, TIME_LIMIT, Recorder, read, run, run_well, wait_until

RATE = 2  # times real time
GYRO_BIAS = 9  # its first row in State.covariance
IMU_PERIOD = 0.005  # of simulate_bag [s]
UNDER_WAY = 2  # scans that may have been taken before a parameter that was set just now
ARRIVED = 1.0 * SLOWER  # [s] after which a parameter that was set has reached the nodelet
SET_POSE = (40.0, -30.0, 2.0)  # [m]
SIGMA_SET = 0.3  # [m]
BACK = 1.0  # [s] that the stamps must go back by for a new recording
SETTLED = 20  # numbers after a gap until it counts (SequenceWatch)
CORRIDOR = ['--scene', 'corridor', '--max-range', '20', '--imu', 'mti600', '--lidar', 'velodyne16', '--seed', '1',
            '--duration', '50']
IN_THE_CORRIDOR = 400  # scans, after which neither end of it is within the LiDAR's range
ALONG = 0.95  # cosine of the angle between the way down the corridor and the weak axis, at least
NEAR = 2.0  # [m] that the simulated robot walks in the second or so after a pose was set

TWO_ROBOTS = """<launch>
  <node pkg="nodelet" type="nodelet" name="manager" args="manager"/>
  <group ns="a">
    <node pkg="nodelet" type="nodelet" name="lidar_odometry" args="load allan_lio/LidarOdometry /manager">
      <param name="config" value="simulated"/>
    </node>
    <node pkg="nodelet" type="nodelet" name="imu_propagation" args="load allan_lio/ImuPropagation /manager">
      <param name="config" value="simulated"/>
      <remap from="state" to="lidar_odometry/state"/>
    </node>
  </group>
  <group ns="b">
    <node pkg="nodelet" type="nodelet" name="lidar_odometry" args="load allan_lio/LidarOdometry /manager">
      <param name="config" value="simulated"/>
      <param name="frames/odom" value="odom_b"/>
      <param name="frames/publish_tf" value="false"/>
      <remap from="/imu/data" to="/b/imu"/>
      <remap from="/points" to="/b/points"/>
      <remap from="/diagnostics" to="/b/diagnostics"/>
    </node>
    <node pkg="nodelet" type="nodelet" name="imu_propagation" args="load allan_lio/ImuPropagation /manager">
      <param name="config" value="simulated"/>
      <param name="frames/odom" value="odom_b"/>
      <remap from="state" to="lidar_odometry/state"/>
      <remap from="/imu/data" to="/b/imu"/>
    </node>
  </group>
</launch>
"""


PROPAGATION = """<launch>
  <node pkg="nodelet" type="nodelet" name="propagation_manager" args="manager" output="screen"/>
  <node pkg="nodelet" type="nodelet" name="imu_propagation" args="load allan_lio/ImuPropagation propagation_manager"
        clear_params="true" output="screen">
    <param name="config" value="simulated"/>
    <param name="imu/k_gb" value="3"/>
    <param name="imu/gravity" value="9.81"/>
  </node>
</launch>
"""


def sigma(state, index):
    return math.sqrt(state.covariance[24 * index])


def position(odometry):
    p = odometry.pose.pose.position
    return p.x, p.y, p.z


def stamp_of(message):
    """[s]"""
    header = message.transforms[0].header if isinstance(message, TFMessage) else message.header
    return header.stamp.to_sec()


def level_of(status):
    """A byte in some versions of the message."""
    return ord(status.level) if isinstance(status.level, bytes) else status.level


def pid_of(node):
    return xmlrpc.client.ServerProxy(rospy.get_master().lookupNode(node)[2]).getPid(rospy.get_name())[2]


def unload(nodelet, manager):
    run_well('rosrun', 'nodelet', 'nodelet', 'unload', nodelet, manager)


def real_time_threads(pid):
    """The priorities of a process's threads under SCHED_FIFO."""
    threads = [int(thread) for thread in os.listdir('/proc/{}/task'.format(pid))]
    return [os.sched_getparam(t).sched_priority for t in threads
            if os.sched_getscheduler(t) & ~os.SCHED_RESET_ON_FORK == os.SCHED_FIFO]


def real_time_is_allowed():
    asks = 'import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))'
    return run('/usr/bin/python3', '-c', asks).returncode == 0


class PacedPlayer:
    """Publishes a bag's sensors as far as it is told."""

    def __init__(self, bag):
        self.messages = rosbag.Bag(bag).read_messages(['/imu/data', '/points'])
        self.publishers = {'/imu/data': rospy.Publisher('/imu/data', Imu, queue_size=4000),
                           '/points': rospy.Publisher('/points', PointCloud2, queue_size=20)}
        wait_until(lambda: all(p.get_num_connections() for p in self.publishers.values()), 'the nodelets listen')

    def scans(self, count):
        while count > 0:
            topic, message, _ = next(self.messages)
            self.publishers[topic].publish(message)
            count -= topic == '/points'
        time.sleep(0.1)  # the sweep's time

    def skip(self, topic, count):
        """As if so many messages had been lost on their way: rospy numbers them by this count."""
        self.publishers[topic].impl.seq += count


class LiveNode(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.mkdtemp(prefix='allan_lio_live_node_')
        cls.bag = os.path.join(cls.directory, 'small.bag')
        run_well('rosrun', 'allan_lio', 'simulate_bag', '--scene', 'rooms', '--imu', 'mti600', '--lidar', 'velodyne16',
                 '--seed', '1', '--duration', '40', '--out', cls.bag)
        rospy.init_node('live_node_test')

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.directory, ignore_errors=True)

    def start(self, *command, log='log', directory=None):
        log = open(os.path.join(self.directory, log), 'w')
        process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, cwd=directory)

        def end():
            process.send_signal(signal.SIGINT)
            process.wait(TIME_LIMIT)
            log.close()

        self.addCleanup(end)
        return end

    def launch(self):
        """bag.launch as it ships, at a rate that leaves time to interfere."""
        return self.start('roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=' + self.bag,
                          'rate:=' + str(RATE), 'out:=' + os.path.join(self.directory, 'out'))

    def said(self):
        """What the nodes of the launch have printed."""
        return read(self.directory, 'log').decode()

    def refusals(self, words):
        """The lines that say that a value is refused, and these words."""
        return [line for line in self.said().splitlines() if 'refused: ' in line and words in line]

    def wait_for_parameter(self, name, value):
        until = time.time() + TIME_LIMIT
        while time.time() < until and rospy.get_param(name, None) != value:
            time.sleep(0.02)
        self.assertEqual(rospy.get_param(name, None), value)

    def test_parameters_change_while_the_filter_runs_and_bad_ones_are_refused_and_set_back(self):
        states = Recorder('/lidar_odometry/state', State)
        status = Recorder('/lidar_odometry/status', Status)
        end = self.launch()
        before = states.wait(30)
        self.assertEqual(before.k_gb, 1.0)
        rospy.set_param('/lidar_odometry/imu/k_gb', 25)
        changed = states.wait(1, lambda m: m.k_gb == 25.0)
        # 25 times the random walk: within a second the bias is less sure than it was.
        grown = states.wait(15)
        self.assertGreater(sigma(grown, GYRO_BIAS), 1.5 * sigma(before, GYRO_BIAS))
        self.assertEqual(changed.k_ab, 1.0)
        self.assertEqual(rospy.get_param('/lidar_odometry/in_force/imu/k_gb'), 25)

        self.assertNotEqual(before.config_hash, changed.config_hash)
        self.assertEqual(status.wait(1).config_hash, changed.config_hash)

        bad_values = (-3.0, 'many', 0, [[1]], {}, {'a': 1})
        for bad in bad_values:
            rospy.set_param('/lidar_odometry/imu/k_gb', bad)
            self.wait_for_parameter('/lidar_odometry/imu/k_gb', 25)
        self.assertEqual(len(self.refusals('imu/k_gb stays 25')), len(bad_values), self.said())
        rospy.set_param('/lidar_odometry/map/voxel_size', 2.0)
        rospy.set_param('/lidar_odometry/imu/k_gbb', 2.0)
        self.wait_for_parameter('/lidar_odometry/map/voxel_size', None)
        self.wait_for_parameter('/lidar_odometry/imu/k_gbb', None)
        in_force = rospy.get_param('/lidar_odometry/in_force/map/voxel_size')
        self.assertEqual(len(self.refusals('map/voxel_size stays {:g}'.format(in_force))), 1, self.said())
        unknown = self.refusals('all that is in force stays')
        self.assertEqual(len(unknown), 1, self.said())
        self.assertIn("'imu/k_gbb'", unknown[0])
        self.assertEqual(len(self.refusals('')), len(bad_values) + 2, self.said())
        now = status.wait(2)
        self.assertEqual((now.k_gb, now.k_g, now.k_r), (25.0, 1.0, 1.0))

        end()
        summary = yaml.safe_load(read(self.directory, 'out', 'summary.yaml'))
        for suffix, config_hash, k_gb in (('', changed.config_hash, 25), ('_at_start', before.config_hash, 1)):
            self.assertEqual(summary['parameters_hash' + suffix], config_hash)
            self.assertEqual(summary['parameters' + suffix]['imu']['k_gb'], k_gb)

    def test_a_value_that_is_none_is_set_back_and_does_not_hold_up_the_others(self):
        states = Recorder('/lidar_odometry/state', State)
        self.launch()
        states.wait(5)
        # At once, so that the filter sees both together.
        rospy.set_param('/lidar_odometry/imu', {'k_g': [[1]], 'k_gb': 4, 'gravity': {}})
        self.assertEqual(states.wait(1, lambda m: m.k_gb == 4.0).k_g, 1.0)
        self.wait_for_parameter('/lidar_odometry/imu/k_g', 1)
        self.wait_for_parameter('/lidar_odometry/imu/gravity', None)
        self.assertEqual(len(self.refusals('imu/k_g stays 1')), 1, self.said())
        self.assertEqual(len(self.refusals('imu/gravity stays 9.80665')), 1, self.said())
        # Values in the place of groups: what stood below them stands there again.
        rospy.set_param('/lidar_odometry/imu', 3)
        self.wait_for_parameter('/lidar_odometry/imu', {'k_g': 1, 'k_gb': 4})
        self.assertEqual(len(self.refusals('all that is in force stays')), 1, self.said())
        # What is deleted stays in force, without a word.
        rospy.delete_param('/lidar_odometry/imu/k_g')
        rospy.delete_param('/lidar_odometry/imu/k_gb')
        rospy.set_param('/lidar_odometry/lidar/k_r', 2)
        self.assertEqual(states.wait(1, lambda m: m.k_r == 2.0).k_gb, 4.0)
        self.assertEqual(rospy.get_param('/lidar_odometry/imu'), {})
        self.assertEqual(len(self.refusals('')), 3, self.said())

    def test_the_propagation_says_that_the_multipliers_are_the_filters(self):
        file = os.path.join(self.directory, 'propagation.launch')
        with open(file, 'w') as launch:
            launch.write(PROPAGATION)
        self.start('roslaunch', '--wait', file)
        wait_until(lambda: 'has no effect' in self.said(), 'a warning')
        self.assertIn('imu/k_gb (rosparam /imu_propagation/imu/k_gb) has no effect', self.said())
        self.assertEqual(self.said().count('has no effect'), 1, self.said())
        self.assertEqual(rospy.get_param('/imu_propagation/in_force/frames/odom'), 'odom')
        self.assertFalse(rospy.has_param('/imu_propagation/in_force/imu/k_gb'))

    def test_numbers_that_a_topic_skips_are_messages_lost_before_they_arrived(self):
        self.start('roslaunch', '--wait', 'allan_lio', 'lio.launch')
        rospy.wait_for_service('/lidar_odometry/finish', TIME_LIMIT)
        status = Recorder('/lidar_odometry/status', Status)
        play = PacedPlayer(self.bag)

        def lost():
            counts = {count.reason: count.count for count in status.messages[-1].dropped} if status.messages else {}
            return [counts.get(sensor + ': lost_before_arrival', 0) for sensor in ('imu', 'scans')]

        for _ in range(SETTLED + 5):
            play.scans(1)
        self.assertEqual(lost(), [0, 0])
        play.skip('/imu/data', 7)
        play.skip('/points', 3)
        for _ in range(SETTLED + 5):
            play.scans(1)
        wait_until(lambda: lost() == [7, 3], 'the losses are in ~status')

    def test_a_parameter_that_is_set_between_two_scans_is_in_force_in_the_next_one(self):
        self.start('roslaunch', '--wait', 'allan_lio', 'lio.launch')
        rospy.wait_for_service('/lidar_odometry/finish', TIME_LIMIT)
        states = Recorder('/lidar_odometry/state', State)
        play = PacedPlayer(self.bag)
        while not states.messages:
            play.scans(1)
        for k_gb in (25, 4):
            time.sleep(ARRIVED)  # for the states of scans that are on their way
            seen = len(states.messages)
            rospy.set_param('/lidar_odometry/imu/k_gb', k_gb)
            time.sleep(ARRIVED)
            while len(states.messages) == seen:
                play.scans(1)
            self.assertEqual(states.messages[seen].k_gb, k_gb)

    def test_the_odometry_at_imu_rate_doubts_saturated_readings_by_the_range_in_force(self):
        self.start('roslaunch', '--wait', 'allan_lio', 'lio.launch')
        rospy.wait_for_service('/lidar_odometry/finish', TIME_LIMIT)
        states, odometry = Recorder('/lidar_odometry/state', State), Recorder('/imu_odometry', Odometry)
        play = PacedPlayer(self.bag)

        def growth():
            """Median growth of the velocity's variance from one reading to the next, over the next two sweeps."""
            play.scans(1)
            begin = len(odometry.messages)
            play.scans(2)
            time.sleep(ARRIVED)
            variances = [message.twist.covariance[0] for message in odometry.messages[begin:]]
            self.assertGreater(len(variances), 10)
            return sorted(b - a for a, b in zip(variances, variances[1:]))[len(variances) // 2]

        while len(states.messages) < 3:
            play.scans(1)
        before = growth()
        rospy.set_param('/lidar_odometry/imu/accel_range', 5.0)  # less than gravity: all readings are at their limit
        while states.messages[-1].accel_range != 5.0:
            play.scans(1)
        # An acceleration beyond the range by 1 m/s^2 (1 sigma) for a period of the IMU.
        missed = (0.2 * 5.0 * IMU_PERIOD) ** 2
        self.assertLess(before, 0.1 * missed)
        self.assertGreater(growth(), 0.5 * missed)

    def test_dynamic_reconfigure_shows_the_declaration_and_changes_what_it_may(self):
        states = Recorder('/lidar_odometry/state', State)
        self.launch()
        states.wait(5)
        client = dynamic_reconfigure.client.Client('/lidar_odometry', timeout=TIME_LIMIT)
        described = {p['name']: p for p in client.get_parameter_descriptions(timeout=TIME_LIMIT)}
        self.assertIn('calibrated value', described['imu/k_gb']['description'])
        self.assertEqual((described['imu/k_gb']['min'], described['imu/k_gb']['default']), (0.0, 1.0))
        self.assertEqual((described['update/max_iterations']['min'], described['update/max_iterations']['max']), (1, 50))
        self.assertNotIn('map/voxel_size', described)

        self.assertEqual(client.update_configuration({'imu/k_ab': 3.0, 'lidar/k_r': 2.0})['imu/k_ab'], 3.0)
        changed = states.wait(1, lambda m: m.k_ab == 3.0)
        self.assertEqual((changed.k_r, changed.k_gb), (2.0, 1.0))
        self.assertEqual(rospy.get_param('/lidar_odometry/imu/k_ab'), 3)
        self.assertEqual(rospy.get_param('/lidar_odometry/in_force/lidar/k_r'), 2)
        self.assertEqual(client.update_configuration({'imu/k_ab': -1.0})['imu/k_ab'], 3.0)
        self.assertEqual(len(self.refusals('imu/k_ab stays 3')), 1, self.said())
        self.assertEqual(states.wait(3).k_ab, 3.0)
        client.close()

    def test_services_save_the_map_set_the_pose_and_start_again(self):
        odometry = Recorder('/lidar_odometry/odometry', Odometry)
        self.launch()
        odometry.wait(30)
        save = rospy.ServiceProxy('/lidar_odometry/save_map', SaveMap)
        out, elsewhere = os.path.join(self.directory, 'out'), os.path.join(self.directory, 'elsewhere.pcd')
        for path, expected in (('', os.path.join(out, 'map.pcd')), ('part.pcd', os.path.join(out, 'part.pcd')),
                               (elsewhere, elsewhere)):
            saved = save(path)
            self.assertTrue(saved.success, saved.message)
            self.assertTrue(saved.message.startswith(expected + ': '), saved.message)
            header = read(expected)[:400]
            self.assertIn(b'FIELDS x y z', header)
            self.assertIn(b'POINTS ' + saved.message.split()[-2].encode(), header)
        refused = save('/nowhere/map.pcd')
        self.assertFalse(refused.success)
        self.assertIn('/nowhere/map.pcd', refused.message)

        request = PoseWithCovarianceStamped()
        request.header.frame_id = 'odom'
        request.pose.pose.position.x, request.pose.pose.position.y, request.pose.pose.position.z = SET_POSE
        request.pose.pose.orientation.w = 1.0
        request.pose.covariance[0] = request.pose.covariance[7] = SIGMA_SET ** 2
        set_pose = rospy.ServiceProxy('/lidar_odometry/set_pose', SetPose)
        self.assertTrue(set_pose(request).success)
        moved = odometry.wait(1 + UNDER_WAY)
        self.assertLess(math.dist(position(moved), SET_POSE), NEAR)
        self.assertAlmostEqual(math.sqrt(moved.pose.covariance[0]), SIGMA_SET, delta=0.1 * SIGMA_SET)
        request.header.frame_id = 'map'
        self.assertFalse(set_pose(request).success)

        reset = rospy.ServiceProxy('/lidar_odometry/reset', Trigger)
        self.assertTrue(reset().success)
        again = odometry.wait(1 + UNDER_WAY)
        self.assertLess(math.dist(position(again), (0, 0, 0)), NEAR)
        self.assertLess(math.sqrt(again.pose.covariance[0]), SIGMA_SET)

    def test_without_an_output_the_map_is_saved_in_the_nodes_own_directory(self):
        own = os.path.join(self.directory, 'own')
        os.makedirs(own)
        odometry = Recorder('/without_out/odometry', Odometry)
        self.start('rosrun', 'allan_lio', 'lidar_odometry_node', '__name:=without_out', '_config:=simulated',
                   log='own_log', directory=own)
        self.start('rosrun', 'allan_lio', 'play_bag', self.bag, '--rate', str(RATE), '--filter', 'without_out',
                   log='player')
        odometry.wait(10)
        save = rospy.ServiceProxy('/without_out/save_map', SaveMap)
        for path, name in (('', 'map.pcd'), ('part.pcd', 'part.pcd'), ('./again.pcd', 'again.pcd')):
            saved = save(path)
            self.assertTrue(saved.success, saved.message)
            self.assertEqual(os.path.normpath(saved.message.split(': ')[0]), os.path.join(own, name))
            self.assertIn(b'FIELDS x y z', read(own, name)[:400])

    def test_a_latency_beyond_the_limit_is_told_and_is_a_failure(self):
        bag = os.path.join(self.directory, 'short.bag')
        run_well('rosrun', 'allan_lio', 'simulate_bag', '--scene', 'rooms', '--imu', 'mti600', '--lidar', 'velodyne16',
                 '--seed', '1', '--duration', '4', '--out', bag)
        self.start('roslaunch', '--wait', 'allan_lio', 'lio.launch', log='latency')
        rospy.wait_for_service('/lidar_odometry/finish', TIME_LIMIT)
        measured = run('rosrun', 'allan_lio', 'imu_latency', bag, '--limit', '1e-9')
        self.assertEqual(measured.returncode, 1, measured.stdout)
        self.assertIn(' messages, 0.000 % within 1e-06 ms; median ', measured.stdout)
        self.assertIn('that is less than 99.9 %', measured.stdout)

    def test_a_simulated_clock_that_is_set_back_is_said_once_and_all_goes_on(self):
        rospy.set_param('/use_sim_time', True)
        self.addCleanup(rospy.delete_param, '/use_sim_time')
        self.start('roslaunch', '--wait', 'allan_lio', 'lio.launch', log='clock')
        recorders = {'/lidar_odometry/odometry': Recorder('/lidar_odometry/odometry', Odometry),
                     '/imu_odometry': Recorder('/imu_odometry', Odometry), '/tf': Recorder('/tf', TFMessage)}
        odometry = recorders['/lidar_odometry/odometry']
        play = ('rosrun', 'allan_lio', 'play_bag', self.bag, '--rate', str(RATE))
        end = self.start(*play)
        odometry.wait(30)
        end()
        turned = stamp_of(odometry.messages[-1])
        begun = {topic: len(recorder.messages) for topic, recorder in recorders.items()}
        self.start(*play)
        odometry.wait(1, lambda m: stamp_of(m) < turned - BACK)
        odometry.wait(1, lambda m: stamp_of(m) > turned)
        for topic, recorder in recorders.items():
            again = [m for m in recorder.messages[begun[topic]:] if stamp_of(m) < turned - BACK]
            self.assertGreater(len(again), 10, topic)
            self.assertGreater(stamp_of(recorder.messages[-1]), turned - BACK, topic)
            self.assertEqual(again, sorted(again, key=stamp_of), topic)
        self.assertEqual(read(self.directory, 'clock').count(b'the stamps went back by'), 1)

    def test_status_diagnostics_and_markers_say_how_it_goes(self):
        status = Recorder('/lidar_odometry/status', Status)
        markers = Recorder('/lidar_odometry/markers', MarkerArray)
        diagnostics = Recorder('/diagnostics', DiagnosticArray)
        end = self.launch()
        last = status.wait(60)
        self.assertEqual(last.level, Status.OK, last.message)
        self.assertIn('follows', last.message)
        self.assertTrue(50 <= last.nis_scans <= 100, last.nis_scans)
        self.assertLess(last.nis_low, 1.0)
        self.assertGreater(last.nis_high, 1.0)
        self.assertGreater(last.nis_mean, 0.0)
        self.assertEqual((last.weak_axes, len(last.probability), list(last.dropped)), (0, 6, []))
        self.assertTrue(0.0 < last.scan_time_mean < 0.1 and 0.0 < last.map_mb < last.map_max_mb)
        # By the clock of the bag, which is simulated time for this launch alone.
        self.assertTrue(-0.1 < last.delay < 0.5, last.delay)
        self.assertFalse(rospy.get_param('/use_sim_time', False))
        self.assertGreater(last.gyro_bias_sigma.x, 0.0)
        self.assertEqual(len(markers.wait(1).markers), 7)
        # One report a second: a look around a corner may leave a direction to the IMU just then, and says so.
        report = diagnostics.wait(1, lambda m: any('lidar_odometry' in s.name and level_of(s) == 0
                                                   for s in m.status)).status[0]
        self.assertEqual(report.name, 'lidar_odometry: odometry')
        self.assertIn('follows', report.message)
        self.assertIn('CPU per scan [ms]', [v.key for v in report.values])
        end()

    def test_in_a_corridor_state_and_diagnostics_name_the_weak_axis(self):
        bag = os.path.join(self.directory, 'corridor.bag')
        run_well('rosrun', 'allan_lio', 'simulate_bag', *CORRIDOR, '--out', bag)
        states = Recorder('/lidar_odometry/state', State)
        diagnostics = Recorder('/diagnostics', DiagnosticArray)

        def named(report):
            values = [v.value for s in report.status for v in s.values if v.key == 'weak axes in odom']
            return values[0] if values else ''

        self.start('roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=' + bag, 'rate:=' + str(RATE))
        states.wait(IN_THE_CORRIDOR)
        words = named(diagnostics.wait(1, lambda m: named(m).startswith('translation along')))
        weak = states.wait(1, lambda m: m.support[0] < 0.5)
        before = states.messages[-40]
        way = [getattr(weak.position, axis) - getattr(before.position, axis) for axis in 'xyz']
        way = [w / math.hypot(*way) for w in way]
        along = weak.directions[3:6]
        self.assertGreater(abs(sum(map(operator.mul, way, along))), ALONG * math.hypot(*along), weak.directions)
        axis = [float(n) for n in re.match(r'translation along \((\S+) (\S+) (\S+)\)', words).groups()]
        self.assertGreater(abs(sum(map(operator.mul, way, axis))), ALONG, words)

    def test_the_way_of_an_imu_message_has_real_time_priority_and_a_scan_has_not(self):
        odometry = Recorder('/imu_odometry', Odometry)
        self.launch()
        odometry.wait(1)
        pid = pid_of('/lio_manager')
        # The thread that propagates, and the one that reads the sockets.
        self.assertEqual(real_time_threads(pid), [1, 1] if real_time_is_allowed() else [])
        unload('/imu_propagation', '/lio_manager')
        self.assertEqual(real_time_threads(pid), [])

    def check_that_an_unloaded_propagation_leaves_the_other_its_priority(self, manager):
        at_imu_rate = [Recorder('/{}/imu_odometry'.format(robot), Odometry) for robot in 'ab']
        self.assertEqual(at_imu_rate[0].wait(20).header.frame_id, 'odom')
        self.assertEqual(at_imu_rate[1].wait(20).header.frame_id, 'odom_b')
        unload('/a/imu_propagation', '/manager')
        gone = len(at_imu_rate[0].messages)
        at_imu_rate[1].wait(20)
        self.assertLessEqual(len(at_imu_rate[0].messages), gone + 1)
        self.assertEqual(real_time_threads(manager), [1, 1] if real_time_is_allowed() else [])

    def test_two_robots_share_a_manager_and_nothing_else_and_a_bag_played_again_starts_them_again(self):
        file = os.path.join(self.directory, 'two.launch')
        with open(file, 'w') as launch:
            launch.write(TWO_ROBOTS)
        self.start('roslaunch', '--wait', file)
        a, b = Recorder('/a/lidar_odometry/odometry', Odometry), Recorder('/b/lidar_odometry/odometry', Odometry)
        states_a, states_b = Recorder('/a/lidar_odometry/state', State), Recorder('/b/lidar_odometry/state', State)
        diagnostics = [Recorder(topic, DiagnosticArray) for topic in ('/diagnostics', '/b/diagnostics')]
        relays = [rospy.Subscriber(source, kind, rospy.Publisher(sink, kind, queue_size=4000).publish, queue_size=4000)
                  for source, sink, kind in (('/imu/data', '/b/imu', Imu), ('/points', '/b/points', PointCloud2))]
        rospy.wait_for_service('/b/lidar_odometry/finish', TIME_LIMIT)
        play = ('rosrun', 'allan_lio', 'play_bag', self.bag, '--rate', str(RATE), '--filter', '/a/lidar_odometry')
        end = self.start(*play)
        b.wait(20)
        rospy.set_param('/b/lidar_odometry/imu/k_gb', 9)
        states_b.wait(1, lambda m: m.k_gb == 9.0)
        self.assertEqual(states_a.wait(2).k_gb, 1.0)
        self.assertEqual({m.header.frame_id for m in a.messages}, {'odom'})
        self.assertEqual({m.header.frame_id for m in b.messages}, {'odom_b'})
        self.check_that_an_unloaded_propagation_leaves_the_other_its_priority(pid_of('/manager'))
        for recorder, robot in zip(diagnostics, 'ab'):
            recorder.wait(1)
            self.assertEqual({s.name for m in recorder.messages for s in m.status}, {robot + '/lidar_odometry: odometry'})
        poses = {m.header.stamp: position(m) for m in a.messages[:15]}
        common = [m for m in b.messages[:15] if m.header.stamp in poses]
        self.assertGreater(len(common), 5)
        for message in common:
            self.assertEqual(position(message), poses[message.header.stamp])
        end()
        first_pass = a.messages[-1].header.stamp
        self.start(*play)
        a.wait(3, lambda m: m.header.stamp < first_pass)
        self.assertLess(math.dist(position(a.messages[-1]), (0, 0, 0)), NEAR)
        for relay in relays:
            relay.unregister()


if __name__ == '__main__':
    rostest.rosrun('allan_lio', 'live_node', LiveNode)
