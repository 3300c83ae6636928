#!/usr/bin/env python3
"""The handshake by two clients that are not ours: mbpoll and pymodbus.

    clients_test.py FAKE_STATION
"""

import re
import shutil
import struct
import subprocess
import sys
import time
import unittest

from station_process import ADDRESS, ANSWER, CAUSE, CODE, COMMAND, STATE, Station

try:
    from pymodbus.client import ModbusTcpClient
except ImportError as error:
    ModbusTcpClient = None
    MISSING = str(error)

PROGRAM = sys.argv.pop(1)
PATIENCE_S = 20


class StationTest(unittest.TestCase):
    options = ()

    def setUp(self):
        self.station = Station(PROGRAM, *self.options)
        self.addCleanup(self.station.close)

    def wait_for(self, read, condition):
        end = time.monotonic() + PATIENCE_S
        while True:
            answer = read()
            if condition(answer):
                return answer
            self.assertLess(time.monotonic(), end, answer)
            time.sleep(0.02)


def index(name):
    return ADDRESS[name] - ANSWER["start"]


def long_at(words, at):
    return struct.unpack(">i", struct.pack(">HH", *words[at:at + 2]))[0]


class MbpollTest(StationTest):
    """Counts registers from 1 (its default), as most PLC drivers do: holding 40101 is -r 101."""

    def mbpoll(self, *arguments, ok=True):
        command = ["mbpoll", "-m", "tcp", "-a", "1", "-p", str(self.station.port), "-1", "-q",
                   *[str(a) for a in arguments]]
        run = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(run.returncode == 0, ok, run.stdout + run.stderr)
        return run.stdout + run.stderr

    def read(self, table=4):
        text = self.mbpoll("-t", f"{table}:hex", "-r", ANSWER["start"] + 1, "-c", ANSWER["count"],
                           "127.0.0.1")
        return [int(word, 16) for word in re.findall(r"^\[\d+\]:\s+0x([0-9A-F]{4})", text, re.M)]

    def test_constants_in_the_types_of_the_client(self):
        at = ADDRESS["test_uint32"] + 1
        text = self.mbpoll("-B", "-t", "4:int", "-r", at, "-c", 1, "127.0.0.1")
        self.assertIn(str(0x12345678), text)
        at = ADDRESS["test_float32"] + 1
        self.assertRegex(self.mbpoll("-B", "-t", "3:float", "-r", at, "-c", 1, "127.0.0.1"),
                         r"\]:\s+1\b")

    def test_handshake(self):
        before = self.read()
        self.assertEqual(len(before), 125)
        sequence = before[index("acknowledged_sequence")] + 1
        block = [0] * COMMAND["count"]
        block[ADDRESS["command_code"]] = CODE["detect"]
        block[ADDRESS["command_sequence"]] = sequence
        self.mbpoll("-t", "4", "-r", 1, "127.0.0.1", *block)
        answer = self.wait_for(self.read, lambda a: a[index("result_command")] == sequence)
        self.assertEqual(answer[index("acknowledged_sequence")], sequence)
        self.assertEqual(answer[index("cause")], CAUSE["done"])
        self.assertEqual(answer[index("result_sequence")], answer[index("result_sequence_tail")])
        self.assertEqual(answer[index("page_picks")], 5)
        self.assertEqual(long_at(answer, 28), 100_000)  # x of the first pick: 100 mm
        self.assertEqual(long_at(answer, 30), -50_500)
        latched = self.read(table=3)
        for name in ("result_sequence", "cause", "picks", "cycle_number"):
            self.assertEqual(latched[index(name)], answer[index(name)])

    def test_register_by_register_with_the_sequence_last(self):
        for name, value in (("command_recipe", 2), ("command_code", CODE["detect"]),
                            ("command_sequence", 1)):
            self.mbpoll("-t", "4", "-r", ADDRESS[name] + 1, "127.0.0.1", value)
        answer = self.wait_for(self.read, lambda a: a[index("result_command")] == 1)
        self.assertEqual(answer[index("recipe")], 2)

    def test_what_is_refused(self):
        self.assertIn("Illegal data address",
                      self.mbpoll("-t", "4", "-r", 30, "-c", 1, "127.0.0.1", ok=False))
        self.assertIn("Illegal data address",
                      self.mbpoll("-t", "4", "-r", 101, "127.0.0.1", 5, ok=False))
        self.assertIn("Illegal function",
                      self.mbpoll("-t", "0", "-r", 1, "-c", 1, "127.0.0.1", ok=False))


