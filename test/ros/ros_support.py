# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""What the rostests share: commands, files, recorded topics."""
import os
import subprocess
import time

import rospy

SLOWER = float(os.environ.get('ALLAN_LIO_SLOWER', 1))  # scripts/test raises it for sanitized builds
TIME_LIMIT = 120 * SLOWER  # [s], for what hangs


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


def wait_until(condition, what):
    until = time.time() + TIME_LIMIT
    while not condition():
        assert time.time() < until, 'in {} s not: {}'.format(TIME_LIMIT, what)
        time.sleep(0.02)


class Recorder:
    """The messages of a topic, in order."""

    def __init__(self, topic, kind):
        self.messages = []
        self.subscriber = rospy.Subscriber(topic, kind, self.messages.append, queue_size=10000)

    def wait(self, count, condition=lambda message: True):
        """Until so many more messages meet the condition; gives the last of them."""
        seen, begin = 0, len(self.messages)
        until = time.time() + TIME_LIMIT
        while time.time() < until:
            while begin < len(self.messages):
                message = self.messages[begin]
                begin += 1
                seen += bool(condition(message))
                if seen == count:
                    return message
            time.sleep(0.005)
        raise AssertionError('{} of {} messages in {} s'.format(seen, count, TIME_LIMIT))

    def end(self):
        self.subscriber.unregister()
        return self.messages


class Recording:
    """Several topics, {topic: type}, while a block runs."""

    def __init__(self, kinds):
        self.kinds = kinds

    def __enter__(self):
        self.recorders = {topic: Recorder(topic, kind) for topic, kind in self.kinds.items()}
        return self

    def __exit__(self, *_):
        for recorder in self.recorders.values():
            recorder.end()

    def __getitem__(self, topic):
        return self.recorders[topic].messages
