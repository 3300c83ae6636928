#!/usr/bin/env python3
"""The daemon as a process on replayed frames, driven by PLCs: pymodbus and mbpoll."""

import random
import re
import shutil
import socket
import subprocess
import sys
import threading
import time
import unittest

import station_process as sp

DAEMON, MODEL = sys.argv.pop(1), sys.argv.pop(1)


def started(**parameters):
    station = sp.Station(DAEMON, MODEL, **parameters)
    station.start()
    return station


class Handshake(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.station = started()

    @classmethod
    def tearDownClass(cls):
        cls.station.__exit__()

    def setUp(self):
        self.plc = sp.Plc(self.station)

    def tearDown(self):
        self.plc.close()

    def test_constants_read_alike_by_both_functions(self):
        for function in (3, 4):
            registers = self.plc.read(function)
            self.assertEqual(registers[2:4], [0x1234, 0x5678])
            self.assertEqual(registers[4:6], [0x3F80, 0])
            self.assertEqual(registers[6], 0xFFFF)

    def test_detect_is_answered_with_picks_that_stay(self):
        picks = 0
        for _ in range(4):  # of the recording's scenes some hold tees
            answer = self.plc.command(sp.DETECT)
            self.assertEqual(answer[sp.CAUSE], 1)
            self.assertEqual(answer[sp.RESULT], answer[sp.TAIL])
            self.assertEqual(answer[sp.ACKNOWLEDGED], self.plc.sequence)
            picks = max(picks, answer[sp.PICKS])
            for _ in range(3):
                time.sleep(0.02)
                again = self.plc.read()
                self.assertEqual(again[sp.RESULT:25], answer[sp.RESULT:25])
                self.assertEqual(again[28:], answer[28:])
        self.assertGreater(picks, 5)

    def test_capture_process_recipe_and_pages(self):
        self.assertEqual(self.plc.command(sp.CAPTURE)[sp.CAUSE], 1)
        answer = self.plc.command(sp.PROCESS)
        self.assertEqual(answer[sp.CAUSE], 1)
        self.assertEqual(self.plc.command(sp.SELECT_RECIPE, recipe=5)[sp.CAUSE], 1)
        answer = self.plc.command(sp.PROCESS)
        self.assertEqual(answer[sp.RECIPE], 5)
        self.assertEqual(self.plc.command(sp.DETECT, recipe=9)[sp.CAUSE], 101)
        self.assertEqual(self.plc.command(sp.NEXT_PAGE)[sp.CAUSE], 108)
        self.assertEqual(self.plc.command(sp.SELECT_RECIPE, recipe=1)[sp.CAUSE], 1)
        self.assertEqual(self.plc.command(99)[sp.CAUSE], 100)

    def test_heartbeat_moves(self):
        before = self.plc.read()[sp.HEARTBEAT]
        time.sleep(0.3)
        self.assertNotEqual(self.plc.read()[sp.HEARTBEAT], before)

    @unittest.skipUnless(shutil.which("mbpoll"), "mbpoll is not installed")
    def test_mbpoll_does_the_same(self):
        def mbpoll(*arguments):
            return subprocess.run(
                ["mbpoll", "-m", "tcp", "-p", str(self.station.port), "-a", "1", "-0", "-1",
                 *arguments], capture_output=True, text=True, timeout=20, check=False).stdout

        def registers(start, count):
            text = mbpoll("-t", "3", "-r", str(start), "-c", str(count), "127.0.0.1")
            return [int(v) & 0xFFFF for v in re.findall(r"\[\d+\]:\s+(-?\d+)", text)]

        sequence = registers(sp.ANSWER + sp.ACKNOWLEDGED, 1)[0] % 65535 + 1
        written = mbpoll("-t", "4", "-r", "0", "127.0.0.1", "--",
                         *map(str, [0, sp.DETECT] + [0] * 17 + [sequence]))
        self.assertIn("Written 20 references", written)
        end = time.monotonic() + 60
        while time.monotonic() < end:
            answer = registers(sp.ANSWER, sp.COUNT)
            if answer[sp.RESULT_COMMAND] == sequence:
                break
        self.assertEqual(answer[sp.RESULT_COMMAND], sequence)
        self.assertEqual(answer[sp.CAUSE], 1)
        self.assertEqual(answer[sp.RESULT], answer[sp.TAIL])

    def test_no_reader_sees_half_an_answer(self):
        """Readers at random phases; picks, counts and sequences of one answer belong together."""
        faults, seen, stop = [], {}, threading.Event()

        def read_on(seed):
            chance, reader = random.Random(seed), sp.Plc(self.station)
            while not stop.is_set():
                r = reader.read()
                if r[sp.RESULT] != r[sp.TAIL]:
                    faults.append("head and tail differ")
                kept = tuple(r[sp.RESULT:25] + r[27:])  # all but heartbeat, age and state
                if seen.setdefault(r[sp.RESULT], kept) != kept:
                    faults.append(f"two answers have the sequence {r[sp.RESULT]}")
                time.sleep(chance.random() * 0.004)
            reader.close()

        readers = [threading.Thread(target=read_on, args=(seed,)) for seed in (1, 2)]
        for reader in readers:
            reader.start()
        for i in range(60):
            self.plc.command((sp.DETECT, sp.NEXT_PAGE, sp.CAPTURE)[i % 3] if i % 9 else sp.PROCESS)
        stop.set()
        for reader in readers:
            reader.join()
        self.assertEqual(faults, [])
        self.assertGreater(len(seen), 20)

    def test_a_command_that_is_replaced_is_told(self):
        """Of two that wait the newer one is taken and says that it took a place."""
        for _ in range(20):  # until both came while the first one ran
            self.plc.write(sp.DETECT)
            replaced = self.plc.write(sp.NEXT_PAGE)
            newest = self.plc.write(sp.CAPTURE)
            acknowledged, answer = set(), None
            while answer is None or answer[sp.RESULT_COMMAND] != newest:
                answer = self.plc.read()
                acknowledged.add(answer[sp.ACKNOWLEDGED])
            if replaced not in acknowledged and answer[sp.STATE] & sp.COMMAND_REPLACED:
                break
        else:
            self.fail("no command was ever replaced")
        self.assertEqual(answer[sp.CAUSE], 1)
        time.sleep(0.1)
        self.assertTrue(self.plc.read()[sp.STATE] & sp.COMMAND_REPLACED, "it stays")
        self.assertFalse(self.plc.command(sp.CAPTURE)[sp.STATE] & sp.COMMAND_REPLACED)
        self.station.wait_log("replaced by newer ones")

    def test_free_run_counts_results_up(self):
        self.plc.command(sp.FREE_RUN_START)
        before = self.plc.read()[sp.RESULT]
        end = time.monotonic() + 60
        while (self.plc.read()[sp.RESULT] - before) % 65535 < 3 and time.monotonic() < end:
            time.sleep(0.01)
        self.assertLess(time.monotonic(), end)
        self.assertEqual(self.plc.command(sp.DETECT)[sp.CAUSE], 110)
        self.assertEqual(self.plc.command(sp.FREE_RUN_STOP)[sp.CAUSE], 1)

    def test_the_control_socket_orders_too(self):
        answer = self.station.ask("detect")
        self.assertTrue(answer["ok"], answer)
        self.assertEqual(answer["cause_name"], "done")
        self.assertEqual(self.plc.read()[sp.RESULT_COMMAND], 0)
        self.assertFalse(self.station.ask("recipe 77")["ok"])
        self.assertIn("none of", self.station.ask("explode")["fault"])
        self.assertEqual(self.station.ask("status")["sensor"], "ready")


class ControlSocket(unittest.TestCase):
    def test_one_order_at_a_time(self):
        with started() as station:
            answers = []
            threads = [threading.Thread(target=lambda: answers.append(station.ask("detect")))
                       for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            causes = sorted(answer["cause"] for answer in answers)
            self.assertEqual(causes[0], 1)
            self.assertIn(106, causes)

    def test_who_hangs_up_or_says_too_much_harms_nobody(self):
        with started() as station:
            for line in (b"detect\n", b"x" * 5000, b"\0\xff\n" * 50, b"status\n" * 300):
                with socket.socket(socket.AF_UNIX) as rude:
                    rude.connect(station.control)
                    try:
                        rude.sendall(line)
                    except OSError:
                        pass  # hung up on, as it should be
            end = time.monotonic() + 30
            while not station.ask("detect")["ok"] and time.monotonic() < end:
                time.sleep(0.05)
            self.assertTrue(station.ask("detect")["ok"])
            patient = [socket.socket(socket.AF_UNIX) for _ in range(8)]
            for client in patient:
                client.connect(station.control)
            self.assertIn("too many", station.ask("status")["fault"])
            for client in patient:
                client.close()


class PlcHeartbeat(unittest.TestCase):
    def test_a_plc_that_stands_still_is_noticed_and_comes_back(self):
        with started(modbus="plc_heartbeat_timeout_ms = 300") as station:
            plc = sp.Plc(station)
            plc.command(sp.DETECT, heartbeat=1)
            answer = plc.wait_state(sp.PLC_LOST | sp.FAULT)
            self.assertEqual(answer[sp.CAUSE], 1, "the answer stays")
            self.assertEqual(plc.command(sp.DETECT, heartbeat=1)[sp.CAUSE], 206)
            end = time.monotonic() + 30
            beat, cause = 1, 206
            while cause == 206 and time.monotonic() < end:
                beat += 1
                plc.write(sp.DETECT, heartbeat=beat)
                cause = plc.wait()[sp.CAUSE]
            self.assertEqual(cause, 1)
            plc.close()


if __name__ == "__main__":
    unittest.main()
