"""A binpickd process for tests: its folder, its life, its service manager, its PLC."""

import json
import os
import select
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from pathlib import Path

from pymodbus.client import ModbusTcpClient

SAMPLE = Path(__file__).resolve().parents[1] / "data" / "bin-sample"
ANSWER, COUNT = 100, 125
# Offsets within the answer block and codes, as in firmware-config/modbus/register-map.toml.
STATE, HEARTBEAT, ACKNOWLEDGED, RESULT, RESULT_COMMAND, CAUSE = 8, 9, 10, 11, 12, 13
REASONS, DETECTIONS, PICKS, PAGE, PAGE_PICKS, RECIPE, TAIL = 14, 15, 16, 17, 18, 19, 124
DETECT, CAPTURE, PROCESS, SELECT_RECIPE, NEXT_PAGE = 1, 2, 3, 4, 5
TURN_PAGE, CLEAR_FAULT, FREE_RUN_START, FREE_RUN_STOP, FLUSH = 6, 7, 8, 9, 10
READY, BUSY, FAULT, SENSOR_OK, PLC_LOST = 1 << 0, 1 << 1, 1 << 6, 1 << 8, 1 << 9
COMMAND_REPLACED = 1 << 11


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Manager:
    """What a service manager hears."""

    def __init__(self, folder):
        self.path = f"{folder}/notify"
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(self.path)
        self.heard = []  # (time, message)

    def listen(self, seconds):
        if select.select([self.socket], [], [], seconds)[0]:
            self.heard.append((time.monotonic(), self.socket.recv(4096).decode()))
            return self.heard[-1][1]
        return None

    def wait(self, word, seconds=60):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            message = self.listen(end - time.monotonic())
            if message and word in message:
                return message
        raise AssertionError(f"{word} was not heard within {seconds} s: {self.heard}")

    def count(self, word):
        return sum(word in message for _, message in self.heard)

    def close(self):
        self.socket.close()


class Station:
    """Its own folder with a configuration; started, steered and looked at by a test."""

    def __init__(self, daemon, model, sensor=f'uri = "replay:{SAMPLE}"', station="", modbus=""):
        self.daemon = daemon
        self.folder = tempfile.mkdtemp(prefix="binpick_daemon_")
        self.port = free_port()
        self.control = f"{self.folder}/control"
        self.process = None
        self.manager = Manager(self.folder)
        self.write("tee.toml", f'number = 1\nname = "tee"\nmodels = ["{model}"]\nmin_score = 0.4\n')
        self.write("once.toml", f'number = 5\nmodels = ["{model}"]\nmin_score = 0.99\n')
        self.main = (f'[sensor]\n{sensor}\n[station]\nrecipes = ["tee.toml", "once.toml"]\n'
                     f'control_socket = "{self.control}"\n{station}\n[modbus]\n'
                     f'bind = "127.0.0.1"\nport = {self.port}\n{modbus}\n'
                     '[memory]\nlock = false\n[logging]\nlevel = "debug"\n')
        self.write("binpick.toml", self.main)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.process and self.process.poll() is None:
            self.process.kill()
            self.process.wait()
        self.manager.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def write(self, name, text):
        Path(self.folder, name).write_text(text)

    def run(self, *arguments, under=()):
        """To its end; for what does not serve. `under`: a program that starts it."""
        return subprocess.run(
            [*under, self.daemon, "--config", f"{self.folder}/binpick.toml", *arguments],
            capture_output=True, text=True, timeout=120, check=False)

    def start(self, watchdog_us=None, wait=True, under=()):
        environment = dict(os.environ, NOTIFY_SOCKET=self.manager.path)
        environment.pop("WATCHDOG_PID", None)
        if watchdog_us:
            environment["WATCHDOG_USEC"] = str(watchdog_us)
        begun = time.monotonic()
        with open(f"{self.folder}/log", "ab") as log:
            self.process = subprocess.Popen(
                [*under, self.daemon, "--config", f"{self.folder}/binpick.toml"],
                stderr=log, env=environment)
        if wait:
            self.manager.wait("READY=1")
        return time.monotonic() - begun

    def wait_log(self, text, seconds=10):
        """Until the log has the text: its writer is a thread that nobody waits for."""
        end = time.monotonic() + seconds
        while text not in self.log():
            if time.monotonic() > end:
                raise AssertionError(f"not in the log: {text}\n{self.log()}")
            time.sleep(0.02)

    def metrics(self):
        """What `listen = "FOLDER/metrics"` gives, as text."""
        with socket.socket(socket.AF_UNIX) as client:
            client.settimeout(60)
            client.connect(f"{self.folder}/metrics")
            client.sendall(b"GET /metrics HTTP/1.0\r\n\r\n")
            text = b""
            while piece := client.recv(65536):
                text += piece
        return text.decode()

    def log(self):
        return Path(self.folder, "log").read_text()

    def stop(self, seconds=20):
        """The exit status, and how long it took."""
        begun = time.monotonic()
        self.process.send_signal(signal.SIGTERM)
        return self.process.wait(timeout=seconds), time.monotonic() - begun

    def ask(self, line, seconds=60):
        """One line to the control socket."""
        with socket.socket(socket.AF_UNIX) as connection:
            connection.settimeout(seconds)
            connection.connect(self.control)
            try:
                connection.sendall(line.encode() + b"\n")
            except BrokenPipeError:
                pass  # refused before it was heard: why can still be read
            return json.loads(connection.makefile().readline())

    def resident_kib(self):
        for line in Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith("VmRSS"):
                return int(line.split()[1])
        return 0


class Plc:
    """A PLC by pymodbus."""

    def __init__(self, station):
        self.client = ModbusTcpClient("127.0.0.1", port=station.port)
        assert self.client.connect()
        self.sequence = self.read()[ACKNOWLEDGED]

    def read(self, function=4):
        read = self.client.read_input_registers if function == 4 \
            else self.client.read_holding_registers
        return read(ANSWER, COUNT, slave=1).registers

    def write(self, code, recipe=0, picks=0, deadline_ms=0, page=0, heartbeat=0):
        """Starts a command; does not wait."""
        self.sequence = self.sequence % 65535 + 1
        block = [heartbeat, code, recipe, picks, deadline_ms, page] + [0] * 13 + [self.sequence]
        assert not self.client.write_registers(0, block, slave=1).isError()
        return self.sequence

    def wait(self, seconds=60, period=0.002):
        """The answer to the last command."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            registers = self.read()
            if registers[RESULT_COMMAND] == self.sequence:
                return registers
            time.sleep(period)
        raise AssertionError(f"no answer to command {self.sequence} within {seconds} s")

    def command(self, code, **parameters):
        self.write(code, **parameters)
        return self.wait()

    def wait_state(self, bits, seconds=30):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            registers = self.read()
            if registers[STATE] & bits == bits:
                return registers
            time.sleep(0.02)
        raise AssertionError(f"state bits {bits:#x} did not come within {seconds} s")

    def close(self):
        self.client.close()
