#!/usr/bin/env python3
"""The metrics server as scrapers and as hostile clients see it.

    metrics_http_test.py METRICS-HOST
"""

import http.client
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

HOST = ""
LINE = re.compile(r'^[a-z_]+(\{[a-z_]+="[^"]*"(,[a-z_]+="[^"]*")*\})? [0-9.e+-]+$')


class MetricsTest(unittest.TestCase):
    def setUp(self):
        self.server = subprocess.Popen([HOST], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.addCleanup(self.server.stdout.close)
        self.port = int(self.server.stdout.readline())

    def tearDown(self):
        self.server.stdin.close()
        self.assertEqual(self.server.wait(30), 0)

    def get(self, path="/metrics", method="GET", timeout=30):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=timeout)
        connection.request(method, path)
        response = connection.getresponse()
        body = response.read().decode()
        connection.close()
        return response, body

    def connect(self):
        client = socket.create_connection(("127.0.0.1", self.port), timeout=30)
        self.addCleanup(client.close)
        return client

    def cycles(self):
        return int(re.search(r"(?m)^binpick_cycles_total\{.*\} (\d+)$", self.get()[1]).group(1))

    def test_answers_with_the_text_format(self):
        response, body = self.get()
        self.assertEqual(response.status, 200)
        self.assertTrue(response.getheader("Content-Type").startswith("text/plain; version=0.0.4"))
        self.assertEqual(int(response.getheader("Content-Length")), len(body))
        for line in body.splitlines():
            if not line.startswith("# "):
                self.assertRegex(line, LINE)
        self.assertIn('binpick_stage_seconds_bucket{stage="detect",le="+Inf"} 0', body)

    def test_counts_go_on(self):
        self.assertEqual(self.cycles(), 0)
        self.server.stdin.write(b"xxx")
        self.server.stdin.flush()
        end = time.monotonic() + 30
        while self.cycles() != 3 and time.monotonic() < end:
            time.sleep(0.01)
        self.assertEqual(self.cycles(), 3)

    def test_other_requests_are_refused(self):
        self.assertEqual(self.get("/")[0].status, 404)
        self.assertEqual(self.get("/metrics?x=1")[0].status, 200)
        self.assertEqual(self.get(method="POST")[0].status, 405)
        for request in (b"\r\n\r\n", b"GET\r\n\r\n", b"GET /metrics\r\n\r\n",
                        b"GET /metrics FTP/1.0\r\n\r\n", b"\0" * 100 + b"\r\n\r\n",
                        b"GET /" + b"a" * 4000):
            client = self.connect()
            client.sendall(request)
            self.assertTrue(client.recv(100).startswith(b"HTTP/1.0 400 "), request[:20])
        self.assertEqual(self.get()[0].status, 200)

    def test_a_request_in_pieces_is_answered(self):
        client = self.connect()
        for byte in b"GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n":
            client.sendall(bytes([byte]))
        self.assertTrue(client.recv(100).startswith(b"HTTP/1.0 200 OK"))

    def test_nobody_holds_it_up_for_long(self):
        silent = [self.connect() for _ in range(20)]
        dripping = [self.connect() for _ in range(5)]
        deaf = [self.connect() for _ in range(5)]
        stop = threading.Event()

        def drip():
            while not stop.wait(0.1):
                for client in dripping:
                    try:
                        client.sendall(b"G")
                    except OSError:
                        pass
        thread = threading.Thread(target=drip)
        thread.start()
        for client in deaf:
            client.sendall(b"GET /metrics HTTP/1.0\r\n\r\n")
        begin = time.monotonic()
        # Thirty clients, four at a time, a second each.
        self.assertEqual(self.get(timeout=60)[0].status, 200)
        self.assertLess(time.monotonic() - begin, 45)
        stop.set()
        thread.join()
        self.assertEqual(silent[0].recv(1), b"")

    def test_a_storm_of_connections_passes(self):
        for _ in range(500):
            socket.create_connection(("127.0.0.1", self.port), timeout=30).close()
        self.assertEqual(self.get(timeout=60)[0].status, 200)

    def test_a_unix_socket_serves_too(self):
        with tempfile.TemporaryDirectory() as folder:
            path = str(Path(folder) / "metrics")
            with subprocess.Popen([HOST, path], stdin=subprocess.PIPE,
                                  stdout=subprocess.PIPE) as server:
                server.stdout.readline()
                with socket.socket(socket.AF_UNIX) as client:
                    client.connect(path)
                    client.sendall(b"GET /metrics HTTP/1.0\r\n\r\n")
                    answer = b""
                    while piece := client.recv(65536):
                        answer += piece
                self.assertIn(b"binpick_cycles_total", answer)
                server.stdin.close()
                self.assertEqual(server.wait(30), 0)
            self.assertFalse(Path(path).exists())


if __name__ == "__main__":
    HOST = sys.argv.pop(1)
    unittest.main()