@unittest.skipIf(ModbusTcpClient is None, "pymodbus cannot be imported")
class PymodbusTest(StationTest):
    options = ("--word-order", "cdab", "--rotation", "quaternion_wxyz",
               "--heartbeat-timeout-ms", "300")

    def setUp(self):
        super().setUp()
        self.client = ModbusTcpClient("127.0.0.1", port=self.station.port)
        self.assertTrue(self.client.connect())
        self.addCleanup(self.client.close)

    def read(self):
        response = self.client.read_input_registers(ANSWER["start"], ANSWER["count"], slave=1)
        self.assertFalse(response.isError(), response)
        return response.registers

    def command(self, name, sequence, **parameters):
        block = [0] * COMMAND["count"]
        block[ADDRESS["command_code"]] = CODE[name]
        block[ADDRESS["command_sequence"]] = sequence
        for parameter, value in parameters.items():
            block[ADDRESS[parameter]] = value
        response = self.client.write_registers(0, block, slave=1)
        self.assertFalse(response.isError(), response)
        return self.wait_for(self.read, lambda a: a[index("result_command")] == sequence)

    def test_word_order_and_quaternion(self):
        answer = self.command("detect", 1)
        self.assertEqual(answer[2:4], [0x5678, 0x1234])
        x = answer[28] | answer[29] << 16
        self.assertEqual(x, 100_000)
        q = [part - 65536 if part > 32767 else part for part in answer[34:38]]
        self.assertAlmostEqual(sum((part / 32767) ** 2 for part in q), 1, places=3)
        self.assertEqual(answer[38:40], [0, 0])

    def test_pages(self):
        answer = self.command("detect", 1)
        while answer[index("picks")] < 13:
            answer = self.command("detect", answer[index("result_command")] + 1)
        picks, sequence = answer[index("picks")], answer[index("result_command")]
        seen = [long_at([w for p in zip(answer[29::16], answer[28::16]) for w in p], 2 * i)
                for i in range(6)]
        for page in (2, 3):
            answer = self.command("next_page", sequence + page - 1)
            self.assertEqual(answer[index("page")], page)
            for i in range(answer[index("page_picks")]):
                seen.append(answer[28 + 16 * i] | answer[29 + 16 * i] << 16)
        self.assertEqual(seen, [100_000 + 1000 * n for n in range(picks)])
        answer = self.command("next_page", sequence + 3)
        self.assertEqual(answer[index("cause")], CAUSE["page_unknown"])
        answer = self.command("page", sequence + 4, command_page=1)
        self.assertEqual((answer[index("page")], answer[index("page_picks")]), (1, 6))

    def test_refusals_have_causes(self):
        self.assertEqual(self.command("process", 1)[index("cause")], CAUSE["nothing_captured"])
        answer = self.command("detect", 2, command_recipe=9)
        self.assertEqual(answer[index("cause")], CAUSE["recipe_unknown"])
        answer = self.command("detect", 3, command_picks_max=99)
        self.assertEqual(answer[index("cause")], CAUSE["picks_max_too_large"])
        self.assertEqual(self.command("next_page", 4)[index("cause")], CAUSE["nothing_to_page"])
        answer = self.command("detect", 5, command_code=77)
        self.assertEqual(answer[index("cause")], CAUSE["command_unknown"])

    def test_capture_then_process(self):
        captured = self.command("capture", 1)
        processed = self.command("process", 2)
        for name in ("capture_time", "capture_time_ms"):
            self.assertEqual(processed[index(name)], captured[index(name)])
        self.assertGreater(processed[index("result_sequence")], captured[index("result_sequence")])

    def test_one_exchange_by_function_23(self):
        response = self.client.readwrite_registers(
            read_address=ANSWER["start"], read_count=ANSWER["count"],
            write_address=ADDRESS["command_code"], write_registers=[CODE["detect"]], slave=1)
        self.assertFalse(response.isError(), response)
        self.assertEqual(len(response.registers), 125)

    def test_heartbeat_of_the_plc(self):
        lost = lambda a: a[index("state")] & STATE["plc_heartbeat_lost"]
        self.assertFalse(lost(self.read()))
        self.client.write_register(ADDRESS["plc_heartbeat"], 1, slave=1)
        self.wait_for(self.read, lost)
        beat = 1

        def revived(answer):
            nonlocal beat
            beat += 1
            self.client.write_register(ADDRESS["plc_heartbeat"], beat, slave=1)
            return not lost(answer)
        self.wait_for(self.read, revived)

    def test_free_running_counts_results(self):
        started = self.command("free_run_start", 1)[index("result_sequence")]
        answer = self.wait_for(self.read, lambda a: a[index("result_sequence")] > started + 3)
        self.assertEqual(answer[index("result_command")], 0)
        self.command("free_run_stop", 2)

    def test_exceptions(self):
        for response, code in (
                (self.client.read_holding_registers(99, 1, slave=1), 2),
                (self.client.write_register(100, 1, slave=1), 2),
                (self.client.read_coils(0, 1, slave=1), 1),
                (self.client.read_holding_registers(0, 1, slave=7), 11)):
            self.assertTrue(response.isError())
            self.assertEqual(response.exception_code, code)


if __name__ == "__main__":
    if shutil.which("mbpoll") is None or ModbusTcpClient is None:
        print("skipped: mbpoll or pymodbus is missing; tools/setup installs them")
        sys.exit(77)
    unittest.main()
