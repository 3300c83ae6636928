#!/usr/bin/env python3
"""Not a test: from the write of the trigger to the first read that shows the result, beyond the
time that detection took, with a client that polls every 2 ms. Beside it what this machine takes
to wake a process and be answered by another one, measured between the cycles.

    latency_bench.py BINPICKD MODEL [CYCLES]
"""

import os
import socket
import struct
import sys
import time

import station_process as sp

PERIOD_S = 0.002
NOISE_PER_CYCLE = 10


class LeanPlc:
    """A PLC without a library: what it takes itself is no part of the measurement."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def ask(self, pdu):
        self.socket.sendall(struct.pack(">HHHB", 1, 0, len(pdu) + 1, 1) + pdu)
        head = self.socket.recv(6, socket.MSG_WAITALL)
        return self.socket.recv(struct.unpack(">H", head[4:6])[0], socket.MSG_WAITALL)

    def trigger(self, sequence):
        block = [0, sp.DETECT] + [0] * 17 + [sequence]
        self.ask(struct.pack(">BHHB20H", 16, 0, 20, 40, *block))

    def read(self):
        return struct.unpack(">125H", self.ask(struct.pack(">BHH", 4, sp.ANSWER, sp.COUNT))[3:])


class Echo:
    """Another process that answers each byte."""

    def __init__(self):
        self.near, far = socket.socketpair()
        self.pid = os.fork()
        if self.pid == 0:
            self.near.close()
            while byte := far.recv(1):
                far.send(byte)
            os._exit(0)
        far.close()

    def late_ms(self):
        """How much later than the period the answer is there, asked after a period's sleep."""
        begun = time.monotonic()
        time.sleep(PERIOD_S)
        self.near.send(b"x")
        self.near.recv(1)
        return (time.monotonic() - begun - PERIOD_S) * 1e3

    def close(self):
        self.near.close()
        os.waitpid(self.pid, 0)


def cycle_ms(plc, sequence):
    begun = time.monotonic()
    plc.trigger(sequence)
    due = begun
    while True:
        answer = plc.read()
        if answer[sp.RESULT_COMMAND] == sequence:
            return (time.monotonic() - begun) * 1e3
        due = max(due + PERIOD_S, time.monotonic())
        time.sleep(max(0, due - time.monotonic()))


def line(name, values):
    values = sorted(values)

    def quantile(share):
        return values[min(len(values) - 1, int(share * len(values)))]

    print(f"{name:48} p50 {quantile(0.5):6.2f}  p90 {quantile(0.9):6.2f}  "
          f"p99 {quantile(0.99):6.2f}  max {values[-1]:6.2f} ms")


def main():
    daemon, model = sys.argv[1:3]
    cycles = int(sys.argv[3]) if len(sys.argv) > 3 else 200
    echo, noise = Echo(), []
    with sp.Station(daemon, model) as station:
        station.start()
        while station.ask("status")["sensor"] != "ready":
            time.sleep(0.02)
        plc, waited, times = LeanPlc(station.port), [], []
        station.ask("detect")  # the first frame is still being decoded
        for i in range(cycles):
            noise += [echo.late_ms() for _ in range(NOISE_PER_CYCLE)]
            waited.append(cycle_ms(plc, i + 1))
            times.append(station.ask("status")["last"]["times_ms"])
    echo.close()
    detect = [t["detect"] for t in times]
    over = [w - d for w, d in zip(waited, detect)]
    print(f"{cycles} cycles, detection {min(detect):.0f} to {max(detect):.0f} ms")
    line("trigger to result, beyond detection", over)
    line("  the command's way to the cycle", [t["wait"] for t in times])
    line("  the frame", [t["grab"] for t in times])
    line("  from it to published, but for detection",
         [t["total"] - t["wait"] - t["grab"] - t["detect"] for t in times])
    line("  the rest: the next poll, sockets", [w - t["total"] for w, t in zip(waited, times)])
    line("the machine: late after a period's sleep", noise)
    print(f"at most 5 ms: {sum(v <= 5 for v in over)} of {cycles}")


if __name__ == "__main__":
    main()
