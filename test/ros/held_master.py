# Copyright 2026 the allan_lio authors
# SPDX-License-Identifier: BSD-3-Clause
"""Stops a node at one line of its start."""
import socketserver
import threading
import xmlrpc.client
import xmlrpc.server

import rosgraph

from ros_support import TIME_LIMIT


class Server(socketserver.ThreadingMixIn, xmlrpc.server.SimpleXMLRPCServer):
    daemon_threads = True


class HeldMaster:
    """Hands a node's calls on to the real master, but keeps it waiting when it advertises `topic`, until it begins to
    shut down."""

    def __init__(self, topic):
        self.topic = topic
        self.held, self.shuts_down = threading.Event(), threading.Event()
        self.server = Server(('localhost', 0), logRequests=False)
        self.server.register_instance(self)
        self.uri = 'http://localhost:{}'.format(self.server.server_address[1])
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def _dispatch(self, method, arguments):
        if method == 'registerPublisher' and arguments[1] == self.topic:
            self.held.set()
            self.shuts_down.wait(TIME_LIMIT)
        if method.startswith('unregister'):
            self.shuts_down.set()
        return getattr(xmlrpc.client.ServerProxy(rosgraph.get_master_uri()), method)(*arguments)

    def end(self):
        self.server.shutdown()
        self.server.server_close()
