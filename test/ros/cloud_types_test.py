#!/usr/bin/python3
# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Gives the running nodelets a LiDAR topic of Livox's CustomMsg, whose package is not installed, and of a wrong type."""
import os
import shutil
import struct
import subprocess
import tempfile
import unittest

import rosbag
import rospy
import rostest
from sensor_msgs.msg import LaserScan

from ros_support import TIME_LIMIT, read, run, run_well

LIVOX_TYPE = 'livox_ros_driver/CustomMsg'
LIVOX_MD5SUM = 'e4d6829bdfe657cb6c21a746c86b21a6'
LIVOX_DEFINITION = """std_msgs/Header header
uint64 timebase
uint32 point_num
uint8 lidar_id
uint8[3] rsvd
CustomPoint[] points
"""


def livox_bytes(cloud):
    """A cloud of simulate_bag (x, y, z, intensity float32, ring uint16, time float32) as Livox's driver sends it."""
    points = [struct.unpack_from('<ffffHf', cloud.data, at) for at in range(0, len(cloud.data), cloud.point_step)]
    frame, stamp = b'livox_frame', cloud.header.stamp
    out = struct.pack('<IIII', 0, stamp.secs, stamp.nsecs, len(frame)) + frame
    out += struct.pack('<QIII', stamp.to_nsec(), len(points), 0, len(points))
    return out + b''.join(struct.pack('<IfffBBB', round(1e9 * time), x, y, z, min(255, int(intensity)), 0, ring % 6)
                          for x, y, z, intensity, ring, time in points)


class CloudTypes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = tempfile.mkdtemp(prefix='allan_lio_cloud_types_')
        cls.bag = os.path.join(cls.directory, 'small.bag')
        run_well('rosrun', 'allan_lio', 'simulate_bag', '--scene', 'rooms', '--imu', 'mti600', '--lidar', 'velodyne16',
                 '--seed', '1', '--duration', '4', '--out', cls.bag)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.directory, ignore_errors=True)

    def converted(self, name, write_cloud):
        """A copy of the bag whose clouds write_cloud(bag, cloud, time) writes."""
        path = os.path.join(self.directory, name)
        with rosbag.Bag(self.bag) as source, rosbag.Bag(path, 'w') as target:
            for topic, message, time in source.read_messages():
                if topic == '/points':
                    write_cloud(target, message, time)
                else:
                    target.write(topic, message, time)
        return path

    def launch(self, bag, name):
        out = os.path.join(self.directory, name)
        return out, run('roslaunch', '--wait', 'allan_lio', 'bag.launch', 'bag:=' + bag, 'out:=' + out)

    def test_livox_custom_messages_give_the_results_of_the_offline_runner(self):
        class CustomMsg:
            _type, _md5sum, _full_text = LIVOX_TYPE, LIVOX_MD5SUM, LIVOX_DEFINITION

        def write(bag, cloud, time):
            bag.write('/points', (LIVOX_TYPE, livox_bytes(cloud), LIVOX_MD5SUM, CustomMsg), time, raw=True)

        bag = self.converted('livox.bag', write)
        offline = os.path.join(self.directory, 'livox_offline')
        run_well('rosrun', 'allan_lio', 'lio_offline', '--bag', bag, '--config', 'simulated', '--out', offline)
        out, launched = self.launch(bag, 'livox_node')
        self.assertTrue(os.path.exists(os.path.join(out, 'trajectory.tum')), launched.stdout)
        self.assertGreater(len(read(out, 'trajectory.tum').splitlines()), 30, launched.stdout)
        self.assertEqual(read(out, 'trajectory.tum'), read(offline, 'trajectory.tum'), launched.stdout)

    def test_a_bag_with_another_type_on_the_topic_is_refused_with_a_sentence(self):
        def write(bag, cloud, time):
            bag.write('/points', LaserScan(header=cloud.header), time)

        _, launched = self.launch(self.converted('laser.bag', write), 'laser')
        self.assertIn('/points of the bag is of type sensor_msgs/LaserScan, not sensor_msgs/PointCloud2 or '
                      'livox_ros_driver/CustomMsg or livox_ros_driver2/CustomMsg', launched.stdout)

    def test_a_running_node_says_that_the_topic_is_of_a_type_that_it_does_not_read(self):
        rospy.init_node('cloud_types_test')
        publisher = rospy.Publisher('/points', LaserScan, queue_size=10)
        node = subprocess.Popen(['roslaunch', '--wait', 'allan_lio', 'lio.launch', 'config:=simulated'],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        watchdog = rospy.Timer(rospy.Duration(TIME_LIMIT), lambda _: node.terminate(), oneshot=True)
        sender = rospy.Timer(rospy.Duration(0.1), lambda _: publisher.publish(LaserScan()))
        said = ''
        for line in node.stdout:
            said += line
            if 'sensor_msgs/LaserScan' in line:
                break
        sender.shutdown()
        watchdog.shutdown()
        publisher.unregister()  # roscpp keeps a topic to the first type that it meets there
        node.terminate()
        node.communicate(timeout=TIME_LIMIT)
        self.assertIn("the LiDAR's topic is of type sensor_msgs/LaserScan; sensor_msgs/PointCloud2, ", said)


if __name__ == '__main__':
    rostest.rosrun('allan_lio', 'cloud_types', CloudTypes)
