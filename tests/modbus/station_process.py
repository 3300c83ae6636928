"""The fake station as a process of a test, and the register map for clients in Python."""

import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MAP = tomllib.loads((ROOT / "firmware-config/modbus/register-map.toml").read_text())
ANSWER = MAP["block"]["answer"]
COMMAND = MAP["block"]["command"]
ADDRESS = {r["name"]: r["address"] for b in MAP["block"].values() for r in b["registers"]}
CODE = {v["name"]: v["value"] for v in MAP["list"]["command_code"]["values"]}
CAUSE = {v["name"]: v["value"] for v in MAP["list"]["cause"]["values"]}
STATE = {v["name"]: 1 << v["bit"] for v in MAP["bits"]["state"]["values"]}


class Station:
    """Runs from construction until close(); it also ends when this process does."""

    def __init__(self, program, *options):
        command = [str(program)] + [str(option) for option in options]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True)
        self.port = int(self.process.stdout.readline().split()[1])

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=30)
        self.process.stdout.close()
